"""Configuration files: TOML, or the format of mavlink-router's main.conf. No file is executed."""

from __future__ import annotations

import os
from dataclasses import dataclass, field

from mavwire._wording import did_you_mean

from .endpoints import parse_endpoint
from .errors import ConfigError
from .options import Recording, Settings

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from .options import Endpoint

# No configuration is longer; a path that leads to something else by mistake is not read whole.
MAX_SIZE = 1 << 20


@dataclass
class Config:
    """A bridge as a file describes it. `warnings` are lines about what has no effect here."""

    links: list[tuple[str, Endpoint, dict[str, Any]]] = field(default_factory=list)
    """Where it stands, endpoint, options."""
    settings: dict[str, Any] = field(default_factory=dict)
    recording: Recording | None = None
    dialect: str = "all"
    path: str = ""
    warnings: list[str] = field(default_factory=list)


def load_config(path: str | os.PathLike[str]) -> Config:
    """Read a file: TOML if its name ends so, else mavlink-router's format.

    ConfigError (a ValueError) names the file, and line or link; OSError if it cannot be read.
    """
    name = os.fspath(path)
    with open(name, "rb") as file:
        data = file.read(MAX_SIZE + 1)
    if len(data) > MAX_SIZE:
        raise ConfigError(f"{name}: longer than {MAX_SIZE} bytes")
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError as error:
        raise ConfigError(f"{name}: not text, at byte {error.start}") from None
    if name.lower().endswith(".toml"):
        return _toml(name, text)
    from .main_conf import parse_main_conf

    return parse_main_conf(name, text)


def _toml(name: str, text: str) -> Config:
    import tomllib

    try:
        content = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise ConfigError(f"{name}: {error}") from None
    _check_names(name, content, ("dedup", "max_age", "sniffer_sysid", "dialect", "record", "link"))
    config = Config(path=name)
    for option in ("dedup", "max_age", "sniffer_sysid"):
        if option in content:
            config.settings[option] = content[option]
    try:
        Settings(**config.settings)
    except ConfigError as error:
        raise ConfigError(f"{name}: {error}") from None
    config.dialect = content.get("dialect", "all")
    if not isinstance(config.dialect, str):
        raise ConfigError(f"{name}: dialect must be a text, not {config.dialect!r}")
    if "record" in content:
        config.recording = _recording(f"{name}: record", content["record"])
    links = content.get("link", [])
    if not isinstance(links, list):
        raise ConfigError(f"{name}: say [[link]], not [link]")
    config.links = [_link(f"{name}: link {n}", link) for n, link in enumerate(links, 1)]
    return config


def _link(where: str, link: Any) -> tuple[str, Endpoint, dict[str, Any]]:
    if not isinstance(link, dict) or not isinstance(link.get("endpoint"), str):
        raise ConfigError(f"{where}: it needs an endpoint, such as 'udpin:0.0.0.0:14550'")
    options = {key: value for key, value in link.items() if key != "endpoint"}
    if isinstance(options.get("name"), str):
        where += f" ({options['name']!r})"
    try:
        return where, parse_endpoint(link["endpoint"]), options
    except ConfigError as error:
        raise ConfigError(f"{where}: {error}") from None


def _recording(where: str, record: Any) -> Recording:
    if not isinstance(record, dict) or not isinstance(record.get("directory"), str):
        raise ConfigError(f"{where}: it needs a directory")
    _check_names(where, record, ("directory", "max_bytes", "max_age", "flush_interval"))
    try:
        return Recording(**record)
    except ConfigError as error:
        raise ConfigError(f"{where}: {error}") from None


def _check_names(where: str, given: dict[str, Any], known: tuple[str, ...]) -> None:
    for option in given:
        if option not in known:
            raise ConfigError(f"{where}: unknown option {option!r}{did_you_mean(option, known)}")
