"""Warnings that `mavwire bridge` prints while it runs."""

from __future__ import annotations

import os
import time
from typing import TYPE_CHECKING, Any, NamedTuple

from mavwire.cli._errors import tell

if TYPE_CHECKING:
    from mavwire.bridge import Bridge

# Seconds between two looks, and until a recording or sink that still fails for the same reason is told of again.
INTERVAL = 1.0
AGAIN = 60.0


class Loss(NamedTuple):
    """The losses of a recording or a sink, and the error that causes them now."""

    name: str
    what: str
    lost: int
    error: str | None

    @property
    def line(self) -> str:
        """All of it for a reader."""
        lost = f"{self.lost} {self.what} lost"
        return ": ".join(filter(None, (self.name, self.error, lost)))


def losses(stats: dict[str, Any]) -> list[Loss]:
    """The losses and errors of recording and sinks so far."""
    recording = stats["recording"]
    found = [Loss(one["name"], "frames", one["failed"] + one["dropped"], one["error"])
             for one in stats["sinks"]]  # fmt: skip
    if recording:
        # The directory: the name of the log changes while it records.
        name = f"recording {os.path.dirname(recording['path'])}"
        found.append(Loss(name, "records", recording["dropped"], recording["error"]))
    return [loss for loss in found if loss.lost or loss.error]


def full_name(link: dict[str, Any]) -> str:
    """Of a link, and of the peer if it is one of those."""
    return " ".join(filter(None, (link["name"], link["peer"])))


class DropWarnings:
    """Tells of links that take less than comes for them, how many frames they lost, once a second at most; and of what
    was not recorded or published, and why.
    """

    def __init__(self, bridge: Bridge) -> None:
        self._bridge = bridge
        self._before: dict[tuple[str, str | None], int] = {}
        self._told: dict[str, tuple[Loss, float]] = {}
        self._due = time.monotonic() + INTERVAL

    def __call__(self, at_end: bool = False) -> None:
        now = time.monotonic()
        if now < self._due and not at_end:
            return
        self._due = now + INTERVAL
        stats = self._bridge.stats()
        before, self._before = self._before, {}
        for one in stats["links"]:
            who = (one["name"], one["peer"])
            self._before[who] = one["dropped"]
            lost = one["dropped"] - before.get(who, 0)
            # A link that is down loses everything, and has nothing that waits.
            if lost and one["queued_bytes"]:
                _say(f"{full_name(one)}: {lost} frames dropped, it takes less than comes for it")
        for loss in losses(stats):
            told, when = self._told.get(loss.name, (None, -AGAIN))
            is_news = loss.error not in (None, told and told.error)
            grew = loss.lost > (told.lost if told else 0)
            if is_news or (grew and (at_end or now >= when + AGAIN)):
                self._told[loss.name] = (loss, now)
                _say(loss.line)


def _say(text: str) -> None:
    tell(f"mavwire bridge: warning: {text}")
