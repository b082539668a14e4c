"""The rows of the table and what they are measured against: G1 to G18, each with what must hold and
what to aim at.

A goal is a ratio to pymavlink in the same run; where there is none it is a rate in million messages
a second. docs/benchmarks.md explains the rows.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Goal:
    """At least `ratio` times pymavlink; without one, `rate` million messages a second."""

    ratio: float | None = None
    rate: float | None = None

    def __str__(self) -> str:
        return f"{self.ratio:g}x" if self.ratio else f"{self.rate:g}M/s"

    def met(self, ratio: float | None, rate: float) -> bool:
        """Whether a measurement reaches the goal; the rate is in messages a second."""
        if self.ratio is not None and ratio is not None:
            return ratio >= self.ratio
        return self.rate is not None and rate >= self.rate * 1e6


@dataclass(frozen=True)
class Row:
    """A row: its case in cases.py, its number, its text, its goals."""

    case: str
    number: str
    title: str
    must: Goal | None = None
    aim: Goal | None = None


ROWS = (
    Row("stream-64k", "G1", "parse_buffer, 64 KiB chunks", Goal(80, 4), Goal(165, 8)),
    Row("stream-280", "G1", "parse_buffer, 280 byte chunks"),
    Row("stream-1", "G1", "parse_char, byte at a time"),
    Row("version1", "G1", "parse_buffer, MAVLink 1"),
    Row("corrupt", "G1", "parse_buffer, 1% of frames damaged"),
    Row("recv_match-mmap", "G2", "tlog: recv_match()", Goal(60, 1.5), Goal(120, 3)),
    Row("recv_match-stream", "G2", "tlog: recv_match(), mavlogfile", Goal(60, 1.5), Goal(120, 3)),
    Row("recv_msg-mmap", "G2", "tlog: recv_msg()", Goal(60, 1.5), Goal(120, 3)),
    Row("open_log", "G2", "tlog: for msg in open_log()", Goal(None, 4), Goal(None, 8)),
    Row("fields", "G3", "parse and read all fields", Goal(14, 0.6), Goal(None, 1.2)),
    Row("attribute", "G3", "one attribute", Goal(None, 10)),
    Row("to_dict", "G4", "parse and to_dict()", Goal(None, 0.7), Goal(None, 1.1)),
    Row("to_json", "G4", "parse and to_json()", Goal(None, 0.5), Goal(None, 1)),
    Row("str", "G4", "parse and str()", Goal(None, 0.5), Goal(None, 1)),
    Row("filter-mmap", "G5", "tlog: two types of 37", Goal(92, 10), Goal(None, 20)),
    Row("filter-stream", "G5", "tlog: two types, mavlogfile"),
    Row("index", "G6", "open and index a tlog", Goal(37, 15), Goal(None, 30)),
    Row("columns", "G7", "tlog into columns", Goal(270, 5), Goal(540, 10)),
    Row("parquet", "G8", "tlog to zstd Parquet", Goal(85, 1.5), Goal(None, 3)),
    Row("pack", "G9", "msg.pack()", Goal(None, 2), Goal(None, 4)),
    Row("send", "G9", "x_send(...)", Goal(18, 1.2), Goal(None, 2.5)),
    Row("pack-signed", "G10", "msg.pack(), signed", Goal(None, 1.2), Goal(None, 2.4)),
    Row("send-signed", "G10", "x_send(...), signed", Goal(None, 0.9), Goal(None, 1.8)),
    Row("signed-no-key", "G11", "parse_buffer, signed, no key"),
    Row("verify", "G11", "parse_buffer, signed and verified", Goal(74, 2.5), Goal(None, 4)),
    Row("bin-open", "G15", "dataflash: open"),
    Row("bin-recv_match", "G15", "dataflash: recv_match()", Goal(27, 2), Goal(None, 5)),
    Row("bin-filter", "G15", "dataflash: a type, 20% of the log", Goal(None, 15), Goal(None, 30)),
    Row(
        "bin-filter-rare", "G15", "dataflash: a type, 4% of the log", Goal(None, 15), Goal(None, 30)
    ),
    Row("bin-columns", "G15", "dataflash into columns", Goal(None, 10), Goal(None, 20)),
    Row("bin-fields", "G15", "dataflash: read all columns"),
    Row("bin-str", "G15", "dataflash: read and str()"),
)

# The command line tools that print a log.
DUMP_ROWS = (
    Row("dump-json", "G14", "dump to JSON", Goal(60, 1), Goal(None, 2)),
    Row("dump-standard", "G14", "dump to text", Goal(60, 0.7), Goal(None, 1.5)),
)
