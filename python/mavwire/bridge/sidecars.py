"""HTTP servers and sinks that `mavwire bridge` opens beside a bridge, as a file describes them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from .checks import content, listed, only_known, text
from .errors import ConfigError

# A password is shorter.
MAX_PASSWORD = 4096


@dataclass(frozen=True)
class Listen:
    """Where an HTTP server listens, and the names that a proxy in front of it answers to. `place`: where it is described."""

    host: str
    port: int
    names: tuple[str, ...] = ()
    place: str = field(default="", compare=False)


@dataclass(frozen=True)
class SinkOptions:
    """A sink's address, and what does not stand in it. `place`: where it is described."""

    address: str
    password: str | None = field(default=None, repr=False)
    names: tuple[str, ...] = ()
    place: str = ""


def listen_address(address: str) -> tuple[str, int]:
    """[HOST]:PORT. ConfigError."""
    host, _, port = address.rpartition(":")
    if not (port.isascii() and port.isdecimal() and len(port) < 6 and int(port) < 65536):
        raise ConfigError(f"not [HOST]:PORT: {address!r}")
    return host.strip("[]") or "127.0.0.1", int(port)


def listen_from(table: Any, place: str) -> Listen:
    """A table `[http]` or `[metrics]`. ConfigError."""
    known = _checked(table, "listen", ":8080", ("listen", "names"))
    return Listen(*listen_address(text("listen", known["listen"])), _names(known), place)


def sink_from(table: Any, place: str) -> SinkOptions:
    """A table of `[[sink]]`. ConfigError."""
    known = _checked(table, "address", "mqtt://HOST", ("address", "password_file", "names"))
    path = known.get("password_file")
    password = None if path is None else _password("password_file", path)
    return SinkOptions(text("address", known["address"]), password, _names(known), place)


def _checked(table: Any, needed: str, such_as: str, options: tuple[str, ...]) -> dict[str, Any]:
    if not isinstance(table, dict) or needed not in table:
        raise ConfigError(f"it needs {needed}, such as {such_as!r}")
    only_known(table, options)
    return table


def _names(table: dict[str, Any]) -> tuple[str, ...]:
    return tuple(text("names", name) for name in listed("names", table.get("names", ())))


def _password(name: str, path: object) -> str:
    """The first line of a file."""
    try:
        password = content(name, path, MAX_PASSWORD).decode().partition("\n")[0].rstrip("\r")
    except UnicodeDecodeError:
        raise ConfigError(f"{name}: {path}: not text") from None
    if not password:
        raise ConfigError(f"{name}: {path}: its first line is empty")
    return password
