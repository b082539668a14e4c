"""Committing: files of a part become rows of the lake, all of them or none.

Delta Lake commits to one table at a time. So a change of the lake is a
folder of new files and a list of what is to be done, `plan.json`. Giving the folder the name
`.mavwire-commit` is the commit: from then on it is carried through, by the next run if this one is killed.
Every step may be done again: a file that has moved is left where it is, a table says by its transaction
which batch it has, and the ledger is replaced as a whole at the end.
"""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from tempfile import TemporaryDirectory
from typing import Any

from mavwire.logs.manifest import Converted, in_utf8, stored_row
from mavwire.logs.store import PREFIX, Store, write_file

from . import delta
from .doing import Made, Written
from .ledger import Ledger
from .rewriting import Reader, fitted, kinds_differ, rewritten

Replacement = tuple[list[dict[str, Any]], list[Written]]
"""Files of a table, and those that take their place."""

COMMIT = ".mavwire-commit"
PLAN = "plan.json"


class Lake:
    """A folder of tables. One process at a time changes it."""

    def __init__(self, root: str, options: dict[str, Any] | None) -> None:
        delta.check_installed()
        self.root = root
        self._options = options
        self._store = Store(root)
        self._commit = os.path.join(root, COMMIT)

    def ledger(self) -> Ledger:
        """The lake's ledger. A commit that was killed is finished first."""
        if os.path.lexists(self._commit):
            with self.locked():
                pass
        return Ledger.read(self.root, self._options)

    @contextmanager
    def locked(self) -> Iterator[Ledger]:
        """Keep others from changing the lake, and carry through what a killed one began."""
        with self._store.locked(wait=True):
            self._carry_through()
            yield Ledger.read(self.root, self._options)

    @contextmanager
    def staging(self) -> Iterator[str]:
        """A folder for the files of a run, which is locked; those of killed runs go. Runs that begin at the
        same time take turns: one would remove the folder of another that is not locked yet.
        """
        with ExitStack() as stack:
            with self._store.locked(wait=True):
                self._remove_left()
                folder = stack.enter_context(
                    TemporaryDirectory(prefix=PREFIX, dir=self.root, ignore_cleanup_errors=True)
                )
                stack.enter_context(Store(folder).locked())
            yield folder

    def _remove_left(self) -> None:
        """Remove the folders of killed runs, whose locks ended with their processes."""
        for name in os.listdir(self.root):
            folder = os.path.join(self.root, name)
            if name.startswith(PREFIX):
                with suppress(ValueError), Store(folder).locked():
                    shutil.rmtree(folder, ignore_errors=True)

    def add(self, made: Made) -> None:
        """Make the rows of a part visible. Logs that had rows lose these."""
        with self.locked() as ledger:
            changes = _Changes(self.root, made.folder)
            before = {row.path: row for row in made.rows if row.path in ledger.rows}
            gone = {
                path for path, row in before.items() if _replaces(row) and ledger.rows[path].rows
            }
            changes.remove(ledger.tables, gone)
            changes.add(made.files)
            rows = [_row(row, ledger.rows.get(row.path)) for row in made.rows]
            self._publish(ledger, changes, rows)

    def replace(
        self, folder: str, name: str, changes: Callable[[Any], Iterable[Replacement]]
    ) -> int:
        """Replace files of a table by files in `folder` with the same rows: how many."""
        with self.locked() as ledger:
            pending = _Changes(self.root, folder, data=False)
            for files, written in changes(delta.opened(os.path.join(self.root, name))):
                pending.replace(name, files, written)
            if not pending.tables:
                return 0
            self._publish(ledger, pending, [])
            return len(pending.tables[name]["remove"])

    def _publish(self, ledger: Ledger, changes: _Changes, rows: list[Converted]) -> None:
        plan = {
            "batch": ledger.batch + 1,
            "options": ledger.options,
            "tables": changes.tables,
            "rows": [stored_row(row) for row in rows],
        }
        write_file(os.path.join(changes.folder, PLAN), json.dumps(plan).encode())
        os.rename(changes.folder, self._commit)
        self._carry_through(changes.opened)

    def _carry_through(self, opened: Mapping[str, Any] | None = None) -> None:
        """Do what a commit says, or the rest of it. Tables that are `opened` need not be opened again."""
        try:
            with open(os.path.join(self._commit, PLAN), "rb") as file:
                plan = json.load(file)
        except FileNotFoundError:
            shutil.rmtree(self._commit, ignore_errors=True)  # it was done but for this
            return
        ledger = Ledger.read(self.root, plan["options"])
        for name, change in plan["tables"].items():
            folder = os.path.join(self.root, name)
            for one in change["add"]:
                self._move(os.path.basename(one["path"]), os.path.join(folder, one["path"]))
            table = (opened or {}).get(name) or delta.opened(folder)
            ledger.tables[name] = delta.apply(table, folder, plan["batch"], change)
        ledger.batch = plan["batch"]
        ledger.rows |= {row["path"]: Converted(**row) for row in plan["rows"]}
        ledger.write(self.root)
        os.remove(os.path.join(self._commit, PLAN))
        shutil.rmtree(self._commit, ignore_errors=True)

    def _move(self, name: str, place: str) -> None:
        os.makedirs(os.path.dirname(place), exist_ok=True)
        with suppress(FileNotFoundError):  # it has moved
            os.replace(os.path.join(self._commit, name), place)


def _replaces(row: Converted) -> bool:
    """Whether the rows of a log take the place of earlier ones."""
    return not row.skipped and (row.error is None or row.rows > 0)


def _row(row: Converted, earlier: Converted | None) -> Converted:
    """The row of a log in the ledger."""
    if earlier is None or _replaces(row):
        return row
    if row.skipped:  # the same bytes as before, at another time
        earlier.size, earlier.mtime_ns = row.size, row.mtime_ns
    elif not earlier.rows:
        return row
    return earlier


class _Changes:
    """The changes that a commit makes to each table."""

    def __init__(self, root: str, folder: str, data: bool = True) -> None:
        self.folder = folder
        self.tables: dict[str, dict[str, Any]] = {}
        """The changes of each table."""
        self.opened: dict[str, Any] = {}
        self._root = root
        self._data = data

    def _of(self, name: str, partition: Iterable[str]) -> dict[str, Any]:
        change = {
            "columns": [],
            "partition": [*partition],
            "add": [],
            "remove": [],
            "data": self._data,
        }
        return self.tables.setdefault(name, change)

    def _add(self, written: Written) -> None:
        change = self._of(written.table, written.partition)
        known = {one["name"] for one in change["columns"]}
        change["columns"] += [one for one in delta.columns_of(written) if one["name"] not in known]
        change["add"].append(delta.add_of(written))

    def add(self, files: list[Written]) -> None:
        """New files. Columns whose type differs from that in the table are made to fit."""
        known: dict[str, dict[str, Any]] = {}
        for file in files:
            if file.table not in known:
                table = delta.opened(os.path.join(self._root, file.table))
                self.opened[file.table] = table
                known[file.table] = {} if table is None else delta.schema_of(table)
            columns = known[file.table]
            fits = not kinds_differ(file, columns)
            written = file if fits else fitted(self.folder, file, columns)
            for one in delta.columns_of(written):
                columns.setdefault(one["name"], one)
            self._add(written)

    def remove(self, tables: Iterable[str], paths: set[str]) -> None:
        """Remove the rows of some logs."""
        logs = {in_utf8(path) for path in paths}
        for name in tables if logs else ():
            folder = os.path.join(self._root, name)
            for file in delta.files_of(delta.opened(folder)):
                if not any(_may_have(file["logs"], log) for log in logs):
                    continue
                reader = Reader([os.path.join(folder, file["path"])], without=logs)
                if reader.has_removed():
                    kept = rewritten(reader, self.folder, name, file["partition_values"])
                    self.replace(name, [file], kept)

    def replace(self, name: str, files: list[Any], written: list[Written]) -> None:
        """Other files in place of some."""
        for one in files:
            change = self._of(name, one["partition_values"])
            stored = {key: one[key] for key in ("path", "size", "partition_values")}
            change["remove"].append(stored)
        for one in written:
            self._add(one)


def _may_have(logs: tuple[str | None, str | None], log: str) -> bool:
    least, largest = logs
    return least is None or largest is None or least <= log <= largest
