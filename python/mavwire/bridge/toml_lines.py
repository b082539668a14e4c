"""Where the keys of a TOML text stand, which `tomllib` does not tell. For texts that `tomllib` has read,
and before that, whether it can do so in good time.
"""

from __future__ import annotations

import re

# Names of a longer path are left out: no option has one.
MAX_DEPTH = 4
# Dots in a key: `tomllib` takes time by the square of its parts.
MAX_DOTS = 32
# Begins nowhere but where a part may, and never goes back: linear, whatever the text.
_TOO_DOTTED = re.compile(
    r"(?<!\.)(?<!\. )(?:(?:(?<![\w-])[A-Za-z0-9_-]++|(?<!\\)\"(?:[^\"\\\n]|\\.)*+\"|'[^'\n]*+')"
    rf"[ \t]*+\.[ \t]*+){{{MAX_DOTS + 1}}}"
)
_BARE = r"[A-Za-z0-9_-]+"
_QUOTED = r'"(?:[^"\\]|\\.)*"|\'[^\']*\''
_NAME = re.compile(rf"{_BARE}|{_QUOTED}")
_KEY = rf"(?:{_BARE}|{_QUOTED})(?:[ \t]*\.[ \t]*(?:{_BARE}|{_QUOTED}))*"
_STATEMENT = re.compile(
    rf"(?P<blank>[ \t\r\n]+|\#[^\n]*)|\[\[[ \t]*(?P<item>{_KEY})[ \t]*\]\]"
    rf"|\[[ \t]*(?P<table>{_KEY})[ \t]*\]|(?P<key>{_KEY})[ \t]*="
)
_PART_OF_VALUE = re.compile(
    r'(?P<text>"""(?:[^\\]|\\.)*?"{3,5}|\'\'\'.*?\'{3,5}'
    rf"|{_QUOTED})|(?P<open>[\[{{])|(?P<close>[\]}}])|(?P<end>\n)|\#[^\n]*|[^\[\]{{}}\"'\#\n]+",
    re.DOTALL,
)


def too_dotted(text: str) -> int | None:
    """The first line, from 1, with what may be a key of more than `MAX_DOTS` dots. For any text."""
    found = _TOO_DOTTED.search(text)
    return None if found is None else text.count("\n", 0, found.start()) + 1


def key_lines(text: str) -> dict[tuple[str | int, ...], int]:
    """The line of each key and table, by its path: `("link", 1, "endpoint")` for the second [[link]].

    What stands inside a value, as in an inline table, is not among them.
    """
    lines: dict[tuple[str | int, ...], int] = {}
    counts: dict[tuple[str | int, ...], int] = {}
    table: tuple[str | int, ...] = ()
    at, line = 0, 1
    while (found := _STATEMENT.match(text, at)) is not None:
        kind, end = found.lastgroup, found.end()
        if kind == "key":
            names = _names(found["key"])
            for depth in range(1, len(names) + 1):
                lines.setdefault((*table, *names[:depth]), line)
            end = _end_of_value(text, end)
        elif kind in ("item", "table"):
            table = _with_numbers(_names(found[kind]), counts, is_item=kind == "item")
            lines.setdefault(table, line)
        line += text.count("\n", at, end)
        at = end
    return lines


def _names(key: str) -> tuple[str, ...]:
    """The parts of a dotted key. One with escapes in it is not found later, and does no harm."""
    return tuple(
        name[1:-1] if name[0] in "\"'" else name for name in _NAME.findall(key)[:MAX_DEPTH]
    )


def _with_numbers(
    names: tuple[str, ...], counts: dict[tuple[str | int, ...], int], is_item: bool
) -> tuple[str | int, ...]:
    """The path of a table; one that is in an array belongs to the array's last item."""
    path: tuple[str | int, ...] = ()
    for depth, name in enumerate(names, 1):
        path = (*path, name)
        if is_item and depth == len(names):
            counts[path] = counts.get(path, 0) + 1
        if path in counts:
            path = (*path, counts[path] - 1)
    return path


def _end_of_value(text: str, at: int) -> int:
    """Behind the value that begins here."""
    depth = 0
    while (found := _PART_OF_VALUE.match(text, at)) is not None:
        if found["end"] and not depth:
            break
        depth += bool(found["open"]) - bool(found["close"])
        at = found.end()
    return at
