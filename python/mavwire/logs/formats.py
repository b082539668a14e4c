"""Formats that tables and logs are written in, their suffixes, and what they are compressed with."""

from __future__ import annotations

FORMATS = {
    "parquet": ".parquet", "csv": ".csv", "jsonl": ".jsonl", "arrow": ".arrow", "mcap": ".mcap",
}  # fmt: skip
ONE_FILE = frozenset(("mcap",))
"""Formats that have one file for each log, and not one for each message type of it."""
TABLE_FORMATS = tuple(one for one in FORMATS if one not in ONE_FILE)
TEXTS = ("csv", "jsonl")
TEXT_SUFFIXES = {"zstd": ".zst", "gzip": ".gz"}
"""What follows the suffix of a text that is compressed."""
SUFFIXES = (
    *FORMATS.values(),
    *(FORMATS[text] + more for text in TEXTS for more in TEXT_SUFFIXES.values()),
)
"""All that names of converted files end in."""
COMPRESSIONS = {
    "parquet": ("zstd", "snappy", "none"),
    "csv": ("none", "gzip", "zstd"),
    "jsonl": ("none", "gzip", "zstd"),
    "arrow": ("none",),
    "mcap": ("zstd", "lz4", "none"),
}
"""What each format may be compressed with, the default first."""
