"""Formats of tables and logs, their suffixes and compressions."""

FORMATS = {
    "parquet": ".parquet", "csv": ".csv", "jsonl": ".jsonl", "arrow": ".arrow", "mcap": ".mcap",
    "mcap-json": ".mcap",
}  # fmt: skip
ONE_FILE = frozenset(("mcap", "mcap-json"))
"""Formats that have one file for each log, and not one for each message type of it."""
TABLE_FORMATS = tuple(one for one in FORMATS if one not in ONE_FILE)
TEXTS = ("csv", "jsonl")
TEXT_SUFFIXES = {"zstd": ".zst", "gzip": ".gz"}
"""Suffixes after the suffix of a text, by compression."""
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
    "mcap-json": ("zstd", "lz4", "none"),
}
"""Compressions of each format, the default first."""
