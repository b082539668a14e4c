"""Messages that a dialect does not define: how many a log has, and the text that says so."""

from __future__ import annotations

import json
import os
import struct
import warnings
from collections import Counter
from collections.abc import Mapping
from typing import Any, Literal

from mavwire._text import callers_level
from mavwire.dialects import UPSTREAM, names

Counts = Mapping[tuple[int, int] | None, int] | Mapping[tuple[int, int | None] | None, int]

_STAMP = struct.Struct(">Q")
NO_TABLE = "not a table mavwire.unknown (Parquet or Arrow). `convert --unknown table` writes one"
SHOWN = 8
"""Kinds that a text names."""


class UnknownMessageWarning(UserWarning):
    """A log has messages that the dialect does not define, so that no table holds them."""


def warn_unknown(counts: Counts, path: str, dialect: Any) -> None:
    """Warn of the messages of a log that the dialect, a module, does not define, as `LogColumns.unknown` counts them."""
    if counts:
        text = f"{path}: left out: {unknown_text(counts, dialect, 'argument')}"
        warnings.warn(text, UnknownMessageWarning, stacklevel=callers_level())


def log_of_table(path: str | os.PathLike[str]) -> bytes:
    """A telemetry log with the messages of a table `mavwire.unknown`, in a Parquet or an Arrow file.

    Signatures are not there any more. Raises OSError, ImportError without pyarrow, and ValueError for another table.
    """
    rows = _table(os.fsdecode(path)).to_pylist()
    try:
        return b"".join(_STAMP.pack(_micros(row["timestamp"])) + _frame(row) for row in rows)
    except (KeyError, TypeError, struct.error) as error:
        raise ValueError(NO_TABLE) from error


def _table(path: str) -> Any:
    from mavwire._extras import extra

    with extra("data"):
        import pyarrow as pa
        import pyarrow.parquet as pq
    try:
        if path.endswith(".arrow"):
            with pa.memory_map(path) as file, pa.ipc.open_file(file) as reader:
                return reader.read_all()
        return pq.read_table(path)
    except pa.ArrowInvalid as error:
        raise ValueError(NO_TABLE) from error


def _micros(time: Any) -> int:
    return 0 if time is None else int(time.timestamp()) * 1_000_000 + time.microsecond


def _frame(row: Mapping[str, Any]) -> bytes:
    from mavwire.dialects.v20.all import x25crc

    sender = row["seq"], row["sysid"], row["compid"]
    payload: bytes = row["payload"]
    if row["version"] == 1:
        body = bytes([len(payload), *sender, row["msgid"]]) + payload
    else:
        body = bytes([len(payload), 0, 0, *sender]) + row["msgid"].to_bytes(3, "little") + payload
    checksum: int = x25crc(body + bytes([row["crc_extra"]])).crc
    return (b"\xfe" if row["version"] == 1 else b"\xfd") + body + checksum.to_bytes(2, "little")


def kinds_of(counts: Mapping[tuple[int, int] | None, int]) -> list[dict[str, int | None]]:
    """The counts as manifests hold them, the most frequent kind first. Kinds that were not told apart have no id."""
    ordered = sorted(counts.items(), key=lambda row: -row[1])
    rows = ((kind or (None, None), count) for kind, count in ordered)
    return [{"id": id_, "crc_extra": extra, "messages": count} for (id_, extra), count in rows]


def counts_of(kinds: list[dict[str, Any]]) -> dict[tuple[int, int] | None, int]:
    """The counts that `kinds_of` gave. Raises KeyError and TypeError for anything else."""
    return {
        None if kind["id"] is None else (kind["id"], kind["crc_extra"]): kind["messages"]
        for kind in kinds
    }


def unknown_text(
    counts: Counts,
    dialect: Any,
    way: Literal["options", "option", "argument"] = "options",
) -> str:
    """The text about messages that a dialect, a module, does not define, with advice.

    Kinds are an id with the CRC_EXTRA of its definition, if that is known. `way` says how users name dialects: in
    options of a command that may be repeated, in one option, or in the argument `dialect` of a function.
    """
    from mavwire.dialects.v20 import upstream

    kinds = sorted(counts.items(), key=lambda row: -row[1])
    groups: dict[tuple[bool, bool], Counter[str]] = {}
    for place, (kind, count) in enumerate(kinds):
        is_known, text = _kind_text(kind, dialect)
        in_upstream = kind is not None and _defines(upstream, *kind)
        shown = text if place < SHOWN else "other kinds"
        groups.setdefault((is_known, in_upstream), Counter())[shown] += count
    return "; ".join(
        f"{', '.join(f'{_messages(count)} of {text}' for text, count in texts.items())}"
        f"{'' if is_known else f' are not in the dialect {dialect.DIALECT}'}:"
        f" {_advice(dialect.DIALECT, is_known, in_upstream, way)}"
        for (is_known, in_upstream), texts in groups.items()
    )


def _messages(count: int) -> str:
    return "1 message" if count == 1 else f"{count:,} messages"


def _kind_text(kind: tuple[int, int | None] | None, dialect: Any) -> tuple[bool, str]:
    """Whether a dialect defines an id with another CRC_EXTRA, and the text of this kind."""
    if kind is None:
        return False, "other kinds"
    msgid, crc_extra = kind
    known = dialect.mavlink_map.get(msgid)
    if known is None:
        return False, f"id {msgid}"
    other = f"have another definition (CRC_EXTRA {crc_extra})"
    return True, f"id {msgid} {other} than {known.msgname} of {dialect.DIALECT}"


def _defines(dialect: Any, msgid: int, crc_extra: int | None) -> bool:
    if crc_extra is None:
        return msgid in dialect.mavlink_map
    return bool(dialect.MAVLink(None)._dialect.defines(msgid, crc_extra))


def _advice(name: str, is_known: bool, in_upstream: bool, way: str) -> str:
    given = [one if one in names() else f"{one}.xml" for one in name.split("+")]
    if in_upstream:  # which has all that the other built-in dialects have
        xml = [one for one in given if one not in names()]
        return f"try `{_naming([*xml, UPSTREAM], way)}`"
    if is_known:
        return f"name the XML file of that one too: `{_naming(['FILE.xml', *given], way)}`"
    return "name a dialect or an XML file that has it"


def _naming(given: list[str], way: str) -> str:
    if way == "argument":
        return f"dialect={json.dumps(given if len(given) > 1 else given[0])}"
    return " ".join(f"--dialect {one}" for one in (given if way == "options" else given[-1:]))
