"""Per-endpoint signing, verification and protocol version; the bridge's own heartbeats and stream requests."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from mavwire.links.signing_time import UNITS_PER_SECOND

from .checks import content, flag, seconds, whole
from .errors import ConfigError

KEY_LENGTH = 32
MAX_KEY_FILE = 1024
# Unlike the systems of ground stations: a vehicle must not take the bridge for one.
DEFAULT_SYSTEM = 125
BORDER_OPTIONS = (
    "version", "signing_key", "signing_key_file", "verify_in", "allow_unsigned_in", "sign_out",
    "strip_in", "strip_out", "max_ahead_in",
)  # fmt: skip
AUTOMATION_OPTIONS = ("heartbeat", "request_streams", "own_system")


@dataclass(frozen=True)
class Border:
    """Signatures verified, put on or taken off, and the version that frames leave in."""

    version: int | None = None
    key: bytes | None = field(default=None, repr=False)
    verify: bool = False
    unsigned: list[int] = field(default_factory=list)
    """Messages that may come in without a signature all the same."""
    sign: bool = False
    strip_in: bool = False
    strip_out: bool = False
    max_ahead: int | None = None
    """How far ahead of the clock a signature may be, in 10 us units; None sets no limit."""


@dataclass(frozen=True)
class Automation:
    """Heartbeats every so many seconds, and streams that ArduPilot vehicles are asked for, in Hz."""

    system: int = DEFAULT_SYSTEM
    heartbeat: float | None = None
    stream_rate: int | None = None


def border_from(
    options: Mapping[str, Any], message_ids: Callable[[str, object], list[int]]
) -> Border:
    """The border that a link's options describe. ConfigError, OSError for a file with a key."""
    version = options.get("version")
    if version is not None:
        version = whole("version", version, 2, least=1)
    key = signing_key(options)
    flags = {
        name: flag(name, options.get(name, False))
        for name in ("verify_in", "sign_out", "strip_in", "strip_out")
    }
    for name in ("verify_in", "sign_out"):
        if flags[name] and key is None:
            raise ConfigError(f"{name} needs signing_key or signing_key_file")
    if key is not None and not (flags["verify_in"] or flags["sign_out"]):
        name = "signing_key" if "signing_key" in options else "signing_key_file"
        raise ConfigError(f"{name} does nothing without verify_in or sign_out")
    if flags["sign_out"] and version == 1:
        reason = "sign_out needs version 2: frames of version 1 carry no signature"
        raise ConfigError(reason)
    if flags["sign_out"] and flags["strip_out"]:
        raise ConfigError("sign_out and strip_out exclude each other")
    unsigned = options.get("allow_unsigned_in")
    if unsigned is not None and not flags["verify_in"]:
        raise ConfigError("allow_unsigned_in does nothing without verify_in")
    ahead = options.get("max_ahead_in")
    if ahead is not None and not flags["verify_in"]:
        raise ConfigError("max_ahead_in does nothing without verify_in")
    return Border(
        version=version,
        key=key,
        verify=flags["verify_in"],
        unsigned=[] if unsigned is None else message_ids("allow_unsigned_in", unsigned),
        sign=flags["sign_out"],
        strip_in=flags["strip_in"],
        strip_out=flags["strip_out"],
        max_ahead=None if ahead is None else int(seconds("max_ahead_in", ahead) * UNITS_PER_SECOND),
    )


def automation_from(options: Mapping[str, Any]) -> Automation:
    """The messages that the bridge itself sends to a link. ConfigError."""
    system = whole("own_system", options.get("own_system", DEFAULT_SYSTEM), 255, least=1)
    heartbeat, rate = options.get("heartbeat"), options.get("request_streams")
    if "own_system" in options and heartbeat is None and rate is None:
        reason = "own_system does nothing without heartbeat or request_streams"
        raise ConfigError(reason)
    return Automation(
        system=system,
        heartbeat=None if heartbeat is None else seconds("heartbeat", heartbeat, least=0.01),
        stream_rate=None if rate is None else whole("request_streams", rate, 1000, least=1),
    )


def signing_key(options: Mapping[str, Any]) -> bytes | None:
    """The signing key: 32 bytes, or 64 hexadecimal digits. Error texts do not show it."""
    key, path = options.get("signing_key"), options.get("signing_key_file")
    name = "signing_key"
    if path is not None:
        if key is not None:
            raise ConfigError("say signing_key or signing_key_file, not both")
        name = "signing_key_file"
        key = content(name, path, MAX_KEY_FILE)
    if key is None:
        return None
    if isinstance(key, bytes | bytearray) and len(key) == KEY_LENGTH:
        return bytes(key)
    try:
        text = key.decode("ascii") if isinstance(key, bytes | bytearray) else str(key)
        decoded = bytes.fromhex(text.strip())
    except ValueError:
        decoded = b""
    if len(decoded) != KEY_LENGTH:
        raise ConfigError(f"{name} must be 32 bytes, or 64 hexadecimal digits")
    return decoded
