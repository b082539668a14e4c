"""Writes measured figures into the documents, between the marks that stand there.

So the figures that users read are those of a run and never typed by hand.
"""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
# Rows of the README: the path as in the big table, and in plain words.
SHORT = {
    "parse_buffer, 64 KiB chunks": "objects from a raw stream",
    "tlog: recv_match()": "`recv_match()` over a log",
    "tlog: two types of 37": "`recv_match(type=...)` over a log, per message in the file",
    "parse_buffer, signed and verified": "signed messages, verified",
    "x_send(...)": "`x_send(...)`",
}


def markdown(rows: list[list[str]]) -> str:
    """A table for a document; the first row is the header."""
    rule = ["---"] * len(rows[0])
    return "\n".join("| " + " | ".join(row) + " |" for row in [rows[0], rule, *rows[1:]])


def short_table(rows: list[list[str]]) -> str:
    """The README's few rows."""
    head = ["on one core, microseconds a message", "pymavlink 2.4.50", "mavwire", "times as fast"]
    picked = {row[1]: [SHORT[row[1]], row[2], row[3], row[5]] for row in rows if row[1] in SHORT}
    return markdown([head, *(picked[title] for title in SHORT if title in picked)])


def between(text: str, name: str, content: str) -> str:
    """`text` with the lines between the marks `<!-- name ... -->` and `<!-- /name -->` replaced."""
    pattern = re.compile(rf"(<!-- {name}\b[^\n]*-->\n).*?(<!-- /{name} -->)", re.DOTALL)
    if not pattern.search(text):
        raise ValueError(f"there are no marks {name}")
    return pattern.sub(lambda found: f"{found[1]}{content}\n{found[2]}", text)


def write(path: Path, name: str, content: str) -> None:
    """Put content between the marks of a document."""
    path.write_text(between(path.read_text(encoding="utf-8"), name, content), encoding="utf-8")


def update(title: str, rows: list[list[str]], lines: list[str]) -> None:
    """Put a run's figures into README.md and docs/benchmarks.md."""
    full = "\n".join([title + ".", "", markdown(rows), "", *(f"* {line}" for line in lines)])
    write(ROOT / "README.md", "speed", short_table(rows))
    write(ROOT / "docs" / "benchmarks.md", "results", full)
