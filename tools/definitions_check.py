#!/usr/bin/env python3
"""Compare newer checkouts of the upstreams with the pinned definitions; a verdict for each file.

    tools/definitions_check.py DIR...                 # exit 1 where a change is held back
    tools/definitions_check.py --max-age 30 DIR...    # exit 1 where changes came and the pins are older

Additive are new messages, new extension fields at the end, new enums and new entries: `tools/union_definitions.py` imports
these. A changed CRC_EXTRA, an id or a name that is taken, and a changed or renamed enum value are held back: the union keeps
its own. Such a change is imported once message_definitions/sources.toml has it under `[[accepted]]`.
Files of a checkout that are not meant to be used together may share an id. Those of `all.xml` come first.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from datetime import date
from pathlib import Path
from typing import Any

import definition_sources
from definition_sources import UNION, Accepted
from import_definitions import OUTPUT
from mavwire._native import DefinitionError
from mavwire.cli.dev._definition_facts import Facts, Message, definition_files, of_file, of_set

ADDITIVE = "additive"
ACCEPTED = "accepted"
IMPORTED = {ADDITIVE, ACCEPTED}
ID_CLASH = "id clash"
HOW_TO_ACCEPT = """The union keeps its own of what is held back. To accept a change add its lines to
message_definitions/sources.toml, with a reason, and run make definitions-import:"""
Change = tuple[str, str, Accepted | None]
"""The kind, a text, and what would accept it."""


@dataclass
class Verdict:
    """The changes in a file by their kind, and the part of it that may be imported."""

    file: Path
    facts: Facts
    is_pinned: bool
    changes: dict[str, list[str]] = field(default_factory=dict)
    to_accept: list[Accepted] = field(default_factory=list)

    def add(self, kind: str, text: str, to_accept: Accepted | None = None) -> None:
        """Note a change, and what would accept it."""
        self.changes.setdefault(kind, []).append(text)
        self.to_accept += [to_accept] if to_accept else []

    @property
    def is_breaking(self) -> bool:
        """Whether something is held back."""
        return not self.changes.keys() <= IMPORTED

    def __str__(self) -> str:
        kinds = [f"{kind}: {', '.join(texts)}" for kind, texts in sorted(self.changes.items())]
        return f"{self.file}: {'; '.join(kinds) or 'unchanged'}"


class Judge:
    """The union so far, and the decisions about changes of it."""

    def __init__(self, union: Path, accepted: list[Accepted]) -> None:
        self.union = of_file(union) if union.is_file() else Facts()
        self.drop_in = of_set(str(OUTPUT))
        self.pinned: set[str] = set()
        self.new = {(one.id or one.enum, one.old): one.new for one in accepted}
        self.replaced: set[tuple[Any, Any]] = set()
        for one in accepted:  # a later one may take back an earlier one
            key = one.id or one.enum
            self.replaced = (self.replaced | {(key, one.old)}) - {(key, one.new)}

    def check(self, folder: Path) -> list[Verdict]:
        """A verdict for each file of a folder, or for one file. The union gets what may be imported."""
        counted = of_set(str(folder)).messages
        verdicts = []
        for path in definition_files(folder) if folder.is_dir() else [folder]:
            facts = of_file(path)
            verdict = Verdict(path, facts, definition_sources.digest(path) in self.pinned)
            facts.messages = {
                id_: message
                for id_, message in facts.messages.items()
                if self._takes_message(id_, message, counted[id_].key == message.key, verdict)
            }
            for enum, entries in facts.enums.items():
                if enum not in self.union.enums:
                    verdict.add(ADDITIVE, f"enum {enum}")
                    continue
                facts.enums[enum] = {
                    name: value
                    for name, value in entries.items()
                    if self._takes_entry(enum, name, value, verdict)
                }
            verdicts.append(verdict)
        for verdict in verdicts:
            self._add(verdict.facts, counted)
        return verdicts

    def _add(self, facts: Facts, counted: dict[int, Message]) -> None:
        """Add what is not held back to the union, in the place of what it replaces."""
        for id_, message in facts.messages.items():
            known = self.union.messages.get(id_)
            if counted[id_].key == message.key and (known is None or known.key != message.key):
                self.union.messages[id_] = message
        for enum, entries in facts.enums.items():
            self.union.enums[enum] = {
                name: value
                for name, value in (self.union.enums.get(enum, {}) | entries).items()
                if (enum, f"{name} = {value}") not in self.replaced
            }

    def _takes_message(self, id_: int, message: Message, counts: bool, verdict: Verdict) -> bool:
        """Note the changes of a message that counts; whether it may be imported."""
        changes = [*self._changes(id_, message)]
        for change in changes if counts else []:
            verdict.add(*change)
        is_replaced = (id_, message.crc_extra) in self.replaced
        return not is_replaced and all(kind in IMPORTED for kind, _, _ in changes)

    def _changes(self, id_: int, message: Message) -> Iterator[Change]:
        """Compare a message with the one of the union that has its id."""
        if (id_, message.crc_extra) in self.replaced:
            return
        known = self.union.messages.get(id_)
        label = f"{message.name} ({id_})"
        if known is None:
            owners = (one for one in self.union.messages.items() if one[1].name == message.name)
            owner, other = next(owners, (id_, message))
            if owner == id_ or (owner, other.crc_extra) in self.replaced:
                yield ADDITIVE, f"message {label}", None
            else:
                yield (
                    ID_CLASH,
                    f"{message.name} is {owner} and {id_}",
                    Accepted(other.crc_extra, owner),
                )
        elif known.key != message.key:
            old, new = known.crc_extra, message.crc_extra
            if self.new.get((id_, old)) == new:
                yield ACCEPTED, f"{label} {old} -> {new}", None
            elif known.name != message.name:
                yield (
                    ID_CLASH,
                    f"{id_} is {known.name} and {message.name}",
                    Accepted(old, id_, new=new),
                )
            else:
                yield "changed CRC_EXTRA", f"{label} {old} -> {new}", Accepted(old, id_, new=new)
        elif (
            known.wire != message.wire[: len(known.wire)]
            and message.wire != known.wire[: len(message.wire)]
        ):
            yield "changed extension fields", label, None
        else:
            for name, *_ in message.wire[len(known.wire) :]:
                yield ADDITIVE, f"field {name} of {label}", None

    def _takes_entry(self, enum: str, name: str, value: int, verdict: Verdict) -> bool:
        """Note the change that an entry is; whether it may be imported."""
        known = self.union.enums[enum]
        if known.get(name) == value:
            return True
        rival = name if name in known else {one: other for other, one in known.items()}.get(value)
        if rival is None:
            verdict.add(ADDITIVE, f"entry {name}")
            return True
        old, new = f"{rival} = {known[rival]}", f"{name} = {value}"
        text = (
            f"{name} {known[name]} -> {value}"
            if rival == name
            else f"{value} is {rival} and {name}"
        )
        if self.new.get((enum, old)) == new:
            verdict.add(ACCEPTED, text)
            return True
        # Upstream gave values of the drop-in dialects other names, which the union has.
        is_drop_in = self.drop_in.enums.get(enum, {}).get(name) == value
        if (enum, new) not in self.replaced and not is_drop_in:
            verdict.add("enum values changed", text, Accepted(old, enum=enum, new=new))
        return False


def days_behind(sources: dict[str, definition_sources.Source], today: date) -> int:
    """The age in days of the oldest pinned commit."""
    return max((today - one.date).days for name, one in sources.items() if "/" in name and one.date)


def report(verdicts: list[Verdict]) -> str:
    """The changed files, and how to accept what is held back."""
    lines = [str(one) for one in verdicts if one.changes]
    if to_accept := [str(one) for verdict in verdicts for one in verdict.to_accept]:
        lines += ["", HOW_TO_ACCEPT, *dict.fromkeys(to_accept)]
    return "\n".join(lines) or f"{len(verdicts)} files, none of them changed"


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
    try:
        judge = Judge(UNION, definition_sources.accepted())
        judge.pinned = {digest for one in sources.values() for digest in one.sha256.values()}
        verdicts = [one for folder in options.folders for one in judge.check(folder)]
    except (OSError, DefinitionError) as failure:
        print(f"error: {failure}", file=sys.stderr)
        return 2
    print(report(verdicts))
    if options.max_age is None:
        return int(any(one.is_breaking for one in verdicts))
    age = days_behind(sources, today or date.today())
    if age <= options.max_age or all(one.is_pinned for one in verdicts if one.changes):
        return 0
    print(
        f"the pinned definitions are {age} days old, and these changes are not in them: run make definitions-import"
    )
    return 1


if __name__ == "__main__":
    sys.exit(main())
