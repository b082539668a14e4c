"""The ledger of a lake: its logs, and the versions of its tables in which each of them is whole."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, field
from typing import Any

from mavwire.logs.manifest import Converted, stored_row
from mavwire.logs.store import write_file

LEDGER = "lake.json"
VERSION = 1


@dataclass
class Ledger:
    """The record of a lake's content, as of its last commit."""

    options: dict[str, Any]
    """The options that all of its rows have in common."""
    batch: int = 0
    """The number of the last commit."""
    tables: dict[str, int] = field(default_factory=dict)
    """The version of the table in each folder."""
    rows: dict[str, Converted] = field(default_factory=dict)
    """The logs by path."""

    @classmethod
    def read(cls, lake: str, options: dict[str, Any] | None = None) -> Ledger:
        """The ledger of a folder, a new one if it has none. ValueError for a file of something else, and
        for a lake that was made with other options.
        """
        path = os.path.join(lake, LEDGER)
        try:
            with open(path, "rb") as file:
                found = cls._parsed(file.read())
        except FileNotFoundError:
            return cls(options or {})
        if found is None:
            raise ValueError(
                f"{path} is no ledger of this version of mavwire: choose another folder"
            )
        if options is not None and found.options != options:
            names = [one for one in options if options[one] != found.options.get(one)]
            told = ", ".join(f"{one} {found.options.get(one)!r}" for one in names)
            raise ValueError(f"{lake} was made with other options ({told}): choose another folder")
        return found

    @classmethod
    def _parsed(cls, content: bytes) -> Ledger | None:
        try:
            stored = json.loads(content)
            rows = [Converted(**row) for row in stored["logs"]]
            if stored["version"] != VERSION:
                return None
            by_path = {row.path: row for row in rows}
            return cls(stored["options"], int(stored["batch"]), dict(stored["tables"]), by_path)
        except (ValueError, TypeError, KeyError, RecursionError):
            return None

    def write(self, lake: str) -> None:
        """Replace the ledger, which is never seen half written."""
        head = {
            "version": VERSION,
            "options": self.options,
            "batch": self.batch,
            "tables": dict(sorted(self.tables.items())),
        }
        rows = ",\n".join(json.dumps(stored_row(row)) for row in self.rows.values())
        text = json.dumps(head, indent=1).removesuffix("\n}") + f',\n "logs": [\n{rows}\n]}}\n'
        write_file(os.path.join(lake, LEDGER), text.encode())


def tables(lake: str | os.PathLike[str]) -> dict[str, tuple[str, int]]:
    """`{message: (path of its Delta table, version)}`: versions in which each log is in all tables or in
    none. Without them, a reader may see a log in some tables earlier than in others while a run
    commits. ValueError for a folder that is no lake.
    """
    lake = os.fsdecode(lake)
    ledger = Ledger.read(lake)
    if not ledger.batch:
        raise ValueError(f"{lake} is no lake: make one with mavwire ingest")
    return {name: (os.path.join(lake, name), version) for name, version in ledger.tables.items()}
