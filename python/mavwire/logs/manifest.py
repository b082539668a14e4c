"""The manifest of a folder of converted logs: what became of each, and what its files are called.

It is written when a run begins, every few seconds and at the end. A run that is killed loses the logs of the last
seconds: they are marked as interrupted, keep their names and are converted again.
"""

from __future__ import annotations

import json
import os
import re
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import Any

from .formats import FORMATS, ONE_FILE
from .sources import file_status
from .store import Files
from .unknown import counts_of

MANIFEST = "manifest.json"
VERSION = 2
BEGUN = "the conversion was interrupted"
"""The error of a log that is being converted."""

PAUSE = 5.0
"""Seconds at least between two writings of the manifest,"""
SHARE = 50
"""and how many times as long as the last one took."""

_PART = re.compile(r"\++\d{4}$")
"""The end of the name of a file of one part of a log, which a fleet cut."""
_UNDECODED = re.compile("[\udc80-\udcff]")
"""Bytes of a name that are not UTF-8. The manifest has the name of a log with them (PEP 383), those of
files have `%FF`: readers of all kinds shall open them.
"""


@dataclass
class Converted:
    """One log in the manifest."""

    path: str
    """Absolute path of the log."""
    name: str
    """The name of its files without suffix."""
    size: int = 0
    mtime_ns: int = 0
    """As it was when it was converted."""
    rows: int = 0
    bad_bytes: int = 0
    """Bytes that belong to no record, which no file has."""
    unknown: list[dict[str, Any]] = field(default_factory=list)
    """Messages that the dialect does not define, which no file has: `{"id": 180, "crc_extra": 5, "messages": 17}`."""
    files: dict[str, int] = field(default_factory=dict)
    """`{path below OUT: rows}`."""
    error: str | None = None
    """Why there are no files, or what is wrong with a compressed log."""
    digest: str = ""
    """SHA-256 of the log, in a lake."""
    skipped: bool = False
    """It had been converted before, by an earlier run."""
    stale: list[str] = field(default_factory=list)
    """Files of before, where this conversion failed: the next one that succeeds replaces or removes
    them.
    """


class Manifest:
    """The logs that were converted into a folder, and the options. `status` gives size and time of a log,
    or raises OSError.

    Files of logs that a killed run did not finish are removed. ValueError if the manifest is a file of another program.
    """

    def __init__(
        self,
        store: Files,
        how: dict[str, Any],
        status: Callable[[str], tuple[int, int]] | None = None,
    ) -> None:
        self._store = store
        self._status = status or file_status
        self.how = json.loads(json.dumps(how))
        self.rows: dict[str, Converted] = {}
        self._unwritten = False
        self._due = 0.0
        content = store.read(MANIFEST)
        stored = {"options": None, "logs": []} if content is None else _checked(_parsed(content))
        if stored is None:
            raise ValueError(
                f"{store.place(MANIFEST)} is no manifest of this version of mavwire: convert to"
                " another folder or remove it"
            )
        begun = {row.name for row in stored["logs"] if row.error == BEGUN}
        if content is None or begun:
            store.remove_drafts()
        if stored["options"] == self.how:
            self.rows |= {row.path: row for row in stored["logs"]}
            self._remove_left(begun)

    def done(self, path: str) -> Converted | None:
        """The row of a log that need not be converted again, also where a compressed one is damaged:
        another time it gives no more.
        """
        row = self.rows.get(path)
        if row is None or row.error == BEGUN or (row.error is not None and not row.files):
            return None
        try:
            status = self._status(path)
        except OSError:
            return None
        there = all(self._store.has_content(name) for name in row.files)
        if not there or status != (row.size, row.mtime_ns):
            return None
        return replace(row, skipped=True)

    def add(self, row: Converted) -> None:
        """Note what became of a log. Files that it had and has no more would be rows of nothing: they are
        removed. Where it failed and nothing takes their place they stay, and are `stale`.
        """
        earlier = self.rows.get(row.path)
        known = [] if earlier is None else [*earlier.files, *earlier.stale]
        gone = [name for name in dict.fromkeys(known) if name not in row.files]
        if row.error is None or row.files:  # of a damaged log what is intact
            self.remove_files(gone)
        else:
            row.stale = gone
        self.rows[row.path] = row
        self._unwritten = True
        if time.monotonic() >= self._due:
            self.store()

    def begin(self, names: dict[str, str]) -> None:
        """Note the logs that are about to be converted, and the names of their files."""
        for path, name in names.items():
            earlier = self.rows.get(path, Converted(path, name))
            self.rows[path] = replace(earlier, rows=0, error=BEGUN)
        if names:
            self.store()

    def close(self) -> None:
        """Write what was not written yet."""
        if self._unwritten:
            self.store()

    def _remove_left(self, begun: set[str]) -> None:
        """Remove the files of logs and of their parts that a killed run had not noted as finished."""
        if not begun:
            return
        kept = {name for row in self.rows.values() for name in (*row.files, *row.stale)}
        others = {row.name for row in self.rows.values()} - begun
        for name in list(self._store.names()):
            stem = self._stem(name)
            is_begun = stem in begun or (stem not in others and _PART.sub("", stem) in begun)
            if is_begun and name not in kept:
                self.remove_files([name])

    def remove_named(self, path: str, stem: str) -> None:
        """Remove the files that are called so, but for those that the log had before."""
        row = self.rows.get(path)
        kept = set() if row is None else {*row.files, *row.stale}
        named = [name for name in self._store.names() if self._stem(name) == stem]
        self.remove_files(name for name in named if name not in kept)

    def remove_files(self, names: Iterable[str]) -> None:
        """Remove files of ours. The manifest may have been written by anyone."""
        for name in list(names):
            if _is_ours(name, self.how["format"]):
                self._store.remove(name)

    def store(self) -> None:
        """Write the manifest, which is never seen half written."""
        began = time.monotonic()
        content = {"version": VERSION, "options": self.how}
        logs = [stored_row(row) for row in self.rows.values()]
        self._store.write(MANIFEST, json.dumps({**content, "logs": logs}, indent=1).encode())
        self._unwritten = False
        now = time.monotonic()
        self._due = now + max(PAUSE, SHARE * (now - began))

    def names(self, paths: list[str]) -> dict[str, str]:
        """A name for the files of each log."""
        earlier = {row.path: row.name for row in self.rows.values()}
        return _names(paths, earlier, self.taken())

    def taken(self) -> set[str]:
        """Names of the files of all logs, without folder and suffix."""
        return {stem for path in self.rows for stem in self.stems(path)}

    def stems(self, path: str) -> set[str]:
        """Names of the files of a log, without folder and suffix."""
        row = self.rows.get(path)
        if row is None:
            return set()
        return {row.name, *map(self._stem, [*row.files, *row.stale])}

    def _stem(self, name: str) -> str:
        stem, _, rest = os.path.basename(name).rpartition(FORMATS[self.how["format"]])
        return "" if rest.endswith(".part") else stem  # a draft is nobody's yet


def stored_row(row: Converted) -> dict[str, Any]:
    """A row as a manifest holds it."""
    stored = dict(vars(row))
    del stored["skipped"]
    if not row.digest:
        del stored["digest"]
    if not row.stale or row.error is None:
        del stored["stale"]
    return stored


def _parsed(text: bytes) -> Any:
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        return None


def _checked(stored: Any) -> dict[str, Any] | None:
    try:
        rows = [Converted(**row) for row in stored["logs"]]
        valid = stored["version"] == VERSION and isinstance(stored["options"], dict)
        for row in rows:
            counts_of(row.unknown)
        stems = [row.name for row in rows]
        files = [name for row in rows for name in (*row.files, *row.stale)]
        lists = [stored["logs"], *(row.stale for row in rows)]
    except (TypeError, KeyError):
        return None
    valid &= all(isinstance(one, list) for one in lists)
    valid &= all(isinstance(name, str) for name in files)
    return {**stored, "logs": rows} if valid and all(map(_is_stem, stems)) else None


def _is_stem(name: Any) -> bool:
    """Whether files can be called so, which are nowhere but in the folder of their type."""
    return isinstance(name, str) and name not in ("", ".", "..") and os.path.basename(name) == name


def _is_ours(name: str, format: str) -> bool:
    """Whether a conversion may have given a file this name."""
    folder, _, file = name.rpartition("/")
    in_place = not folder if format in ONE_FILE else re.fullmatch(r"[A-Za-z0-9_%-]+", folder)
    return bool(in_place) and FORMATS[format] in file and "\\" not in file


def in_utf8(name: str) -> str:
    """The name of a log in UTF-8."""
    return _UNDECODED.sub(_escaped, name)


def _escaped(byte: re.Match[str]) -> str:
    return f"%{ord(byte[0]) - 0xDC00:02X}"


def _names(paths: list[str], earlier: dict[str, str], taken: set[str]) -> dict[str, str]:
    """A name for the files of each log, that of the `earlier` run or one that is not `taken`: the
    log's own, numbered where two are called the same, in UTF-8.
    """
    names: dict[str, str] = {}
    numbers: dict[str, int] = {}
    for path in paths:
        if path in names:
            continue
        if path in earlier:
            names[path] = earlier[path]
            continue
        stem = os.path.basename(path)
        for suffix in (".gz", ".zst", ".tlog", ".BIN", ".bin", ".log", ".parquet", ".arrow"):
            stem = stem.removesuffix(suffix)
        stem = in_utf8(stem)
        # Of ".tlog" and "..tlog" nothing is left that a file could be called.
        if not _is_stem(stem):
            stem = "log"
        # Numbers below the last one are taken.
        name, number = stem, numbers.get(stem, 1)
        while name in taken:
            number += 1
            name = f"{stem}-{number}"
        numbers[stem] = number
        taken.add(name)
        names[path] = name
    return names
