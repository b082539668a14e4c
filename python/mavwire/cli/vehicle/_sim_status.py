"""The line at the bottom of `mavwire sim`: what the vehicles are doing, only for a person."""

from __future__ import annotations

import shutil
import sys
import time
from typing import TYPE_CHECKING

from mavwire._text import drawn_on, is_terminal

if TYPE_CHECKING:
    from mavwire.sim import Runner, Vehicle

INTERVAL = 0.5
# Without a terminal nobody watches, and the loop need not come back so often.
QUIET_INTERVAL = 3600.0


class StatusLine:
    """Draws one line on stderr and keeps it up to date."""

    def __init__(self, runner: Runner, enabled: bool = True) -> None:
        self.enabled = enabled and is_terminal(sys.stderr)
        self.interval = INTERVAL if self.enabled else QUIET_INTERVAL
        self._runner = runner
        self._began = self._last = time.monotonic()
        self._sent = self._received = 0

    def draw(self) -> None:
        """Draw it anew."""
        if not self.enabled:
            return
        width = shutil.get_terminal_size().columns
        terminal = drawn_on(sys.stderr)
        terminal.write("\r\x1b[K" + self.text()[: max(width - 1, 10)])
        terminal.flush()

    def text(self) -> str:
        """Time, frames a second in both directions, and each vehicle."""
        now, runner = time.monotonic(), self._runner
        span = max(now - self._last, 1e-3)
        sent, received = runner.sent, runner.received
        out, back = (sent - self._sent) / span, (received - self._received) / span
        self._last, self._sent, self._received = now, sent, received
        minutes, seconds = divmod(int(now - self._began), 60)
        vehicles = "  ".join(map(describe, runner.vehicles))
        return f"{minutes:02}:{seconds:02}  out {out:.0f}/s in {back:.0f}/s  {vehicles}"

    def finish(self) -> None:
        """Leave the line as it is and go to the next."""
        if self.enabled:
            sys.stderr.write("\n")
            sys.stderr.flush()
            self.enabled = False


def describe(vehicle: Vehicle) -> str:
    """A vehicle in a few words."""
    state = "armed" if vehicle.armed else "ready" if vehicle.autopilot.position_ok else "starting"
    if not vehicle.landed:
        state = f"{vehicle.height:.1f} m {vehicle.copter.groundspeed:.1f} m/s"
    return f"[{vehicle.sysid}] {vehicle.mode} {state} {vehicle.battery.remaining}%"
