"""A cluster of two processes, one of which dies in the middle of its work."""

from __future__ import annotations

import io
import logging
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import mavwire
import pytest
from mavwire import cli, traffic
from mavwire.fleet import to_parquet
from unit.bridge_tools import wait_until
from unit.faults import ENVIRONMENT, python

# Dask's own threads end when they like.
pytestmark = pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")


@pytest.fixture(scope="module")
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Any:
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address="127.0.0.1:0",
        local_directory=str(tmp_path_factory.mktemp("dask")), silence_logs=50,
    ) as made:  # fmt: skip
        yield made


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    folder = tmp_path_factory.mktemp("logs")
    paths = [folder / f"flight{n}.tlog" for n in range(6)]
    for n, path in enumerate(paths):
        traffic.generate(path, 300, seed=n)
    return paths


def expected(paths: list[Path]) -> dict[str, int]:
    """The files there have to be, and their rows."""
    return {
        f"{name}/{path.stem}.parquet": len(table)
        for path in paths
        for name, table in mavwire.read(path).items()
    }


def written(out: Path) -> dict[str, int]:
    """All files of a folder with their rows, but the manifest."""
    parquet = pytest.importorskip("pyarrow.parquet")
    files = {p for p in out.rglob("*") if p.is_file() and p.name != "manifest.json"}
    return {str(p.relative_to(out)): parquet.read_table(p).num_rows for p in files}


def kill_once(flag: str, path: str) -> None:
    """Have the first worker that has published half of a log's files end itself."""
    import os
    import signal

    from mavwire.fleet import tasks

    original = tasks.publish

    def publish(folder: str, made: Any, recipe: Any) -> None:
        if made.path.endswith(path):
            half = dict(list(made.files.items())[: len(made.files) // 2])
            try:
                os.close(os.open(flag, os.O_CREAT | os.O_EXCL))
            except FileExistsError:
                pass
            else:
                whole, made.files = made.files, half
                original(folder, made, recipe)
                made.files = whole
                os.kill(os.getpid(), signal.SIGKILL)
        original(folder, made, recipe)

    tasks.publish = publish


def kill_once_in_a_lake(flag: str, path: str) -> None:
    """Have the first worker that begins a log for a lake end itself."""
    import os
    import signal

    from mavwire.lake import doing

    original = doing.digest_of

    def digest_of(source: Any) -> str:
        if str(source).endswith(path):
            try:
                os.close(os.open(flag, os.O_CREAT | os.O_EXCL))
            except FileExistsError:
                pass
            else:
                os.kill(os.getpid(), signal.SIGKILL)
        return original(source)

    doing.digest_of = digest_of


def on_each_worker(
    client: Any, flag: Path, name: str, kill: Callable[[str, str], None] = kill_once
) -> None:
    """Run `kill` there; as text, since workers do not know the modules of the tests."""
    import inspect

    source = "from __future__ import annotations\nfrom typing import Any\n" + inspect.getsource(
        kill
    )
    client.run(lambda: exec(f"{source}\n{kill.__name__}({str(flag)!r}, {name!r})", {}))


def test_a_worker_that_is_killed_loses_nothing_and_doubles_nothing(tmp_path, cluster, logs):
    distributed = pytest.importorskip("distributed")
    flag, out, wrong = tmp_path / "killed", tmp_path / "out", tmp_path / "wrong.tlog"
    wrong.write_bytes(b"no log" * 100)
    with distributed.Client(cluster, set_as_default=False) as client:
        client.wait_for_workers(2, timeout=120)
        on_each_worker(client, flag, "flight3.tlog")
        rows = to_parquet([*logs, wrong, tmp_path / "none.tlog"], out, client)
    assert flag.exists(), "no worker was killed"
    assert [row.error is None for row in rows] == [True] * 6 + [False] * 2
    assert [row.rows for row in rows] == [300] * 6 + [0] * 2
    assert written(out) == expected(logs)
    assert not list(out.glob(".mavwire-staging-*")), "nothing is left of the worker that was killed"
    assert {name: n for row in rows for name, n in row.files.items()} == expected(logs)


def test_a_lake_has_each_row_once_where_a_worker_was_killed(tmp_path, cluster, logs):
    distributed, polars = pytest.importorskip("distributed"), pytest.importorskip("polars")
    pytest.importorskip("deltalake")
    from mavwire import lake

    flag, root, wrong = tmp_path / "killed", tmp_path / "lake", tmp_path / "wrong.tlog"
    wrong.write_bytes(b"no log" * 100)
    with distributed.Client(cluster, set_as_default=False) as client:
        client.wait_for_workers(2, timeout=120)
        on_each_worker(client, flag, "flight3.tlog", kill_once_in_a_lake)
        rows = lake.ingest([*logs, wrong], root, client, part_bytes=20_000)
    assert flag.exists(), "no worker was killed"
    assert [row.error is None for row in rows] == [True] * 6 + [False]
    found = {}
    for name, (path, version) in lake.tables(root).items():
        counted = polars.scan_delta(path, version=version).group_by("log").len().collect()
        found.update({f"{name}/{Path(log).stem}.parquet": rows for log, rows in counted.rows()})
    assert found == expected(logs)
    assert not [one for one in os.listdir(root) if one.startswith(".")]


def test_the_command_uses_the_cluster_of_an_address(tmp_path, logs, capsys, cluster):
    out = tmp_path / "out"
    address = cluster.scheduler_address
    argv = ["convert", *map(str, logs), "-o", str(out), "--scheduler", address]
    assert cli.main(argv) == 0
    assert capsys.readouterr().out.count(": converted, 300 rows in ") == 6
    assert written(out) == expected(logs)


def test_the_command_starts_processes_of_its_own(tmp_path, logs, capsys):
    pytest.importorskip("distributed")
    out = tmp_path / "out"
    pattern = str(logs[0].parent / "*.tlog")
    assert cli.main(["convert", pattern, "-o", str(out), "--workers", "1", "--quiet"]) == 0
    assert capsys.readouterr().out == ""
    assert written(out) == expected(logs)


def test_a_fleet_job_that_is_killed_goes_on_when_it_is_started_again(tmp_path, logs, cluster):
    """Client, scheduler and worker at once."""
    out = tmp_path / "out"
    command = [sys.executable, "-m", "mavwire", "convert", *map(str, logs), "-o", str(out)]
    process = subprocess.Popen(
        [*command, "--workers", "1", "--quiet"], env=ENVIRONMENT, start_new_session=True
    )

    def has_file() -> bool:
        try:
            return any(out.rglob("*.parquet"))
        except FileNotFoundError:  # a folder went while it was gone through: it had one
            return True

    try:
        wait_until("a file", lambda: has_file() or process.poll() is not None)
    finally:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
    with pytest.importorskip("distributed").Client(cluster, set_as_default=False) as client:
        rows = to_parquet(logs, out, client)
    assert [row.error for row in rows] == [None] * len(logs)
    assert written(out) == expected(logs)
    assert not list(out.glob(".mavwire-staging-*")), "nothing is left of the run that was killed"


INTERRUPTED = """
import os, signal, sys
import distributed
from mavwire import cli
from mavwire.fleet import clients

class Cluster(distributed.LocalCluster):
    def __init__(self, *args, **kwargs):
        os.kill(os.getpid(), signal.SIGINT)
        super().__init__(*args, **kwargs)

distributed.LocalCluster = Cluster
signal.signal(signal.SIGINT, signal.default_int_handler)
sys.exit(cli.main(["convert", sys.argv[1], "-o", sys.argv[2], "--workers", "1", "--quiet"]))
"""


@pytest.mark.skipif(not hasattr(signal, "pthread_sigmask"), reason="signals cannot be blocked")
def test_an_interrupt_while_the_cluster_begins_ends_the_run(
    logs: list[Path], tmp_path: Path
) -> None:
    """It was lost, and all logs were converted."""
    pytest.importorskip("distributed")
    out = tmp_path / "out"
    done = python(INTERRUPTED, str(logs[0]), str(out))
    assert done.returncode == 130, done.stderr
    assert not out.exists()


GROUP_ENDED = """
import os, signal, sys, threading
import distributed
from mavwire import cli
from unit.bridge_tools import wait_until

def is_worker(pid):
    try:
        with open(f"/proc/{pid}/cmdline", "rb") as words:
            spawned = b"multiprocessing" + b".spawn" in words.read()  # in two, not to find this one
            return spawned and os.getsid(int(pid)) == os.getpid()
    except OSError:
        return False

def end():
    wait_until("a worker", lambda: any(map(is_worker, filter(str.isdecimal, os.listdir("/proc")))))
    os.killpg(0, int(sys.argv[3]))

class Cluster(distributed.LocalCluster):
    def __init__(self, *args, **kwargs):
        threading.Thread(target=end, daemon=True).start()
        super().__init__(*args, **kwargs)

distributed.LocalCluster = Cluster
os.setsid()
signal.signal(signal.SIGHUP, signal.SIG_DFL)  # who runs the tests may ignore it, as nohup does
sys.exit(cli.main(["convert", sys.argv[1], "-o", sys.argv[2], "--workers", "2", "--quiet"]))
"""


@pytest.mark.skipif(not os.path.exists("/proc/self/cmdline"), reason="no words of processes")
@pytest.mark.parametrize("name", ["SIGTERM", "SIGHUP"])
def test_what_ends_the_group_while_the_cluster_begins_ends_the_run(
    name: str, logs: list[Path], tmp_path: Path
) -> None:
    """As `timeout` and service managers do. It was an error of Dask, with tracebacks."""
    pytest.importorskip("distributed")
    out = tmp_path / "out"
    done = python(GROUP_ENDED, str(logs[0]), str(out), str(int(signal.Signals[name])))
    assert (done.returncode, done.stderr) == (130, "")
    assert not out.exists()


def test_what_dask_logs_of_a_cluster_of_this_machine_is_not_shown() -> None:
    """Connections that end while it does, with tracebacks."""
    pytest.importorskip("distributed")
    from mavwire.fleet.clients import connected

    logger, shown = logging.getLogger("distributed"), io.StringIO()
    handler = logging.StreamHandler(shown)
    logger.addHandler(handler)
    try:
        with connected(None, 1) as client:
            cluster = client.cluster
            logger.error("begun")
            cluster.close()
            logger.error("closed")
        assert shown.getvalue() == ""
        logger.error("afterwards")
        assert shown.getvalue() == "afterwards\n"
    finally:
        logger.removeHandler(handler)


@pytest.mark.skipif(not hasattr(signal, "pthread_sigmask"), reason="signals cannot be blocked")
def test_what_ends_a_run_waits_until_the_cluster_has_begun() -> None:
    """Dask is not interrupted in the middle of its start, which it tells of at length."""
    from mavwire.fleet.clients import interrupts_put_off

    heard = []
    before = signal.signal(signal.SIGTERM, lambda number, frame: heard.append(number))
    try:
        with interrupts_put_off():
            signal.raise_signal(signal.SIGTERM)
            assert not heard
        assert heard == [signal.SIGTERM]
        signal.raise_signal(signal.SIGTERM)
        assert len(heard) == 2, "the handler is back"
    finally:
        signal.signal(signal.SIGTERM, before)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_run_of_many_workers_ends_in_order(
    number: signal.Signals, logs: list[Path], tmp_path: Path
) -> None:
    """It left folders and drafts, and a later run completes what it had begun."""
    pytest.importorskip("distributed")
    out = tmp_path / "out"
    words = [sys.executable, "-m", "mavwire", "convert", *map(str, logs), "-o", str(out),
             "--workers", "2", "--quiet"]  # fmt: skip
    with subprocess.Popen(words, env=ENVIRONMENT) as process:
        wait_until(
            "the work",
            lambda: any(out.glob(".mavwire-staging-*/task-*")) or process.poll() is not None,
        )
        process.send_signal(number)
        assert process.wait(60) in (130, 0)
    left = [folder for folder, names, files in os.walk(out) if not names and not files]
    assert not left and not list(out.rglob("*.part")) and not list(out.glob(".mavwire-staging-*"))
    rows = to_parquet(logs, out, workers=1)
    assert [row.error for row in rows] == [None] * len(logs)
    assert written(out) == expected(logs)
