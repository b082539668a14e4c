"""Messages that a dialect does not define: how many a log has, and the text that says so."""

from __future__ import annotations

import os
import struct
import warnings
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping

_STAMP = struct.Struct(">Q")
SHOWN = 8
"""Kinds that a text names."""


class UnknownMessageWarning(UserWarning):
    """A log has messages that the dialect does not define, so that no table holds them."""


def warn_unknown(counts: Mapping[tuple[int, int] | None, int], path: str) -> None:
    """Warn of the messages of a log that the dialect does not define, as `LogColumns.unknown` counts them."""
    if counts:
        text = f"{path}: left out {unknown_text(named(counts))}"
        warnings.warn(text, UnknownMessageWarning, stacklevel=3)


def log_of_table(path: str | os.PathLike[str]) -> bytes:
    """A telemetry log with the messages of a table `mavwire.unknown`, in a Parquet or an Arrow file.

    Signatures are not there any more. Raises OSError, ImportError without pyarrow, and ValueError for another table.
    """
    rows = _table(os.fsdecode(path)).to_pylist()
    try:
        return b"".join(_STAMP.pack(_micros(row["timestamp"])) + _frame(row) for row in rows)
    except (KeyError, TypeError, struct.error) as error:
        raise ValueError(f"{path}: no table mavwire.unknown ({error!r})") from None


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
        raise ValueError(f"{path}: {error}") from None


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


def named(counts: Mapping[tuple[int, int] | None, int]) -> dict[str, int]:
    """The counts by the text of each kind, the most frequent first."""
    texts = {
        "other kinds" if kind is None else "id {} with CRC_EXTRA {}".format(*kind): count
        for kind, count in counts.items()
    }
    return dict(sorted(texts.items(), key=lambda row: -row[1]))


def unknown_text(counts: Mapping[str, int]) -> str:
    """The text about messages that were left out, with advice."""
    shown = [f"{count:,} of {kind}" for kind, count in list(counts.items())[:SHOWN]]
    if len(counts) > SHOWN:
        shown.append(f"{sum(list(counts.values())[SHOWN:]):,} others")
    return (
        f"{sum(counts.values()):,} messages that the dialect does not define ({', '.join(shown)}):"
        " name a dialect or an XML file that does"
    )
