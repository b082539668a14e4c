"""`read` and `scan`: logs as tables, whole or in batches."""

from __future__ import annotations

import errno
import glob
import os
import stat
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from operator import index
from typing import Any, Unpack

from mavwire._native import DataflashTables, FrameBatch, LogColumns, RecordBatches
from mavwire._text import naming
from mavwire.dialects import UPSTREAM

from .batches import Batches
from .checks import check_described, check_tables, fields_of, no_record_type, no_rows
from .common_columns import Surveys, empty_of
from .dialect import Dialects
from .memory import warn_if_scarce
from .query import Query, Types, takes
from .selection import ID_PREFIX, Selection, names_of, no_message, separate_fields, several
from .sources import Source, check_run, columns_from, is_dataflash, open_dataflash, read_dataflash
from .table import Table, tidy
from .targets import A_DEVICE, A_FOLDER, A_PIPE
from .unknown import warn_unknown

BATCH_ROWS = 65_536
BATCH_BYTES = 64 << 20
"""Limit of the bytes of rows that wait to become a batch of `scan`."""
LOOKED_AT = 1000
"""Logs that are opened for the wanted fields before any is converted."""


def native_dialect(dialect: Dialects) -> tuple[Any, Any]:
    """The module of a dialect and its native form."""
    from .dialect import dialect_module

    module = dialect_module(dialect)
    return module, module.MAVLink(None)._dialect


def check_readable(path: str) -> None:
    """Raise FileNotFoundError, IsADirectoryError or PermissionError, with the name; OSError is for
    a pipe or a socket, which blocks when it is opened, for a device, which may have no end, and for
    a file that cannot be read.
    """
    mode = os.stat(path).st_mode
    if stat.S_ISDIR(mode):
        raise IsADirectoryError(errno.EISDIR, A_FOLDER, path)
    if stat.S_ISFIFO(mode) or stat.S_ISSOCK(mode):
        raise OSError(errno.ESPIPE, A_PIPE, path)
    if not stat.S_ISREG(mode) and not os.path.samefile(path, os.devnull):
        raise OSError(errno.EINVAL, A_DEVICE, path)
    with naming(path), open(path, "rb") as file:
        file.read(1)


@takes(Query, "systems", "fields", "start", "end")
def read(
    path: str | os.PathLike[str],
    types: Types = None,
    *positional: Any,
    wide: bool = False,
    dialect: Dialects = UPSTREAM,
    **query: Unpack[Query],
) -> dict[str, Table]:
    """Read a log into a table for each message type, in one pass: a telemetry log, a raw stream, or
    a dataflash log, binary or text.

    `types` are names or message classes, one or several; `mavwire.logs.Query` has the other
    arguments. A file ending in gzip or zstd is decompressed on the way. Types that are asked for
    and are not in the log give empty tables. `wide=True` gives types with an instance field as
    `Table.wide` does, a column for each instance.

    Every good record of a damaged log is there. Warns where the tables of a whole log will not fit
    into memory. Raises FileNotFoundError and its kin, ValueError for a type or field that the
    dialect, or the dataflash log, does not have.
    """
    if isinstance(path, list | tuple | set):
        raise TypeError("read takes one log: use mavwire.scan for several")
    path = os.fsdecode(path)
    check_readable(path)
    if types is None and not query.keys() & {"systems", "fields", "start", "end"}:
        warn_if_scarce(path)
    module, native = native_dialect(dialect)
    fields = separate_fields(query, wide)
    selection = Selection.of(module, types, **query)
    opened = read_dataflash(path, path, selection)
    if opened is not None:
        return read_described(*opened, path, selection, fields, wide)
    selection.check_telemetry()
    check_tables(module, native, selection, fields)
    with naming(path):
        run = LogColumns(path, native, selection)
        found = with_empty(joined(run), module, native, selection)
    check_records(run, path, selection)
    return tables_of(found, path, fields, wide)


def read_described(
    tables: DataflashTables,
    found: list[tuple[str, RecordBatches]] | None,
    path: str,
    selection: Selection,
    fields: str | Iterable[str] | None,
    wide: bool,
) -> dict[str, Table]:
    """Whole tables of a dataflash log, those that were found or else by a run over it. ValueError for
    a type that the log does not describe, or a field that no wanted type has, and as by
    `check_records`.
    """
    selection.check_dataflash()
    known: Mapping[str, Iterable[str]] = dict.fromkeys(tables.names, ())
    check_described(known if fields is None else tables.types(), selection, fields)
    if found is None:
        run = tables.columns(selection)
        whole = joined(run)
        check_records(run, path, selection)
    else:
        whole = joined([found])
    for name in selection.names or ():
        if name not in whole:
            whole[name] = tables.empty(name, selection)
    return tables_of(whole, path, fields, wide)


def tables_of_batch(
    batch: FrameBatch, units: str | None, enums: str | None, invalid: str | None
) -> dict[str, Table]:
    """The tables of `FrameBatch.tables`: the native class calls this."""
    selection = Selection.of(None, units=units, enums=enums, invalid=invalid)
    found = joined(batch.columns(selection))
    return {name: tidy(name, batches) for name, batches in sorted(found.items())}


def joined(run: Iterable[list[tuple[str, RecordBatches]]]) -> dict[str, RecordBatches]:
    """The whole tables of a run over a log."""
    pieces: dict[str, list[RecordBatches]] = {}
    for found in run:
        for name, batches in found:
            pieces.setdefault(name, []).append(batches)
    return {name: RecordBatches.joined(some) for name, some in pieces.items()}


def with_empty(
    tables: dict[str, RecordBatches], module: Any, native: Any, selection: Selection
) -> dict[str, RecordBatches]:
    """Tables, and those without rows of the messages that are wanted and not there."""
    for name in selection.names or ():
        msgid = getattr(module, f"{ID_PREFIX}{name}", None)  # other layouts have no such constant
        if isinstance(msgid, int) and msgid in (selection.types or ()) and name not in tables:
            tables[name] = no_rows(native, msgid, selection)
    return tables


def tables_of(
    found: Mapping[str, RecordBatches],
    path: str,
    fields: str | Iterable[str] | None,
    wide: bool,
) -> dict[str, Table]:
    """The result of `read` for the tables of a log. Tables for wide ones have all columns."""
    tables = {name: tidy(name, batches, path) for name, batches in sorted(found.items())}
    if not wide:
        return tables
    from .align import of_fields

    chosen = of_fields(tables, fields, several=False)
    return {name: table.wide() for name, table in chosen.items()}


def check_records(
    run: LogColumns, path: str, selection: Selection, source: Source | None = None
) -> None:
    """Raise LogFormatError where a run over a file found no record, and it is no log cut off in its
    first one. Warn of messages that the dialect does not define.
    """
    position, bad_bytes, damage, unknown = run.progress()
    check_run(path if source is None else source, path, position, bad_bytes, damage)
    if selection.unknown is None:
        warn_unknown(unknown, path, selection.dialect)


@takes(Query, "systems", "fields", "start", "end")
def scan(
    paths: str | os.PathLike[str] | Iterable[str | os.PathLike[str]],
    types: Types = None,
    *positional: Any,
    dialect: Dialects = UPSTREAM,
    batch_rows: int = BATCH_ROWS,
    **query: Unpack[Query],
) -> Batches:
    """Read logs of any size in batches: tables of at most `batch_rows` rows of one type each, with
    `name` and `path`. With one type in `types` they are an Arrow stream too, see `Batches`.

    The rows of a type come in the order of the log. Memory stays bounded: what is read ahead does
    not depend on the size of a log. A text column is always followed by `<name>_raw`.

    The first log is looked at right away, the others when their turn comes. Raises what `read`
    raises, and ValueError if no log is given. `"logs/*.tlog"` names all files that match.
    """
    every = logs_of(paths)
    check_readable(every[0])
    try:
        rows = min(index(batch_rows), sys.maxsize)
    except TypeError:
        rows = 0
    if rows < 1:
        raise ValueError(f"batch_rows must be at least 1, not {batch_rows!r}")
    module, native = native_dialect(dialect)
    fields = separate_fields(query)
    selection = Selection.of(module, types, **query)
    surveys = Surveys()
    check_tables(module, native, selection)
    names, columns = selection.names or (), names_of(fields or ())
    if problem := missing(every, surveys.open, module, native, selection, names, columns):
        raise ValueError(problem)
    selection.foreign = None
    selection.batch_rows, selection.batch_bytes = rows, BATCH_BYTES
    begin = partial(batches, every, surveys, native, selection)
    one_type = selection.names is not None and len(selection.names) == 1
    one_type = one_type and selection.unknown != "table"
    empty = partial(empty_of, every, surveys, module, native, selection) if one_type else None
    return Batches(begin, empty)


def batches(
    paths: list[str], surveys: Surveys, native: Any, selection: Selection
) -> Iterator[Table]:
    """The batches of several logs."""
    for path in paths:
        check_readable(path)
        yield from batches_of(surveys.open(path), path, native, selection)


def missing(
    paths: list[str],
    opened: Callable[[str], DataflashTables | None],
    module: Any,
    native: Any,
    selection: Selection,
    types: Iterable[str],
    fields: Iterable[str],
) -> str | None:
    """The error for the first of some types and fields that none of the logs can have. `opened` gives
    what a dataflash log says about itself. Logs are opened until everything is found.
    """
    described: set[str] = set()
    is_telemetry = False
    for path in paths:
        if not types and not fields:
            return None
        check_readable(path)
        tables = opened(path)
        if tables is not None:
            found = tables.types()
            described.update(found)
            types = [name for name in types if name not in found]
            columns = {one for name in selection.names or found for one in found.get(name, ())}
            fields = [name for name in fields if name not in columns]
        elif not is_telemetry:
            is_telemetry = True
            types = [name for name in types if name in (selection.foreign or ())]
            columns = fields_of(module, native, selection)
            fields = [name for name in fields if name not in columns]
    for name in types:
        if is_telemetry:
            return no_message(module, name)
        return no_record_type(name, described, len(paths))
    what = "message" if is_telemetry else "type"
    return next((f"no wanted {what} has a field {name!r}" for name in fields), None)


def check_fields(
    paths: list[str], module: Any, native: Any, selection: Selection, fields: list[str]
) -> None:
    """Raise ValueError for fields that none of some logs can have. A log that cannot be read may have
    any, and so may more than `LOOKED_AT` logs.
    """
    if len(paths) > LOOKED_AT:
        return
    if selection.foreign and not all(map(is_dataflash, paths)):
        return  # the row of a log says which type it cannot have
    opened = partial(open_dataflash, path="")
    try:
        problem = missing(paths, opened, module, native, selection, (), fields)
    except (OSError, ValueError, MemoryError):  # as its row will say
        return
    if problem:
        raise ValueError(problem)


def allow_described(paths: list[str], selection: Selection) -> None:
    """Types that a dataflash log among others describes are no error where those are read."""
    if selection.foreign is None or all(map(is_dataflash, paths)):
        return
    for types in described_by(paths):
        selection.allow(types)
        if selection.foreign is None:
            return


def described_by(paths: list[str]) -> Iterator[dict[str, list[str]]]:
    """The types that the dataflash logs among some logs describe, and their columns."""
    for path in filter(is_dataflash, paths):
        opened = DataflashTables.read(path)
        if opened is not None:
            yield opened[0].types()


def batches_of(
    tables: DataflashTables | None, path: str, native: Any, selection: Selection
) -> Iterator[Table]:
    """The batches of a dataflash log, or where that is None of a telemetry log. LogFormatError
    behind them if there was no record in it.
    """
    run = columns_from(tables, path, native, selection)
    for found in run:
        for name, batches in found:
            yield Table(name, batches, path)
    check_records(run, path, selection)


def absolute(path: str) -> str:
    """The absolute path of a log. ValueError for an empty name, which would be that of a folder."""
    if not path:
        raise ValueError("a log has an empty name")
    whole = os.path.abspath(path)
    # POSIX leaves open what two slashes mean; wherever logs are read they are one.
    return whole[1:] if os.sep == "/" and whole.startswith("//") else whole


def paths_of(paths: str | os.PathLike[str] | Iterable[str | os.PathLike[str]]) -> list[str]:
    """One path or several. A pattern is replaced by the paths that match it."""
    every: Iterable[Any] = [paths] if isinstance(paths, bytes | os.PathLike) else ()
    if not every and hasattr(paths, "read"):  # whose lines are no paths
        raise TypeError(f"a log is named by its path, not given as an open file: {paths!r}")
    return [one for path in every or several(paths) for one in matches(os.fsdecode(path))]


def matches(path: str) -> list[str]:
    """The files that match a pattern, by name. A path that exists, or that no file matches, is itself."""
    is_pattern = glob.has_magic(path) and not os.path.lexists(path)
    return (sorted(glob.glob(path, recursive=True)) if is_pattern else []) or [path]


def logs_of(paths: str | os.PathLike[str] | Iterable[str | os.PathLike[str]]) -> list[str]:
    """One path or several; ValueError for none."""
    if every := paths_of(paths):
        return every
    raise ValueError("no logs given: name at least one path")
