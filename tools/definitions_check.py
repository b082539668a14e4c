#!/usr/bin/env python3
"""Compare newer checkouts of the upstreams with the pinned definitions; a verdict for each file.

    tools/definitions_check.py DIR...                 # exit 1 where more than additions came
    tools/definitions_check.py --max-age 30 DIR...    # exit 1 where changes came and the pins are older

Additive are new messages, new extension fields at the end, new enums and new entries: `tools/union_definitions.py` imports
these. A changed CRC_EXTRA, an id or a name that is taken, and a changed or renamed enum value need a decision.
Within a checkout the files that `all.xml` includes come first. Later messages with the same id are left out of the union.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass, field
from datetime import date
from pathlib import Path

import definition_sources
from import_definitions import OUTPUT
from mavwire._native import DefinitionError
from mavwire.cli.dev._definition_facts import Facts, Message, definition_files, of_file, of_set
from union_definitions import UNION

ADDITIVE = "additive"


@dataclass
class Verdict:
    """What came in a file, by kind of change."""

    file: str
    changes: dict[str, list[str]] = field(default_factory=dict)

    def add(self, kind: str, text: str) -> None:
        """Note a change."""
        self.changes.setdefault(kind, []).append(text)

    @property
    def is_breaking(self) -> bool:
        """Whether more than additions came."""
        return not self.changes.keys() <= {ADDITIVE}

    def __str__(self) -> str:
        kinds = [f"{kind}: {', '.join(texts)}" for kind, texts in sorted(self.changes.items())]
        return f"{self.file}: {'; '.join(kinds) or 'unchanged'}"


def check(folder: Path, union: Facts, drop_in: Facts, pinned: set[str]) -> list[Verdict]:
    """A verdict for each file of a checkout. Files with a digest of `pinned` are unchanged. The union gets what is new."""
    files = {path.stem: path for path in definition_files(folder)}
    facts = {name: of_file(path) for name, path in files.items()}
    taken: dict[int, tuple[str, int]] = {}
    verdicts = []
    for name in in_order(facts):
        verdict = Verdict(str(files[name]))
        verdicts.append(verdict)
        is_pinned = definition_sources.digest(files[name]) in pinned
        for id_, message in facts[name].messages.items():
            key = (message.name, message.crc_extra)
            if taken.setdefault(id_, key) == key and not is_pinned:
                judge_message(id_, message, union, verdict)
        if not is_pinned:
            judge_enums(facts[name], union, drop_in, verdict)
    for name in in_order(facts):
        union.add(facts[name])
    return verdicts


def in_order(facts: dict[str, Facts]) -> list[str]:
    """The names of the files: `all` with all that it includes, then the others."""
    order = ["all"]
    for name in order:  # which grows meanwhile
        included = facts[name].includes if name in facts else []
        order += [one for one in included if one not in order]
    return [name for name in dict.fromkeys([*order, *sorted(facts)]) if name in facts]


def judge_message(id_: int, message: Message, union: Facts, verdict: Verdict) -> None:
    """Compare a message with the one that has its id."""
    known = union.messages.get(id_)
    label = f"{message.name} ({id_})"
    if known is None:
        others = [other for other, one in union.messages.items() if one.name == message.name]
        if others:
            verdict.add("id clash", f"{message.name} is {others[0]} and {id_}")
        else:
            verdict.add(ADDITIVE, f"message {label}")
    elif known.name != message.name:
        verdict.add("id clash", f"{id_} is {known.name} and {message.name}")
    elif known.crc_extra != message.crc_extra:
        verdict.add("changed CRC_EXTRA", f"{label} {known.crc_extra} -> {message.crc_extra}")
    elif (
        known.wire != message.wire[: len(known.wire)]
        and message.wire != known.wire[: len(message.wire)]
    ):
        verdict.add("changed extension fields", label)
    else:
        for name, *_ in message.wire[len(known.wire) :]:
            verdict.add(ADDITIVE, f"field {name} of {label}")


def judge_enums(facts: Facts, union: Facts, drop_in: Facts, verdict: Verdict) -> None:
    """Compare the entries of a file's enums with those of the same name."""
    for enum, entries in facts.enums.items():
        known = union.enums.get(enum)
        if known is None:
            verdict.add(ADDITIVE, f"enum {enum}")
            continue
        names = {value: name for name, value in known.items()}
        for name, value in entries.items():
            if drop_in.enums.get(enum, {}).get(name) == value:
                continue  # upstream gave the value another name, which the union has
            if name in known and known[name] != value:
                verdict.add("enum values changed", f"{name} {known[name]} -> {value}")
            elif name not in known and value in names:
                verdict.add("enum values changed", f"{value} is {names[value]} and {name}")
            elif name not in known:
                verdict.add(ADDITIVE, f"entry {name}")


def days_behind(sources: dict[str, definition_sources.Source], today: date) -> int:
    """The age in days of the oldest pinned commit."""
    return max((today - one.date).days for name, one in sources.items() if "/" in name and one.date)


def main(argv: list[str] | None = None, today: date | None = None) -> int:
    """Command line entry point."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "folders", nargs="+", type=Path, metavar="DIR", help="checkout of an upstream"
    )
    parser.add_argument(
        "--max-age", type=int, metavar="DAYS", help="fail where changes came and the pins are older"
    )
    options = parser.parse_args(argv)
    sources = definition_sources.load()
    pinned = {digest for one in sources.values() for digest in one.sha256.values()}
    try:
        union = of_file(UNION)
        drop_in = of_set(str(OUTPUT))
        verdicts = [
            one for folder in options.folders for one in check(folder, union, drop_in, pinned)
        ]
    except (OSError, DefinitionError) as failure:
        print(f"error: {failure}", file=sys.stderr)
        return 2
    changed = [one for one in verdicts if one.changes]
    print("\n".join(map(str, changed)) or f"{len(verdicts)} files, none of them changed")
    if options.max_age is None:
        return int(any(one.is_breaking for one in changed))
    age = days_behind(sources, today or date.today())
    if not changed or age <= options.max_age:
        return 0
    print(
        f"the pinned definitions are {age} days old, and these changes are not in them: run make definitions-import"
    )
    return 1


if __name__ == "__main__":
    sys.exit(main())
