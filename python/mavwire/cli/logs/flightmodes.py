"""When the flight mode changed, and the time spent in each mode (mavflightmodes.py)."""

from __future__ import annotations

import time
from argparse import ArgumentParser, Namespace

from mavwire.cli._reading import Reading, read_each
from mavwire.cli._shared_arguments import add_shared

TYPES = ("SYS_STATUS", "HEARTBEAT", "MODE")
UNKNOWN = "UNKNOWN"


def add_arguments(parser: ArgumentParser) -> None:
    add_shared(parser, "logs")


def main(args: Namespace) -> int:
    read_each("flightmodes", args, _print_modes)
    return 0


def _print_modes(log: Reading) -> None:
    """A line for each message whose sender is in another mode than the vehicle was at the last."""
    modes = Modes()
    link = log.link
    systems = getattr(link, "sysid_state", None)
    shown = UNKNOWN
    # Of what the log knows nothing is asked but modes, which the heartbeats among these tell.
    for msg in log.messages(TYPES):
        sender = link if systems is None else systems[msg.get_srcSystem()]
        if sender.flightmode == shown:
            continue
        target = link if systems is None else systems[link.sysid]
        shown, stamp, percent = target.flightmode, msg._timestamp, link.percent
        where = f"(MAV.timestamp={int(stamp)} {int(percent)}%)"
        print(f"{time.ctime(stamp)} MAV.flightmode={shown:<12} {where}")
        modes.add(shown, stamp, percent)
    modes.finish()
    print("\nTime per mode:")
    print("\n".join(modes.table()))


class Modes:
    """Seconds in each mode.

    The last mode has no end. Its duration is estimated from the rest of the file and the speed at
    which the file grew before the first change.
    """

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self._mode: str | None = None
        self._began = 0.0
        self._percent = 0.0
        self._seconds_per_percent: float | None = None

    def add(self, mode: str, stamp: float, percent: float) -> None:
        """The vehicle is in `mode` at time `stamp`, `percent` of the file being read."""
        if self._mode is None:
            self._mode, self._began = mode, stamp
        elif mode != self._mode:
            lasted = stamp - self._began
            self._count(lasted)
            if self._seconds_per_percent is None and percent > self._percent:
                self._seconds_per_percent = lasted / (percent - self._percent)
            self._mode, self._began = mode, stamp
        self._percent = percent

    def finish(self) -> None:
        """The log has ended."""
        if self._mode is not None:
            self._count((100.0 - self._percent) * (self._seconds_per_percent or 0.0))

    def _count(self, seconds: float) -> None:
        assert self._mode is not None
        self.seconds[self._mode] = self.seconds.get(self._mode, 0.0) + seconds

    def table(self) -> list[str]:
        """The lines that are printed."""
        if len(self.seconds) < 2:
            return [f"{self._mode or ''}  100% of flight time"]
        total = sum(self.seconds.values())
        return [
            f"{mode:<12} {_duration(int(seconds))} {_share(seconds, total):.2f}%"
            for mode, seconds in self.seconds.items()
        ]


def _duration(seconds: int) -> str:
    """As a `timedelta` is shown, but of any length."""
    days, seconds = divmod(seconds, 86_400)
    clock = f"{seconds // 3600}:{seconds // 60 % 60:02}:{seconds % 60:02}"
    return f"{days} day{'' if abs(days) == 1 else 's'}, {clock}" if days else clock


def _share(part: float, total: float) -> float:
    return part * 100.0 / total if total else 0.0
