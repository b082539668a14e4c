"""Time bases of dataflash logs: what turns the times in a log into Unix times.

A log counts from the autopilot's start; a GPS message that carries week and milliseconds tells when
that was. Other clocks come from autopilots of many years ago.
"""

from __future__ import annotations

from contextlib import suppress
from math import isfinite

from mavwire import _native

TYPE_CHECKING = False
if TYPE_CHECKING:
    from mavwire._native import DFMessage

# Messages a second of a type whose rate is not known.
DEFAULT_RATE = 50.0
GPS_TYPES = ("GPS", "GPS2")


class DFReaderClock:
    """Base of the clocks: `timebase` is the Unix time of the log's zero."""

    timebase: float
    timestamp: float

    def __init__(self) -> None:
        self.set_timebase(0)
        self.timestamp = 0

    def _gpsTimeToTime(self, week: float, msec: float) -> float:
        """Unix time of a GPS week and the milliseconds in it."""
        return _native.gps_time(week, msec)

    def set_timebase(self, base: float) -> None:
        """Set the Unix time of the log's zero."""
        self.timebase = base

    def message_arrived(self, m: DFMessage) -> None:
        """See a message before it gets its time."""

    def rewind_event(self) -> None:
        """The log is read from its start again."""


class DFReaderClock_usec(_native.MicrosClock, DFReaderClock):
    """Messages have TimeUS, and GPS ones GWk and GMS too."""

    def __init__(self) -> None:
        DFReaderClock.__init__(self)
        self.first_us_stamp: float | None = None

    def find_time_base(self, gps: DFMessage, first_us_stamp: float | None) -> None:
        """Reckon the time base from a GPS message."""
        seconds = self._gpsTimeToTime(gps.GWk, gps.GMS)
        self.set_timebase(seconds - gps.TimeUS * 0.000001)
        self.first_us_stamp = first_us_stamp

    def type_has_good_TimeMS(self, type: str) -> bool:
        """Whether TimeMS is when a message was logged; in batches of samples it is not."""
        return not type.startswith(("ACC", "GYR"))

    def should_use_msec_field0(self, m: DFMessage) -> bool:
        """Whether the first column is the time, in milliseconds."""
        if not self.type_has_good_TimeMS(m.get_type()):
            return False
        names = m.get_fieldnames()
        return bool(names) and names[0] == "TimeMS"

    def set_message_timestamp(self, m: DFMessage) -> None:
        """Set `_timestamp`; a message without a time has that of the one before."""
        if m.get_fieldnames()[:1] == ["TimeUS"]:
            m._timestamp = self.timebase + m.TimeUS * 1.0e-6
        elif self.should_use_msec_field0(m):
            m._timestamp = max(self.timebase + m.TimeMS * 1.0e-3, self.timestamp)
        else:
            m._timestamp = self.timestamp
        self.timestamp = m._timestamp

    def rewind_event(self) -> None:
        """The newest time is that of the log's first message again."""
        self.timestamp = self.timebase
        if self.first_us_stamp is not None:
            self.timestamp += self.first_us_stamp * 1.0e-6


class DFReaderClock_msec(DFReaderClock):
    """Messages have TimeMS; GPS ones have the time of the week in it, and their own in T."""

    def __init__(self) -> None:
        super().__init__()
        self.first_ms_stamp: float | None = None

    def find_time_base(self, gps: DFMessage, first_ms_stamp: float | None) -> None:
        """Reckon the time base from a GPS message."""
        self.set_timebase(self._gpsTimeToTime(gps.Week, gps.TimeMS) - gps.T * 0.001)
        self.first_ms_stamp = first_ms_stamp

    def set_message_timestamp(self, m: DFMessage) -> None:
        """Set `_timestamp`; a message without a time has that of the one before."""
        names = m.get_fieldnames()
        if names[:1] == ["TimeMS"]:
            m._timestamp = self.timebase + m.TimeMS * 0.001
        elif m.get_type() in GPS_TYPES and "T" in names:
            m._timestamp = self.timebase + m.T * 0.001
        else:
            m._timestamp = self.timestamp
        self.timestamp = m._timestamp

    def rewind_event(self) -> None:
        """The newest time is that of the log's first message again."""
        self.timestamp = self.timebase
        if self.first_ms_stamp is not None:
            self.timestamp += self.first_ms_stamp * 0.001


class DFReaderClock_px4(DFReaderClock):
    """TIME messages tell the time of those that follow, in microseconds."""

    def __init__(self) -> None:
        super().__init__()
        self.px4_timebase: float = 0

    def find_time_base(self, gps: DFMessage) -> None:
        """Reckon the time base from a GPS message."""
        self.set_timebase(gps.GPSTime * 1.0e-6 - self.px4_timebase)

    def set_px4_timebase(self, time_msg: DFMessage) -> None:
        """Take the time of a TIME message."""
        self.px4_timebase = time_msg.StartTime * 1.0e-6

    def set_message_timestamp(self, m: DFMessage) -> None:
        """Set `_timestamp` to the time of the TIME message before."""
        m._timestamp = self.timebase + self.px4_timebase

    def message_arrived(self, m: DFMessage) -> None:
        """Notice the TIME messages."""
        if m.get_type() == "TIME" and "StartTime" in m.get_fieldnames():
            self.set_px4_timebase(m)


class DFReaderClock_gps_interpolated(DFReaderClock):
    """Only GPS messages have a time; others get one by how many of their type there were since."""

    def __init__(self) -> None:
        super().__init__()
        self.msg_rate: dict[str, float] = {}
        self.counts: dict[str, int] = {}
        self.counts_since_gps: dict[str, int] = {}

    def rewind_event(self) -> None:
        """Forget the counts, keep the rates."""
        self.counts = {}
        self.counts_since_gps = {}

    def message_arrived(self, m: DFMessage) -> None:
        """Count a message; a GPS one moves the time base."""
        kind = m.get_type()
        self.counts[kind] = self.counts.get(kind, 0) + 1
        self.counts_since_gps[kind] = self.counts_since_gps.get(kind, 0) + 1
        if kind in GPS_TYPES:
            self.gps_message_arrived(m)

    def gps_message_arrived(self, m: DFMessage) -> None:
        """Move the time base to a later GPS time, and learn the rates of the types on the way."""
        time = self._time_of(m)
        if time is None or time <= self.timebase:
            return
        seconds = time - self.timebase
        for kind, count in self.counts_since_gps.items():
            rate = max(self.msg_rate.get(kind, 0.0), count / seconds)
            self.msg_rate[kind] = DEFAULT_RATE if kind == "IMU" else rate
        self.timebase = time
        self.counts_since_gps = {}

    def _time_of(self, m: DFMessage) -> float | None:
        """Unix time of a GPS message. None if the message has no valid time."""
        names = m.get_fieldnames()
        for week, msec in (("Week", "TimeMS"), ("GWk", "GMS")):
            if week in names and msec in names:
                with suppress(TypeError, ValueError, OverflowError):  # of values in a text log
                    weeks = getattr(m, week)
                    time = self._gpsTimeToTime(weeks, getattr(m, msec))
                    return time if weeks and isfinite(time) else None
        return None

    def set_message_timestamp(self, m: DFMessage) -> None:
        """Set `_timestamp` by the type's rate and its count since the GPS message."""
        rate = self.msg_rate.get(m.get_type(), DEFAULT_RATE)
        if int(rate) == 0:
            rate = DEFAULT_RATE
        m._timestamp = self.timebase + self.counts_since_gps.get(m.get_type(), 0) / rate
