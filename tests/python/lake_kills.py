"""A lake whose runs are killed at random moments, beside one that was made in one go.

    PYTHONPATH=tests/python python -m lake_kills --kills 1000

Each round forks a process that adds logs, changed logs and new ones, or compacts, and ends it with SIGKILL at a
random moment. Then each log of the ledger must have exactly its rows in all tables, and no other log any; a new
run must bring what is missing.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import random
import signal
import sys
import time
import traceback
from collections import Counter
from collections.abc import Callable
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import deltalake
import mavwire
from mavwire import lake, traffic

TYPES = ["ATTITUDE", "HEARTBEAT", "STATUSTEXT"]
LOGS = 5
PART_BYTES = 20_000
"""Of the logs, so that a run has several commits."""

Rows = Counter[tuple[str, str, str]]
"""Rows by table, log and digest."""


def rows_of(root: Path, names: list[str]) -> Rows:
    """The rows of a lake in the versions of its ledger."""
    found: Rows = Counter()
    for name in names:
        path, version = lake.tables(root)[name]
        table = deltalake.DeltaTable(path, version=version).to_pyarrow_table(
            columns=["log", "digest"]
        )
        found.update((name, *row.values()) for row in table.to_pylist())
    return found


def in_child(
    work: Callable[[], object], seconds: float | None = None, after: Path | None = None
) -> float:
    """Do something in a process of its own, and kill it after some time, of which nothing counts before
    there is the file `after`; the seconds that it took.
    """
    began = time.monotonic()
    child = os.fork()
    if child == 0:
        try:
            work()
            os._exit(0)
        except BaseException:
            traceback.print_exc()
            os._exit(1)
    status = _killed(child, seconds, after) if seconds is not None else os.waitpid(child, 0)[1]
    if os.WIFEXITED(status) and os.WEXITSTATUS(status):
        raise AssertionError("a process failed")
    return time.monotonic() - began


def _killed(child: int, seconds: float, after: Path | None) -> int:
    while after is not None and not after.exists():
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            return status
        time.sleep(0.0005)
    time.sleep(seconds)
    os.kill(child, signal.SIGKILL)
    return os.waitpid(child, 0)[1]


def write_logs(folder: Path, numbers: list[int], seed: int) -> None:
    """Write logs anew."""
    for number in numbers:
        traffic.generate(folder / f"{number}.tlog", 100 + 10 * number, seed=seed * 1000 + number)


def ingest(logs: Path, root: Path) -> None:
    """Add what is new."""
    rows = lake.ingest(sorted(logs.iterdir()), root, types=TYPES, part_bytes=PART_BYTES)
    assert not [row.error for row in rows if row.error], rows


def check(root: Path, expected: dict[tuple[str, str], Rows], logs: Path | None = None) -> None:
    """Each log of the ledger has its rows, and no other has any; of `logs` all are there, as they are."""
    from mavwire.lake.doing import digest_of
    from mavwire.lake.ledger import Ledger

    ledger = Ledger.read(os.fspath(root))
    if not ledger.batch:
        assert logs is None
        return
    wanted: Rows = Counter()
    for row in ledger.rows.values():
        known = expected[row.path, row.digest]
        assert row.rows == known.total(), (row, known)
        wanted += known
    found = rows_of(root, sorted(ledger.tables))
    assert found == wanted, (found - wanted, wanted - found)
    if logs is not None:
        now = {os.fspath(path): digest_of(os.fspath(path)) for path in logs.iterdir()}
        assert {row.path: row.digest for row in ledger.rows.values()} == now


def contents(root: Path) -> dict[str, list[str]]:
    """All rows of a lake, in an order of their own."""
    return {
        name: sorted(
            map(repr, deltalake.DeltaTable(path, version=version).to_pyarrow_table().to_pylist())
        )
        for name, (path, version) in lake.tables(root).items()
    }


def check_contents(root: Path, logs: Path, other: Path) -> None:
    """The rows are those of a lake that was made in one go."""
    lake.ingest(sorted(logs.iterdir()), other, types=TYPES)
    assert contents(root) == contents(other)


def expect(logs: Path, expected: dict[tuple[str, str], Rows]) -> None:
    """Note the rows of logs as they are now."""
    for path in map(os.fspath, logs.iterdir()):
        with open(path, "rb") as file:
            digest = hashlib.file_digest(file, "sha256").hexdigest()
        if (path, digest) not in expected:
            found = mavwire.read(path, TYPES)
            rows = {(name, path, digest): len(table) for name, table in found.items() if len(table)}
            expected[path, digest] = Counter(rows)


def run(kills: int, seed: int = 0, tell: Callable[[str], object] = lambda text: None) -> int:
    """Kill so many runs; how many of them were in the midst of a commit."""
    chance = random.Random(seed)
    under_way = 0
    with TemporaryDirectory() as name:
        folder = Path(name)
        logs, root = folder / "logs", folder / "lake"
        commit = root / ".mavwire-commit"
        logs.mkdir()
        write_logs(logs, list(range(LOGS)), 0)
        expected: dict[tuple[str, str], Rows] = {}
        expect(logs, expected)
        add, merge = partial(ingest, logs, root), partial(lake.compact, root)
        # Each takes so long; how long a commit takes is not known, and that of a few tables is a tenth.
        seconds = {work: in_child(work) for work in (add, merge)}
        for number in range(kills):
            work = chance.choice([add, add, merge])
            if work is add:
                write_logs(logs, chance.sample(range(LOGS), chance.randint(1, 3)), number + 1)
                expect(logs, expected)
            in_commit = chance.random() < 0.5
            most = seconds[work] * (0.1 if in_commit else 1)
            in_child(work, chance.uniform(0, most), commit if in_commit else None)
            under_way += commit.exists()
            in_child(partial(check, root, expected))
            if chance.random() < 0.3:
                in_child(add)
                in_child(partial(check, root, expected, logs))
            tell(f"{number + 1} kills, {under_way} in the midst of a commit")
        in_child(add)
        in_child(partial(lake.compact, root, retention_hours=0))
        in_child(partial(check, root, expected, logs))
        in_child(partial(check_contents, root, logs, folder / "other"))
        left = [one for one in os.listdir(root) if one.startswith(".")]
        assert not left, left
    return under_way


def main() -> None:
    """Print how many kills a lake survived."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--kills", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=0)
    args = parser.parse_args()
    under_way = run(args.kills, args.seed, lambda text: print(text, end="\r", file=sys.stderr))
    print(f"{args.kills:,} kills, {under_way:,} in the midst of a commit: no row lost, none twice")


if __name__ == "__main__":
    main()
