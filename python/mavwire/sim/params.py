"""The parameter protocol: list, read, set, and the two ways of putting an integer into a float.

ArduPilot casts: the float 3.0 means 3. PX4 copies bytes: the float carries the integer's bits.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from mavwire.dialects.v20 import all as mavlink
from mavwire.links.param_bytes import decoded, encoded, with_value_bytes

from .personality.base import Param
from .service import Handler, Service

if TYPE_CHECKING:
    from .vehicle import Vehicle

# A list is sent slowly, so that it leaves room for telemetry: every second tick of 10 ms.
LIST_TICKS = 2
UNLISTED = 65535
HASH = "_HASH_CHECK"
_RANGES = {
    mavlink.MAV_PARAM_TYPE_INT8: (-(2**7), 2**7 - 1),
    mavlink.MAV_PARAM_TYPE_INT16: (-(2**15), 2**15 - 1),
    mavlink.MAV_PARAM_TYPE_INT32: (-(2**31), 2**31 - 1),
}


FLOAT_MAX: float = struct.unpack("<f", b"\xff\xff\x7f\x7f")[0]


def as_float32(value: float) -> float:
    """A value as a float32 keeps it."""
    return float(struct.unpack("<f", struct.pack("<f", value))[0])


class Parameters(Service, Mapping[str, float]):
    """The parameters of a vehicle, by name; `params["NAME"] = value` sets one and says so."""

    def __init__(self, vehicle: Vehicle, values: Mapping[str, float]) -> None:
        super().__init__(vehicle)
        self._table: list[Param] = vehicle.personality.params
        self._index = {param.name: index for index, param in enumerate(self._table)}
        self._values = {param.name: as_float32(param.default) for param in self._table}
        self._bytewise = vehicle.personality.bytewise_params
        self._listing: int | None = None
        self._values[vehicle.personality.sysid_param] = float(vehicle.sysid)
        self._values.update((name, self._fitting(name, value)) for name, value in values.items())

    # -- as a mapping

    def __getitem__(self, name: str) -> float:
        return self._values[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._index)

    def __len__(self) -> int:
        return len(self._table)

    def __setitem__(self, name: str, value: float) -> None:
        """Set one; KeyError without one of that name, ValueError for what its type cannot hold."""
        self._values[name] = self._fitting(name, value)
        self.vehicle.params_changed(name)
        self._send(name)

    def _fitting(self, name: str, value: float) -> float:
        """A value as the parameter's type holds it."""
        if name not in self._index:
            raise KeyError(f"no parameter {name}")
        if not abs(value) <= FLOAT_MAX:
            raise ValueError(f"{name} must be a finite number of 32 bits: {value}")
        kind = self.kind(name)
        if kind == mavlink.MAV_PARAM_TYPE_REAL32:
            return as_float32(value)
        low, high = _RANGES[kind]
        return float(max(low, min(high, round(value))))

    def kind(self, name: str) -> int:
        """MAV_PARAM_TYPE of one."""
        return self._table[self._index[name]].type

    def default(self, name: str) -> float:
        """The value it was delivered with."""
        return as_float32(self._table[self._index[name]].default)

    def reset(self) -> None:
        """All values as delivered."""
        own = self.vehicle.personality.sysid_param
        self._values.update((p.name, as_float32(p.default)) for p in self._table if p.name != own)
        self.vehicle.params_changed(own)

    # -- the protocol

    def handlers(self) -> Mapping[str, Handler]:
        return {
            "PARAM_REQUEST_LIST": self._on_list,
            "PARAM_REQUEST_READ": self._on_read,
            "PARAM_SET": self._on_set,
        }

    def step(self) -> None:
        """Send what is left of a list, one at a time."""
        if self._listing is None or self.vehicle.ticks % LIST_TICKS:
            return
        if self._listing < len(self._table):
            self._send(self._table[self._listing].name, listed=True)
            self._listing += 1
        else:
            self._listing = None

    def _on_list(self, _msg: Any) -> None:
        self._listing = 0
        self.vehicle.introduce()
        if self._bytewise:
            self._send_hash()

    def _on_read(self, msg: Any) -> None:
        name = msg.param_id
        if msg.param_index >= 0:
            name = self._table[msg.param_index].name if msg.param_index < len(self) else ""
        if self._bytewise and name == HASH:
            self._send_hash()
        elif name in self._index:
            self._send(name, listed=True)
        else:
            self.vehicle.say("param_unknown", name=name or f"#{msg.param_index}")

    def _on_set(self, msg: Any) -> None:
        name = msg.param_id
        if self._bytewise and name == HASH:
            self._listing = None  # the ground station has them all, in its cache
            return
        if name not in self._index:
            self.vehicle.say("param_unknown", name=name)
            return
        kind = self.kind(name)
        if self._bytewise and msg.param_type != kind:
            self.vehicle.say("param_type", name=name)
            self._send(name, listed=True)
            return
        try:
            self[name] = float(decoded(msg, True) if self._bytewise else msg.param_value)
        except ValueError:
            self._send(name, listed=True)

    def _send(self, name: str, listed: bool = False) -> None:
        index = self._index[name]
        kind = self._table[index].type
        # An ArduPilot announces a change with an index that belongs to no parameter.
        shown = index if listed or self._bytewise else UNLISTED
        self._send_value(name, self._values[name], kind, shown)

    def _send_value(self, name: str, value: float, kind: int, index: int) -> None:
        msg = mavlink.MAVLink_param_value_message(name.encode(), 0.0, kind, len(self), index)
        data = encoded(value, kind, self._bytewise)
        self.vehicle.send(with_value_bytes(msg, data, mavlink.MAVLink))

    def _send_hash(self) -> None:
        """A checksum over all, by which a ground station knows that its cache still holds."""
        crc = 0
        for param in self._table:
            value = self._values[param.name]
            data = encoded(value, param.type, True)
            crc = zlib.crc32(param.name.encode() + data, crc)
        self._send_value(HASH, crc, mavlink.MAV_PARAM_TYPE_UINT32, UNLISTED)
