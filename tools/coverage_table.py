#!/usr/bin/env python3
"""Write docs/coverage.md: every public name of the installed pymavlink, and what mavwire has of it.

A name that differs or is missing needs a reason in tools/coverage_reasons.toml, which quotes the place of
docs/compatibility.md that explains it. Nothing of pymavlink's sources is read.

    tools/coverage_table.py            # write docs/coverage.md
    tools/coverage_table.py --check    # exit 1 if it is not up to date, or if a reason is lacking
    tools/coverage_table.py --quick    # the same without most dialects, which take half a minute
"""

from __future__ import annotations

import argparse
import importlib.metadata
import sys
import tomllib
from collections import Counter, defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path

from api_compare import Row, compare_modules, modules

OURS, THEIRS = "mavwire", "pymavlink"
ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "coverage.md"
EXPLAINED = ROOT / "docs" / "compatibility.md"
REASONS = ROOT / "tools" / "coverage_reasons.toml"
DIALECTS = "dialects.v"
# Stands for all dialects in a quick check; the compatibility tests compare each of them.
A_DIALECT = "dialects.v20.minimal"
TOTAL = "**all**"
HEAD = """# What there is of pymavlink {version}

Every public name of pymavlink's modules, and whether mavwire has it with the same signature or value.
Written by `make coverage-table` out of both packages as they are at run time; a test keeps it up to
date. How names *behave* is compared by the rest of the tests; what behaves differently on purpose
is in [compatibility.md](compatibility.md).

Counted are modules, the functions, classes and constants that they show, and the methods and
attributes of classes; not what a module imported from elsewhere, no name with a leading underscore,
and no description of a message or enum. pymavlink's scripts are in [pymavlink-tools.md](pymavlink-tools.md).

"""


@dataclass(frozen=True)
class Reason:
    """The reason why some names differ; `quote` is a sentence of docs/compatibility.md."""

    names: list[str]
    reason: str
    quote: str

    def covers(self, row: Row) -> bool:
        """Whether it is about this row."""
        return any(fnmatchcase(full_name(row), name) for name in self.names)


def full_name(row: Row) -> str:
    """`mavutil.mavfile.recv_match`."""
    return f"{row.module}.{row.name}".rstrip(".")


def read_reasons() -> tuple[dict[str, str], list[Reason]]:
    """Modules that are not compared, with why, and the reasons."""
    data = tomllib.loads(REASONS.read_text())
    return data["not_compared"], [Reason(**one) for one in data["difference"]]


def find_rows(names: Iterable[str]) -> list[Row]:
    """The comparison of all public names of both packages in these modules."""
    return [row for name in names for row in compare_modules(name, OURS, THEIRS)]


def unexplained(rows: Iterable[Row], reasons: list[Reason]) -> list[Row]:
    """Differences without a reason."""
    return [row for row in rows if row.problem and not any(one.covers(row) for one in reasons)]


def idle(rows: list[Row], reasons: list[Reason]) -> list[str]:
    """Names of reasons that no difference has."""
    wrong = [full_name(row) for row in rows if row.problem]
    return [
        name
        for one in reasons
        for name in one.names
        if not any(fnmatchcase(row, name) for row in wrong)
    ]


def unquoted(reasons: list[Reason]) -> list[str]:
    """Quotes that docs/compatibility.md does not have."""
    page = EXPLAINED.read_text()
    return [one.quote for one in reasons if one.quote not in page]


def count(rows: Iterable[Row]) -> tuple[int, int, int]:
    """How many are the same, different, missing."""
    kinds = Counter("missing" if r.missing else "other" if r.problem else "same" for r in rows)
    return kinds["same"], kinds["other"], kinds["missing"]


def summary(by_module: dict[str, list[Row]]) -> str:
    """The table of counts."""
    lines = [
        "| module | names | identical | deliberately different | missing |",
        "| --- | ---: | ---: | ---: | ---: |",
    ]
    total = [row for rows in by_module.values() for row in rows]
    for name, rows in [*by_module.items(), (TOTAL, total)]:
        numbers = " | ".join(f"{number:,}" for number in (len(rows), *count(rows)))
        lines.append(f"| {name} | {numbers} |")
    return "\n".join(lines) + "\n"


def differences(rows: list[Row], reasons: list[Reason], left_out: dict[str, str]) -> str:
    """Each reason with the names it is about, and the modules that are not compared."""
    parts = ["\n## What differs, and what is missing\n"]
    for one in reasons:
        covered = [row for row in rows if row.problem and one.covers(row)]
        parts.append(f"\n{one.reason[0].upper()}{one.reason[1:]}:\n\n")
        parts += [f"* `{full_name(row)}`: {row.problem}\n" for row in covered]
    parts.append("\nNot compared:\n\n")
    parts += [f"* `{name}`: {why}\n" for name, why in left_out.items()]
    return "".join(parts)


def listing(by_module: dict[str, list[Row]]) -> str:
    """The names of each module that is no dialect."""
    parts = ["\n## All names\n\nThose that differ or are missing are struck through. "]
    parts.append("Those of the dialect modules are counted above.\n")
    for name, rows in by_module.items():
        shown = [spell(row) for row in rows if row.name]
        if shown and not name.startswith(DIALECTS):
            parts.append(f"\n### {name}\n\n{', '.join(shown)}\n")
    return "".join(parts)


def spell(row: Row) -> str:
    """A name as the listing shows it."""
    text = f"`{row.name}`"
    return f"~~{text}~~" if row.problem else text


def render(rows: list[Row], reasons: list[Reason], left_out: dict[str, str]) -> str:
    """The whole page."""
    by_module: dict[str, list[Row]] = defaultdict(list)
    for row in rows:
        by_module[row.module].append(row)
    head = HEAD.format(version=importlib.metadata.version(THEIRS))
    return head + summary(by_module) + differences(rows, reasons, left_out) + listing(by_module)


def mistakes(rows: list[Row], reasons: list[Reason]) -> list[str]:
    """Mistakes in the reasons."""
    return [
        *(f"no reason: {full_name(row)}: {row.problem}" for row in unexplained(rows, reasons)),
        *(f"a reason for no difference: {name}" for name in idle(rows, reasons)),
        *(f"docs/compatibility.md does not say: {quote}" for quote in unquoted(reasons)),
    ]


def is_current(page: str, text: str, passed_over: list[str]) -> bool:
    """Whether `page` is `text`, and has besides a line for each module that was passed over."""
    aside = tuple(f"| {name} |" for name in [*passed_over, TOTAL] if passed_over)
    lines = page.splitlines()
    rest = [line for line in lines if not line.startswith(aside)]
    now = [line for line in text.splitlines() if not line.startswith(aside)]
    return rest == now and len(lines) - len(rest) == len(aside)


def main() -> int:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="write nothing")
    parser.add_argument("--quick", action="store_true", help="write nothing, pass over dialects")
    args = parser.parse_args()
    left_out, reasons = read_reasons()
    names = modules(THEIRS, frozenset(left_out))
    dialects = [name for name in names if name.startswith(DIALECTS) and name != A_DIALECT]
    passed_over = dialects if args.quick else []
    rows = find_rows(name for name in names if name not in passed_over)
    wrong = mistakes(rows, reasons)
    text = render(rows, reasons, left_out)
    if not (args.check or args.quick):
        PAGE.write_text(text)
    elif not is_current(PAGE.read_text() if PAGE.exists() else "", text, passed_over):
        wrong.append("docs/coverage.md is not up to date: make coverage-table")
    print("\n".join(wrong), end="\n" if wrong else "", file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    raise SystemExit(main())
