"""Sizes and times of a transfer, by name, so that a user can change them at a prompt."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

Number = int | float
Description = tuple[str, type, Number]

DEFAULTS: tuple[Description, ...] = (
    ("debug", int, 0),
    ("pkt_loss_tx", int, 0),
    ("pkt_loss_rx", int, 0),
    ("max_backlog", int, 5),
    ("burst_read_size", int, 80),
    ("write_size", int, 80),
    ("write_qsize", int, 5),
    ("idle_detection_time", float, 3.7),
    ("read_retry_time", float, 1.0),
    ("retry_time", float, 0.5),
)


class MAVFTPSetting:
    """A setting: its name, type, default and value."""

    def __init__(self, name: str, s_type: type, default: Number) -> None:
        self.name, self.type = name, s_type
        self.default = self.value = default


class MAVFTPSettings:
    """Settings as attributes; a value is converted to the type of its setting."""

    _vars: dict[str, MAVFTPSetting]

    def __init__(self, s_vars: Iterable[MAVFTPSetting | Description]) -> None:
        object.__setattr__(self, "_vars", {})
        for one in s_vars:
            self.append(one)

    def append(self, v: MAVFTPSetting | Description) -> None:
        """Add a setting: one, or its name, type and default."""
        setting = v if isinstance(v, MAVFTPSetting) else MAVFTPSetting(*v)
        self._vars[setting.name] = setting

    def __getattr__(self, name: str) -> Any:
        settings = self.__dict__.get("_vars", {})
        if name not in settings:
            raise AttributeError(name)
        return settings[name].value

    def __setattr__(self, name: str, value: Any) -> None:
        if name not in self._vars:
            raise AttributeError(name)
        setting = self._vars[name]
        setting.value = setting.type(value)
