"""Indexed telemetry logs: `mavmmaplog`, what `mavlink_connection` gives for a log file.

Opening scans the record headers once, so that reading a few message types seeks from one to the
next. As in pymavlink the first record of each type is read for real on the way, so `messages`,
`params` and the counters are filled before the first `recv_match`.
"""

from __future__ import annotations

from mavwire._hooks import quick_methods

from .mavfile import mavfile
from .tlog import mavlogfile
from .vehicle_state import add_message

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any, Literal

# Beyond this many keys in `messages` the index adds no further instances.
MAX_INDEXED_KEYS = 8192


class mavmmaplog(mavlogfile):
    """An indexed log. `progress_callback` gets each new whole percent of the scan.

    With `resync="rescan"` the index holds the good records and all of them.
    """

    _own_attributes = (
        *mavlogfile._own_attributes,
        "data_map", "offset", "type_nums", "offsets", "instance_offsets", "instance_lengths",
    )  # fmt: skip

    def __init__(
        self,
        filename: str,
        progress_callback: Callable[[int], Any] | None = None,
        *,
        resync: Literal["skip", "rescan"] | None = None,
    ) -> None:
        super().__init__(filename)
        if resync is not None:
            self.mav.resync = resync
        self.data_len = self.filesize
        self._data_map: Any = None
        self.init_arrays(progress_callback)
        self._flightmodes: list[tuple[str, float, float]] | None = None

    def close(self) -> None:
        """Close the file and its map."""
        super().close()
        if self._data_map is not None:
            self._data_map.close()

    @property
    def data_map(self) -> Any:
        """The file mapped into memory, None if it is empty. Reading does not use it."""
        if self._data_map is None and self.data_len:
            import mmap

            if self.f.closed:  # nobody asked for it before: it looks as it would if somebody had
                self._data_map = mmap.mmap(-1, 1)
                self._data_map.close()
            else:
                self._data_map = mmap.mmap(self.f.fileno(), 0, access=mmap.ACCESS_READ)
        return self._data_map

    # -- the index

    def init_arrays(self, progress_callback: Callable[[int], Any] | None = None) -> None:
        """Build the index: `offsets` and `counts` by message id, and the names of the ids."""
        self._build_index(progress_callback)
        rows = self._index_counts()
        self.counts = {msgid: count for msgid, _, count in rows}
        self.name_to_id = {name: msgid for msgid, name, _ in rows}
        self.id_to_name = {msgid: name for msgid, name, _ in rows}
        self._count = sum(count for _, _, count in rows)
        self._rewind()

    @property
    def offsets(self) -> dict[int, list[int]]:
        """Message id -> offsets of its records."""
        return dict(self._index_offsets())

    @property
    def instance_offsets(self) -> dict[int, int]:
        """Message id -> payload offset of the instance field, for messages that have one."""
        return {msgid: cls.instance_offset for msgid, cls in self._instance_classes()}

    @property
    def instance_lengths(self) -> dict[int, int]:
        """Message id -> bytes of the instance field if it is text, else 1."""
        return {
            msgid: cls.array_lengths[cls.ordered_fieldnames.index(cls.instance_field)] or 1
            for msgid, cls in self._instance_classes()
        }

    @property
    def type_nums(self) -> list[int] | None:
        """Message ids that a filtered read visits, None before the first after a rewind."""
        return self._wanted_ids()

    def _instance_classes(self) -> list[tuple[int, Any]]:
        classes = (
            (msgid, self.mav._dialect.message_class(name))
            for name, msgid in self.name_to_id.items()
        )
        return [(msgid, cls) for msgid, cls in classes if cls.instance_field is not None]

    def _index_first(self, name: str, msg: Any) -> None:
        """Right after opening, `messages` shows one message of each type, of any sender."""
        if msg.get_type() == name:
            add_message(self.messages, name, msg)

    def _index_instance(self, name: str, instance: str) -> None:
        """Make `messages["TYPE[instance]"]` exist, with the first message until one is read."""
        messages = self.messages
        if name in messages and len(messages) < MAX_INDEXED_KEYS:
            messages[f"{name}[{instance}]"] = messages[name]

    # -- reading

    @property
    def offset(self) -> int:
        """Where the record begins that a filtered read visited last."""
        return self._visited_offset()

    def rewind(self) -> None:
        """Read from the start again, of any types; messages, params and counters stay."""
        self._rewind()

    def _rewind(self) -> None:
        """Scripts for pymavlink call this name and override it in subclasses."""
        self._restart()
        self.flightmode = "UNKNOWN"

    def flightmode_list(self) -> list[tuple[str, float, float]]:
        """(mode, start, end) of each stretch between heartbeats in one mode; rewinds the log."""
        self.rewind()
        if self._flightmodes is None:
            self._flightmodes = self._read_flightmodes()
            self.rewind()
        return self._flightmodes

    def _read_flightmodes(self) -> list[tuple[str, float, float]]:
        starts: list[tuple[str, float]] = []
        last = 0.0
        while True:
            msg = self.recv_match(type="HEARTBEAT")
            if msg is None:
                break
            last = msg._timestamp
            if not starts or starts[-1][0] != self.flightmode:
                starts.append((self.flightmode, last))
        ends = [*(start for _, start in starts[1:]), last]
        return [(mode, start, end) for (mode, start), end in zip(starts, ends, strict=False)]


mavmmaplog._quick_methods = quick_methods(mavmmaplog, mavfile)
