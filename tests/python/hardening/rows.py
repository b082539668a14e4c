"""The figures of the table, and what mavwire's must be."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from hardening import code, kills, links, logs, recovery, signing, wire

Measure = Callable[[str, bool], dict[str, Any]]
Judge = Callable[[Any], bool]


@dataclass(frozen=True)
class Goal:
    """What an answer must be, in words and as a check; `loose` is the check of the short form."""

    text: str
    met: Judge
    loose: Judge | None = None


@dataclass(frozen=True)
class Figure:
    """A measurement with one goal for all of its rows, or one for each in their order."""

    title: str
    measure: Measure
    goals: tuple[Goal, ...]
    in_short: bool = True

    def goal(self, row: int) -> Goal:
        return self.goals[min(row, len(self.goals) - 1)]


def exactly(value: object) -> Goal:
    return Goal(str(value), lambda got: bool(got == value))


def at_least(value: float, loose: float | None = None) -> Goal:
    least = value if loose is None else loose
    return Goal(f"{value:g} or more", lambda got: got >= value, lambda got: got >= least)


def at_most(value: float, loose: float | None = None) -> Goal:
    most = value if loose is None else loose
    return Goal(f"{value:g} or less", lambda got: got <= value, lambda got: got <= most)


def refused(answer: str) -> bool:
    """By an error that says so; any other one may be a fault of the package."""
    return answer.endswith(" ms") and answer.startswith(("MAVParseError,", "MAVSyntaxError,"))


def quickly(answer: str) -> bool:
    return refused(answer) and float(answer.split()[-2]) < 100


NONE, NO = exactly(0), exactly("no")
# Speeds are judged against a tenth in the short form: other programs may be running.
SPEEDS = tuple(at_least(value, value / 10) for value in (200, 30, 50, 500, 10))
POLICIES = 2

FIGURES = (
    Figure("signing", signing.cases, (NONE,)),
    Figure("without the key", signing.attacks, (NO,)),
    Figure("garbage, MB per CPU second", wire.garbage, SPEEDS * POLICIES),
    Figure("growth of time with size", wire.growth, (at_most(1.1),), in_short=False),
    Figure("good frames kept", wire.kept, (at_least(99), at_least(985), at_most(5))),
    Figure("kept after 8 MB unaligned", wire.unaligned, (at_most(64, 1000),)),
    Figure("telemetry log cut anywhere", logs.cuts, (NONE,)),
    Figure("damaged dataflash logs", logs.mutated, (NONE,)),
    Figure("telemetry log, % found", recovery.of_telemetry, (exactly(100.0),)),
    Figure("dataflash log, % found", recovery.of_dataflash, (exactly(100.0),)),
    Figure("code that is run", code.runs, (NO,)),
    Figure("hostile definitions", code.bombs, (Goal("refused in ms", quickly, refused),)),
    Figure("bytes for a made-up key", links.tables, (at_most(1, 10),)),
    Figure("files of a vehicle", links.ftp_sessions, (exactly(4),)),
    Figure("backlog of messages", links.backlog, (at_most(10), NONE)),
    Figure("victim of stray bytes, of 500", links.injection, (exactly(500),)),
    Figure("traffic for a garbage peer", links.reflection, (NO,)),
    Figure("tcpin, the second client", links.second_client, (exactly("yes"),)),
    Figure("after the end of a stream", links.end_of_stream, (at_most(1),)),
    Figure("slow TCP reader", links.slow_reader, (NONE,)),
    Figure("Ctrl-C", links.interrupted, (at_most(250),), in_short=False),
    Figure("kill -9 while recording", logs.killed, (NONE,)),
    Figure("kill -9 while writing", kills.sweep, (NONE,), in_short=False),
    Figure("full disk, messages of 500", logs.full_disk, (exactly(500),)),
    Figure("four senders on one link", links.senders, (NONE,)),
    Figure("secrets in a recorded log", logs.secrets, (NO,)),
)
