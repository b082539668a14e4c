"""The Dask client that a run uses: the user's, one of a scheduler, or a cluster of this machine."""

from __future__ import annotations

import asyncio
import logging
import os
import signal
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from multiprocessing import resource_tracker
from typing import Any

from mavwire._signals import put_off
from mavwire._text import in_words


@contextmanager
def connected(client: Any, workers: int | None) -> Iterator[Any]:
    """A client: `client` itself, one of the scheduler at that address, or of a local cluster of
    `workers` processes. ImportError where there is no Dask, OSError where no scheduler answers,
    ValueError for what is neither a client nor an address.
    """
    try:
        from distributed import Client
    except ImportError as error:
        raise ImportError("Dask is needed: pip install 'mavwire[fleet]'") from error
    if isinstance(client, Client):
        yield client
    elif client is not None:
        _check_address(client)
        _check_scheduler(client)
        with Client(client, set_as_default=False) as made:
            yield made
    else:
        with _dask_silenced(), ExitStack() as opened:
            cluster = opened.enter_context(_local_cluster(workers))
            made = opened.enter_context(Client(cluster, set_as_default=False))
            try:
                yield made
            finally:
                # A second Ctrl-C would leave processes that are waited for when Python ends: 10 s.
                with put_off([signal.SIGINT]):
                    opened.close()


HOST_AND_PORT = ("tcp", "tls", "ucx")
"""Schemes of addresses with host and port. `wss` has URLs, `gateway` and others have names."""

PORTS = 65536
SILENCE = logging.CRITICAL
"""The level of log records of a local cluster that are shown."""
GRACE = 1.0
"""Seconds that an answer may take beyond the time that connecting may."""


def _check_address(address: Any) -> None:
    """Raise ValueError for anything but an address: a client would fail too, and then wait for ever."""
    from distributed.comm.addressing import parse_address, parse_host_port
    from distributed.comm.registry import get_backend

    try:
        scheme, place = parse_address(address)
        get_backend(scheme)
        host, port = parse_host_port(place) if scheme in HOST_AND_PORT else (place, 1)
        valid = bool(host) and 0 < port < PORTS
    except (TypeError, ValueError):
        valid = False
    if not valid:
        expected = "a Client or the address of a scheduler such as tcp://host:8786"
        raise ValueError(f"{expected}, not {address!r}")


def _check_scheduler(address: str) -> None:
    """Raise OSError where no scheduler answers. A client notices too. But it never ends after
    another error, such as TLS that is not set up or another program at the port.
    """
    import dask
    from dask.utils import parse_timedelta

    if dask.config.get("distributed.client.security-loader", None):
        return  # it knows how to connect, and the client asks it
    seconds = parse_timedelta(dask.config.get("distributed.comm.timeouts.connect"))
    with ThreadPoolExecutor(1) as pool:  # this thread may run a loop, as in a notebook
        try:
            pool.submit(asyncio.run, _ask(address, seconds)).result()
        except TimeoutError:
            raise OSError(f"no scheduler answers at {address} for {seconds:g} s") from None
        except Exception as error:  # transports of Dask raise errors of any type
            raise OSError(f"no scheduler answers at {address}: {in_words(error)}") from error


async def _ask(address: str, seconds: float) -> None:
    from distributed.comm import connect
    from distributed.security import Security

    async with asyncio.timeout(seconds + GRACE):
        comm = await connect(address, seconds, **Security().get_connection_args("client"))
        try:
            await comm.write({"op": "identity", "n_workers": 0, "reply": True})
            await comm.read()
        finally:
            comm.abort()


@contextmanager
def _dask_silenced() -> Iterator[None]:
    """Hide log records of Dask: it logs the end of each connection of a closing cluster with a
    traceback. `silence_logs` ends before the last of them. Errors that matter are raised or in a
    row.
    """

    def is_shown(record: logging.LogRecord) -> bool:  # one for each run, as runs may overlap
        return record.levelno >= SILENCE

    handlers = list(logging.getLogger("distributed").handlers)
    for handler in handlers:
        handler.addFilter(is_shown)
    try:
        yield
    finally:
        for handler in handlers:
            handler.removeFilter(is_shown)


def _local_cluster(workers: int | None) -> Any:
    """A cluster of processes, which is closed as a context manager."""
    from distributed import LocalCluster

    processors = os.cpu_count() or 1
    count = workers or processors
    # Each process decodes on as many threads as are its share of the processors.
    share = {"RAYON_NUM_THREADS": str(max(1, processors // count))}
    cluster = None
    try:
        with interrupts_put_off():
            cluster = LocalCluster(
                n_workers=count,
                threads_per_worker=1,
                dashboard_address="127.0.0.1:0",
                silence_logs=SILENCE,
                env=share,
            )
        return cluster
    except BaseException:
        if cluster is not None:
            cluster.close()
        raise


@contextmanager
def interrupts_put_off() -> Iterator[None]:
    """Ctrl-C goes to all processes of a terminal, and so does a hangup. Those that are made here,
    and by threads that are made here, inherit that it is blocked: this one ends them in good order,
    without a traceback from each. Another thread receives signals that arrive meanwhile, or this one does afterwards.
    """
    if not hasattr(signal, "pthread_sigmask"):  # as on Windows
        yield
        return
    of_terminals = {signal.SIGINT, signal.SIGHUP}
    before = signal.pthread_sigmask(signal.SIG_BLOCK, of_terminals)
    try:
        resource_tracker.ensure_running()
        # It has unblocked interrupts where it started itself.
        signal.pthread_sigmask(signal.SIG_BLOCK, of_terminals)
        # Handlers that end a run raise wherever it is, which Dask, while it starts, answers with tracebacks. SIGTERM
        # is not blocked: a process that is made here and does not hear it is waited for without an end.
        with put_off([signal.SIGTERM, signal.SIGHUP]):
            yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
