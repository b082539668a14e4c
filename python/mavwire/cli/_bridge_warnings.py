"""What `mavwire bridge` says of its own accord while it runs."""

from __future__ import annotations

import sys
import time

TYPE_CHECKING = False
if TYPE_CHECKING:
    from mavwire.bridge import Bridge

# Seconds between two looks.
INTERVAL = 1.0


class DropWarnings:
    """Tells of links that take less than comes for them: how many frames they lost, once a second at most."""

    def __init__(self, bridge: Bridge) -> None:
        self._bridge = bridge
        self._before: dict[tuple[str, str | None], int] = {}
        self._due = time.monotonic() + INTERVAL

    def __call__(self) -> None:
        now = time.monotonic()
        if now < self._due:
            return
        self._due = now + INTERVAL
        before, self._before = self._before, {}
        for one in self._bridge.stats()["links"]:
            who = (one["name"], one["peer"])
            self._before[who] = one["dropped"]
            lost = one["dropped"] - before.get(who, 0)
            # A link that is down loses everything, and has nothing that waits.
            if lost and one["queued_bytes"]:
                name = " ".join(filter(None, who))
                print(
                    f"mavwire bridge: warning: {name}: {lost} frames dropped, it takes less than comes for it",
                    file=sys.stderr, flush=True,
                )  # fmt: skip
