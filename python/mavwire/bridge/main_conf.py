"""mavlink-router's configuration file: sections of `Key = Value` lines, names in any case."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from mavwire._text import did_you_mean

from .checks import whole
from .errors import ConfigError
from .options import DEFAULT_BAUD, Config, Endpoint, Recording

DEFAULT_TCP_PORT = 5760
FIRST_UDP_PORT = 14550
_FILTERS = {
    f"{verb}{theirs}{way}": f"{verb.lower()}_{ours}_{way.lower()}"
    for verb in ("Allow", "Block")
    for theirs, ours in (("MsgId", "messages"), ("SrcSys", "systems"), ("SrcComp", "components"))
    for way in ("In", "Out")
}
# Options of mavlink-router that have no effect here, with the reason or the replacement.
_NO_EFFECT = {
    "ReportStats": "use --json, --status or --metrics",
    "DebugLogLevel": "there are no levels",
    "MavlinkDialect": "all dialects are known",
    "LogMode": "telemetry is recorded always",
    "LogSystemId": "telemetry of all systems is recorded",
    "MinFreeSpace": "logs are not deleted",
    "MaxLogFiles": "logs are not deleted",
}
_GENERAL = {
    "TcpServerPort", "DeduplicationPeriod", "SnifferSysid", "Log", "LogTelemetry", *_NO_EFFECT,
}  # fmt: skip
_COMMON = {"Group", *_FILTERS}
_KEYS = {
    "general": _GENERAL,
    "uartendpoint": {"Device", "Baud", "FlowControl", *_COMMON},
    "udpendpoint": {"Mode", "Address", "Port", "Filter", *_COMMON},
    "tcpendpoint": {"Address", "Port", "RetryTimeout", *_COMMON},
}


@dataclass
class _Section:
    kind: str
    name: str
    where: str
    entries: dict[str, tuple[str, str]] = field(default_factory=dict)
    """Key, spelled as in `_KEYS` -> value, and its place in the file."""

    def get(self, key: str) -> str | None:
        return self.entries[key][0] if key in self.entries else None

    def place(self, key: str) -> str:
        """The place of a key, or else of its section."""
        return self.entries[key][1] if key in self.entries else self.where

    def need(self, key: str) -> str:
        value = self.get(key)
        if not value:
            raise ConfigError(f"{self.place(key)}: [{self.name}] lacks {key}")
        return value

    def read(self, key: str, default: Any, convert: Callable[[str, str], Any]) -> Any:
        """A value, converted; the error names the line of the file."""
        if key not in self.entries:
            return default
        value, where = self.entries[key]
        try:
            return convert(key, value)
        except ConfigError as error:
            raise ConfigError(f"{where}: {error}") from None


def parse_main_conf(name: str, text: str) -> Config:
    """The bridge that a file describes. ConfigError names file and line."""
    config = Config(path=name)
    general = _Section("general", "General", name)
    endpoints: list[_Section] = []
    for section in _sections(name, text, config.warnings):
        if section.kind == "general":
            general.entries.update(section.entries)
        else:
            endpoints.append(section)
    _apply_general(config, general)
    ports = iter(range(FIRST_UDP_PORT, 65536))
    for section in endpoints:
        _add(config, section, ports)
    return config


def _sections(name: str, text: str, warnings: list[str]) -> list[_Section]:
    sections: list[_Section] = []
    for number, raw in enumerate(text.splitlines(), 1):
        line, where = raw.strip(), f"{name}:{number}"
        if not line or line[0] in "#;":
            continue
        header = re.fullmatch(r"\[\s*([^\s\]]+)(?:\s+([^\]]*?))?\s*\]", line)
        if header is not None:
            kind = header[1].lower()
            if kind not in _KEYS:
                raise ConfigError(f"{where}: unknown section [{header[1]}]")
            sections.append(_Section(kind, header[2] or header[1], where))
            continue
        key, equals, value = line.partition("=")
        if not equals or line[0] == "[":
            raise ConfigError(f"{where}: neither [Section] nor Key = Value: {line!r}")
        if not sections:
            raise ConfigError(f"{where}: stands before the first [Section]")
        _enter(sections[-1], key.strip(), value.strip(), where, warnings)
    return sections


def _enter(section: _Section, key: str, value: str, where: str, warnings: list[str]) -> None:
    known = _KEYS[section.kind]
    name = next((one for one in known if one.lower() == key.lower()), None)
    if name is None:
        raise ConfigError(f"{where}: unknown option {key!r}{did_you_mean(key, known)}")
    if name in section.entries:
        warnings.append(f"{section.place(name)}: no effect: {name} is given again at {where}")
    section.entries[name] = (value, where)


def _apply_general(config: Config, general: _Section) -> None:
    for key, why in _NO_EFFECT.items():
        if key in general.entries:
            config.warnings.append(f"{general.place(key)}: no effect here: {why}")
    period = general.read("DeduplicationPeriod", None, _whole)
    if period is not None:
        config.settings["dedup"] = period / 1000
    sniffer = general.read("SnifferSysid", None, lambda key, text: _whole(key, text, 255))
    if sniffer is not None:
        config.settings["sniffer_sysid"] = sniffer
    port = general.read("TcpServerPort", DEFAULT_TCP_PORT, _port)
    if port:
        config.links.append(
            (general.place("TcpServerPort"), Endpoint("tcpin", "0.0.0.0", port), {})
        )
    directory, telemetry = general.get("Log"), general.read("LogTelemetry", False, _flag)
    if directory and telemetry:
        config.recording = Recording(directory)
    elif directory:
        config.warnings.append(
            f"{general.place('Log')}: no effect here without LogTelemetry = true: "
            "flight stack logs are not stored"
        )
    elif telemetry:
        place = general.place("LogTelemetry")
        config.warnings.append(f"{place}: no effect without Log, which says where to")


def _add(config: Config, section: _Section, ports: Any) -> None:
    options: dict[str, Any] = {"name": section.name}
    if section.get("Group"):
        options["group"] = section.get("Group")
    for key, option in _FILTERS.items():
        ids = section.read(key, [], _msgids if "MsgId" in key else _ids)
        if ids:
            options[option] = ids
    endpoint = {"uartendpoint": _uart, "udpendpoint": _udp, "tcpendpoint": _tcp}[section.kind]
    config.links.append((section.where, endpoint(config, section, options, ports), options))


def _uart(config: Config, section: _Section, options: dict[str, Any], ports: Any) -> Endpoint:
    bauds = section.read("Baud", [DEFAULT_BAUD], _bauds)
    if len(bauds) > 1:
        place = section.place("Baud")
        config.warnings.append(f"{place}: only the first speed is used: {bauds[0]}")
    flow_control = section.read("FlowControl", False, _flag)
    device = section.need("Device")
    return Endpoint("serial", device, baud=(bauds or [DEFAULT_BAUD])[0], flow_control=flow_control)


def _udp(config: Config, section: _Section, options: dict[str, Any], ports: Any) -> Endpoint:
    mode = section.need("Mode").lower()
    address = section.need("Address").strip("[]")
    allowed = section.read("Filter", [], _msgids)
    if allowed and "allow_messages_out" in options:
        config.warnings.append(f"{section.place('Filter')}: no effect beside AllowMsgIdOut")
    elif allowed:  # an older name of it
        options["allow_messages_out"] = allowed
    if mode == "normal":
        port = section.read("Port", None, _port) or next(ports)
        return Endpoint("udpout", address, port)
    if mode not in ("server", "eavesdropping"):
        reason = f"Mode must be Normal or Server, not {mode!r}"
        raise ConfigError(f"{section.place('Mode')}: {reason}")
    section.need("Port")
    return Endpoint("udpin", address, section.read("Port", 0, _port))


def _tcp(config: Config, section: _Section, options: dict[str, Any], ports: Any) -> Endpoint:
    address = section.need("Address").strip("[]")
    section.need("Port")
    options["retry"] = section.read("RetryTimeout", 5, _whole)
    return Endpoint("tcp", address, section.read("Port", 0, partial(_port, least=1)))


# -- values


def _whole(key: str, text: str, most: int = 2**31 - 1, least: int = 0) -> int:
    # The length is looked at first: numbers with thousands of digits take time to read.
    if len(text) > 20 or not text.isascii() or not text.isdecimal():
        raise ConfigError(f"{key} must be a number from {least} to {most}, not {text[:40]!r}")
    return whole(key, int(text), most, least=least)


def _port(key: str, text: str, least: int = 0) -> int:
    return _whole(key, text, 65535, least)


def _several(key: str, text: str, most: int, least: int = 0) -> list[int]:
    parts = (part.strip() for part in text.split(","))
    return [_whole(key, part, most, least) for part in parts if part]


_ids = partial(_several, most=255)
_msgids = partial(_several, most=2**24 - 1)
_bauds = partial(_several, most=2**31, least=1)


def _flag(key: str, text: str) -> bool:
    values = {"true": True, "1": True, "false": False, "0": False}
    if text.lower() not in values:
        raise ConfigError(f"{key} must be true or false, not {text!r}")
    return values[text.lower()]
