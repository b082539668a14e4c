"""Stands in for ROS 2's messages, which take values of the right type only."""

from __future__ import annotations

from typing import Any, ClassVar


class _Checked:
    fields: ClassVar[dict[str, type]] = {}

    def __init__(self) -> None:
        for name, kind in self.fields.items():
            self.__dict__[name] = kind()

    def __setattr__(self, name: str, value: object) -> None:
        assert type(value) is self.fields[name], f"{name} = {value!r}"
        self.__dict__[name] = value

    def plain(self) -> dict[str, Any]:
        """As JSON can hold it."""
        values = {name: self.__dict__[name] for name in self.fields}
        return {
            name: getattr(value, "plain", lambda value=value: value)()
            for name, value in values.items()
        }


class Time(_Checked):
    fields: ClassVar = {"sec": int, "nanosec": int}


class Header(_Checked):
    fields: ClassVar = {"stamp": Time, "frame_id": str}


class Vector3(_Checked):
    fields: ClassVar = {"x": float, "y": float, "z": float}


class Vector3Stamped(_Checked):
    fields: ClassVar = {"header": Header, "vector": Vector3}
