"""Runners: who does the parts of a plan. Each gives what became of them as they are done."""

from __future__ import annotations

import os
import signal
import tempfile
from collections.abc import Iterator
from typing import Any

from mavwire._text import in_words
from mavwire.logs.manifest import Converted

from .doing import Made, Recipe, do_part
from .planning import Task

Parts = list[list[Task]]


def run_here(parts: Parts, recipe: Recipe) -> Iterator[Made]:
    """Do parts one by one in this process, whose threads share each log."""
    for part in parts:
        yield do_part(part, recipe)


def run_pool(parts: Parts, recipe: Recipe, workers: int) -> Iterator[Made]:
    """Do parts in processes of this machine."""
    import multiprocessing
    from concurrent.futures import ProcessPoolExecutor, as_completed

    from mavwire.fleet.clients import interrupts_put_off

    share = str(max(1, (os.cpu_count() or 1) // workers))
    spawned = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(workers, spawned, _begin, (share,)) as pool:
        with interrupts_put_off():
            futures = {pool.submit(do_part, part, recipe): part for part in parts}
        try:
            for future in as_completed(futures):
                yield _outcome(future, futures[future], recipe)
        finally:
            pool.shutdown(cancel_futures=True)


def _begin(threads: str) -> None:
    """Begin a worker. It was made with signals of a terminal blocked: from here on Ctrl-C ends it, without a
    traceback.
    """
    os.environ["RAYON_NUM_THREADS"] = threads
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGINT, signal.SIGHUP])


def run_dask(parts: Parts, recipe: Recipe, client: Any) -> Iterator[Made]:
    """Do parts on a Dask cluster, whose workers see the lake by the same path."""
    from mavwire.fleet.clients import connected

    with connected(client, None) as cluster:
        from distributed import as_completed

        futures = {cluster.submit(do_part, part, recipe, pure=False): part for part in parts}
        pending = as_completed(futures, loop=cluster.loop)
        for future in pending:
            part = futures.pop(future)
            if future.status == "error" and len(part) > 1:  # one of them may be what ends workers
                alone = {cluster.submit(do_part, [one], recipe, pure=False): [one] for one in part}
                futures |= alone
                pending.update(alone)
                continue
            yield _outcome(future, part, recipe)


def _outcome(future: Any, part: list[Task], recipe: Recipe) -> Made:
    """The outcome of a part. If its worker ended, rows that report the error."""
    error = future.exception()
    if error is None:
        made: Made = future.result()
        return made
    folder = tempfile.mkdtemp(prefix="part-", dir=recipe.staging)
    return Made(folder, [Converted(one.path, "", error=in_words(error, one.path)) for one in part])
