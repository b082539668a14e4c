"""`DFReader`: what readers of binary and text logs have in common.

Messages are found, filtered and made by the native base class. Here is what changes rarely: the
vehicle's state, and which clock the log has.
"""

from __future__ import annotations

import os
from contextlib import suppress
from math import isnan

from mavwire import _native
from mavwire._hooks import quick_methods
from mavwire.links.conditions import evaluate_condition
from mavwire.links.modes import mode_mapping_bynumber, mode_string_acm, mode_string_px4

from .clocks import (
    GPS_TYPES,
    DFReaderClock,
    DFReaderClock_gps_interpolated,
    DFReaderClock_msec,
    DFReaderClock_px4,
    DFReaderClock_usec,
)
from .formats import DFFormat
from .metadata import DFMetaData

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType
    from typing import Any, ClassVar, Self

MAV_TYPE_FIXED_WING = 1
# A text in the firmware's greeting -> MAV_TYPE. The first that fits.
_VEHICLE_TEXTS = (
    ("Copter", 2), ("Plane", 1), ("Rover", 10), ("Tracker", 5), ("Sub", 12), ("Blimp", 7),
)  # fmt: skip
# Build types of VER messages -> MAV_TYPE.
_VEHICLE_BUILDS = {1: 10, 2: 2, 3: 1, 4: 5, 7: 12, 12: 7, 13: 4}
# Types that tell the time, and PARM, which is to be known early.
_TIME_TYPES = (*GPS_TYPES, "TIME", "PARM")
# Errors of arithmetic with the value of a column: a log may describe a time as a text or a list, and a
# line of a text log may hold anything.
_NO_NUMBER = (ValueError, TypeError, OverflowError)


# The clock that native code implements too. The native one is not used if a program replaced a method.
_NATIVE_CLOCK = DFReaderClock_usec
_NATIVE_CLOCK_METHODS = {
    name: getattr(DFReaderClock_usec, name)
    for name in (
        "message_arrived", "set_message_timestamp", "should_use_msec_field0",
        "type_has_good_TimeMS",
    )
}  # fmt: skip


def _is_native(clock: Any) -> bool:
    methods = _NATIVE_CLOCK_METHODS.items()
    return type(clock) is _NATIVE_CLOCK and all(
        getattr(_NATIVE_CLOCK, name) is method for name, method in methods
    )


class DFReader(_native.DataflashReader):
    """A dataflash log: its messages, and the state of the vehicle as far as it was read."""

    filehandle: Any
    formats: dict[Any, DFFormat]
    # Methods that native code skips. If a program replaces one of them, logs are read through them.
    _quick_methods: list[tuple[type | None, str, Any]]
    _clock: Any

    def __init__(self) -> None:
        self.clock = None
        self.timestamp = 0
        self.mav_type = MAV_TYPE_FIXED_WING
        self.verbose = False
        self.params: dict[str, float] = {}
        self.param_defaults: dict[str, float] = {}
        self._flightmodes: list[tuple[str, float, float]] | None = None
        self.flightmode = "UNKNOWN"
        self.unit_lookup: dict[str, str] = {}
        self.mult_lookup: dict[str, float] = {}
        self.metadata = DFMetaData(self)
        self._zero_time_base = False
        self._data_map: Any = None
        self._layouts: list[DFFormat] = []
        self._last_offset: int | None = None
        self._told_clock: tuple[str, int | None, float] = ("rates", None, 0.0)
        self.messages = {"MAV": self, "__MAV__": self}

    # -- opening

    def _open_log(self, filename: str, text: bool) -> None:
        """Open the file and find the record types. ValueError for an empty one."""
        self.filehandle = open(filename, "rb")
        if not os.path.getsize(filename):
            self.filehandle.close()
            raise ValueError("cannot mmap an empty file")
        layouts = self._open(os.fsdecode(filename), text)
        self._layouts = [
            DFFormat(type_id, name, length, format, ",".join(columns))
            for type_id, length, name, format, columns in layouts
        ]

    def _init_contents(self, progress_callback: Callable[[int], Any] | None) -> dict[str, Any]:
        """Go through the log; fill units, and `messages` with the first of each type."""
        contents = self._contents(progress_callback)
        self.unit_lookup = dict(contents["labels"])
        self.mult_lookup = dict(contents["multipliers"])
        self.name_to_id = {fmt.name: fmt.type for fmt in self._layouts}
        self.id_to_name = {fmt.type: fmt.name for fmt in self._layouts}
        for fmt in self._layouts:
            if fmt.type in contents["fields"]:
                unit_ids, mult_ids = contents["fields"][fmt.type]
                fmt.set_unit_ids(unit_ids, self.unit_lookup)
                fmt.set_mult_ids(mult_ids, self.mult_lookup)
        self._set_kinds([(fmt, self._instance_index(fmt)) for fmt in self._layouts])
        self._last_offset = contents["last"]
        self._told_clock = contents["clock"]
        self.junk_bytes: int = contents["junk"]
        self._rewind()
        self._read_first(contents)
        self._rewind(keep_messages=True)
        return contents

    @staticmethod
    def _instance_index(fmt: DFFormat) -> int | None:
        if fmt.instance_field is None:
            return None
        index = fmt.colhash[fmt.instance_field]
        # The last of two columns of one name may be more than the format has.
        return index if index < len(fmt.msg_fmts) else None

    def _read_first(self, contents: dict[str, Any]) -> None:
        """Read the first message of each type, in the order of the types, and of each instance."""
        first = contents["first"]
        order = sorted(range(len(first)), key=lambda n: (self._layouts[n].type, n))
        of_type: dict[str, Any] = {}
        for index in order:
            if first[index] is not None:
                self.offset = first[index]
                if (msg := self.recv_msg()) is not None:
                    of_type[msg.get_type()] = msg
        for offset in contents["instances"]:
            self.offset = offset
            self.recv_msg()
        self.messages.update(of_type)

    @property
    def data_map(self) -> Any:
        """The file mapped into memory. Reading does not use it."""
        if self._data_map is None and not self.filehandle.closed:
            import mmap

            self._data_map = mmap.mmap(self.filehandle.fileno(), 0, access=mmap.ACCESS_READ)
        return self._data_map

    def close(self) -> None:
        """Close the file."""
        self._close()
        # Made now, so that it can be seen closed afterwards. A log that became empty has no map.
        with suppress(OSError, ValueError):
            self.data_map  # noqa: B018
        self.filehandle.close()
        if self._data_map is not None:
            self._data_map.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        exc_type: type[BaseException] | None,
        exc_value: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.close()

    # -- time

    @property
    def clock(self) -> Any:
        """The clock that gives messages their times."""
        return self._clock

    @clock.setter
    def clock(self, clock: Any) -> None:
        self._clock = clock
        self._set_native_clock(clock if _is_native(clock) else None)

    def _set_time(self, m: Any) -> None:
        """Give a message its time."""
        if self._clock is None:
            m._timestamp = 0
            return
        with suppress(*_NO_NUMBER):
            self._clock.message_arrived(m)
        self._stamp(m)

    def _stamp(self, m: Any) -> None:
        """Let the clock set a message's time; what is no number counts as none."""
        try:
            self._clock.set_message_timestamp(m)
        except _NO_NUMBER:
            m._timestamp = self._clock.timestamp

    def init_clock(self) -> None:
        """Find out which clock the log has, and its time base."""
        unit, told_at, first = self._told_clock
        self._rewind(keep_messages=True)
        if unit == "usec":
            self.init_clock_usec()
        elif unit == "msec":
            self.init_clock_msec()
        elif unit == "rates":
            self.init_clock_gps_interpolated(DFReaderClock_gps_interpolated())
        m = self._read_to(told_at, None if unit == "rates" else _TIME_TYPES)
        with suppress(
            AttributeError, LookupError, *_NO_NUMBER
        ):  # of messages that a program replaced
            if unit == "px4":
                newest = filter(None, map(self.messages.get, GPS_TYPES))
                gps = [one for one in newest if "GPSTime" in one.get_fieldnames()]
                self.init_clock_px4(self.messages["TIME"], m if m in gps else gps[0])
            elif told_at is not None and unit != "rates" and not self._zero_time_base:
                self.clock.find_time_base(m, int(first) if first.is_integer() else first)
        if self.clock is None:
            self.init_clock_gps_interpolated(DFReaderClock_gps_interpolated())
        self._rewind(keep_messages=True)
        for name, m in list(self.messages.items()):
            if name not in ("MAV", "__MAV__"):
                self._stamp(m)
        self.clock.rewind_event()

    def _read_to(self, offset: int | None, types: Any) -> Any:
        """Read messages up to the one at an offset, which is the result, or all messages of all types.

        pymavlink keeps the parameters of these messages.
        """
        m = None
        while offset is None or self.offset <= offset:
            m = self.recv_match(type=None if offset is None else types, strict=True)
            if m is None:
                break
        return m

    def init_clock_usec(self) -> None:
        """Take the clock of logs with TimeUS."""
        self.clock = DFReaderClock_usec()

    def init_clock_msec(self) -> None:
        """Take the clock of logs with TimeMS."""
        self.clock = DFReaderClock_msec()

    def init_clock_px4(self, px4_msg_time: Any, px4_msg_gps: Any) -> bool:
        """Take the clock of PX4's logs, with a TIME and a GPS message."""
        clock = DFReaderClock_px4()
        self.clock = clock
        if not self._zero_time_base:
            clock.set_px4_timebase(px4_msg_time)
            clock.find_time_base(px4_msg_gps)
        return True

    def init_clock_gps_interpolated(self, clock: DFReaderClock) -> None:
        """Use the clock for logs in which only GPS messages have a time."""
        self.clock = clock

    # -- state

    def _track(self, m: Any) -> None:
        """Take a message of a type that tells the state of the vehicle into it; one that has a word
        in the place of a number tells nothing.
        """
        take = self._TAKERS.get(m.get_type())
        if take is None:
            return
        try:
            take(self, m)
        except _NO_NUMBER:  # a mode may be infinite
            pass

    def _add_msg(self, m: Any) -> None:
        """Set the time of a message, and update `messages` and the state."""
        self._set_time(m)
        if isinstance(m, _native.DFMessage):
            self._keep(m)
        else:
            self.messages[m.get_type()] = m
        self._track(m)

    def _recv_match_slowly(self, condition: str | None, types: Any, strict: bool) -> Any:
        """`recv_match` for a program that replaced a method which pymavlink's `recv_match` calls."""
        if isinstance(types, str):
            types = {types}
        while True:
            if types is not None:
                self.skip_to_type(types, strict)
            m = self.recv_msg()
            if m is None or (
                (types is None or m.get_type() in types) and self.check_condition(condition)
            ):
                return m

    # A column that a log's type has not is None.

    def _track_parameter(self, m: Any) -> None:
        name, value = getattr(m, "Name", None), getattr(m, "Value", None)
        if name is None or value is None:
            return
        self.params[name] = value
        default = getattr(m, "Default", None)
        if default is not None and not isnan(default):  # NaN says that there is none
            self.param_defaults[name] = default

    def _track_mode(self, m: Any) -> None:
        mode, number = getattr(m, "Mode", None), getattr(m, "ModeNum", None)
        if isinstance(mode, str):
            self.flightmode = mode.upper()
        elif number is not None:
            modes = mode_mapping_bynumber(self.mav_type) or {}
            self.flightmode = modes.get(number, "UNKNOWN")
        elif mode is not None:
            self.flightmode = mode_string_acm(mode)

    def _track_px4_mode(self, m: Any) -> None:
        state = getattr(m, "MainState", None)
        if state is not None:
            self.flightmode = mode_string_px4(state)

    def _track_text(self, m: Any) -> None:
        text = getattr(m, "Message", "")
        for word, mav_type in _VEHICLE_TEXTS:
            if word in text:
                self.mav_type = mav_type
                return

    def _track_build(self, m: Any) -> None:
        self.mav_type = _VEHICLE_BUILDS.get(getattr(m, "BU", -1), self.mav_type)

    _TAKERS: ClassVar[dict[str, Callable[[Any, Any], None]]] = {
        "PARM": _track_parameter,
        "MODE": _track_mode,
        "STAT": _track_px4_mode,
        "MSG": _track_text,
        "VER": _track_build,
    }

    def param(self, name: str, default: Any = None) -> Any:
        """The newest value of a parameter."""
        return self.params.get(name, default)

    def check_condition(self, condition: str | None) -> Any:
        """Whether a condition holds for the newest messages."""
        return evaluate_condition(condition, self.messages)

    def flightmode_list(self) -> list[tuple[str, float, float]]:
        """(mode, start, end) of each stretch in one mode; rewinds the log."""
        self.rewind()
        if self._flightmodes is None:
            self._flightmodes = self._read_flightmodes()
            self.rewind()
        return self._flightmodes

    def _read_flightmodes(self) -> list[tuple[str, float, float]]:
        starts: list[tuple[str, float]] = []
        while (m := self.recv_match(type={"MODE", "PARM"})) is not None:
            if not starts or starts[-1][0] != self.flightmode:
                starts.append((self.flightmode, m._timestamp))
        if not starts:
            return []
        ends = [*(start for _, start in starts[1:]), self.last_timestamp()]
        return [(mode, start, end) for (mode, start), end in zip(starts, ends, strict=True)]

    # -- place

    def last_timestamp(self) -> float:
        """The time of the last message, to which this moves."""
        if self._last_offset is None:
            return 0.0
        self.offset = self._last_offset
        m = self.recv_msg()
        return 0.0 if m is None else m._timestamp

    @property
    def percent(self) -> float:
        """How much of the log was read."""
        return self.offset / self.data_len * 100.0 if self.offset else 0

    @property
    def remaining(self) -> int:
        """Bytes of the log that were not read."""
        return self.data_len - self.offset

    def rewind(self) -> None:
        """Read from the start again, of any types; `messages` is emptied."""
        self._rewind()

    def _rewind(self, keep_messages: bool = False) -> None:
        self._restart()
        if not keep_messages:
            self.messages = {"MAV": self, "__MAV__": self}
        if self._flightmodes:
            self.flightmode = self._flightmodes[0][0]
        else:
            self.flightmode = "UNKNOWN"
        if self._clock is not None:
            self._clock.rewind_event()


DFReader._quick_methods = quick_methods(DFReader)
