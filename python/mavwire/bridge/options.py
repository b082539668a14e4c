"""The options of a bridge, checked where they are given. The native side reads these objects."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from itertools import product
from typing import Any

from mavwire.dialects import UPSTREAM

from .border import (
    AUTOMATION_OPTIONS,
    BORDER_OPTIONS,
    Automation,
    Border,
    automation_from,
    border_from,
)
from .checks import flag, listed, only_known, rate, seconds, text, whole
from .errors import ConfigError
from .sidecars import Listen, SinkOptions

KINDS = ("udpout", "udpin", "udpbcast", "tcp", "tcpin", "serial")
DEFAULT_BAUD = 115200
# The longest frame there is, which every receiver has room for.
MAX_FRAME_LEN = 280
HEARTBEAT = 0
_VERBS = ("allow", "block")
_LISTS = ("messages", "systems", "components")
Filter = list[tuple[bool, str, list[int]]]
"""The filter of one direction: lists that allow or block, with the property that they compare."""


@dataclass(frozen=True)
class Endpoint:
    """Where a bridge listens, connects or sends. `address` is a host, or the path of a serial port."""

    kind: str
    address: str
    port: int = 0
    baud: int = DEFAULT_BAUD
    flow_control: bool = False

    def __str__(self) -> str:
        if self.kind == "serial":
            return f"{self.kind}:{self.address}:{self.baud}"
        host = f"[{self.address}]" if ":" in self.address else self.address
        return f"{self.kind}:{host}:{self.port}"


@dataclass(frozen=True)
class Settings:
    """How frames are routed; times in seconds."""

    dedup: float = 0.5
    max_age: float = 60.0
    sniffer_sysid: int = 0

    def __post_init__(self) -> None:
        seconds("dedup", self.dedup)
        seconds("max_age", self.max_age, least=1e-3)
        whole("sniffer_sysid", self.sniffer_sysid, 255)


@dataclass(frozen=True)
class Recording:
    """Recording into telemetry logs in `directory`.

    A new log begins when one has `max_bytes` or is `max_age` seconds old; what came is handed to
    the operating system after `flush_interval` seconds at the latest.
    """

    directory: str | os.PathLike[str]
    max_bytes: int | None = None
    max_age: float | None = None
    flush_interval: float = 1.0

    def __post_init__(self) -> None:
        if not isinstance(self.directory, str | os.PathLike):
            reason = f"the directory to record to must be a path, not {self.directory!r}"
            raise ConfigError(reason)
        if self.max_bytes is not None:
            whole("max_bytes", self.max_bytes, 2**63 - 1, least=1)
        if self.max_age is not None:
            seconds("max_age", self.max_age, least=1.0)
        seconds("flush_interval", self.flush_interval, least=1e-3)


@dataclass(frozen=True)
class EndpointOptions:
    """An endpoint with its options; `endpoint_options` makes one of what users write."""

    name: str
    endpoint: Endpoint
    group: str | None = None
    group_number: int | None = None
    private: bool = False
    sniffer: bool = False
    inbound: Filter = field(default_factory=list)
    outbound: Filter = field(default_factory=list)
    border: Border = field(default_factory=Border)
    automation: Automation = field(default_factory=Automation)
    bytes_per_second: float | None = None
    message_rate: float | None = None
    message_rates: list[tuple[int, float]] = field(default_factory=list)
    urgent: list[int] = field(default_factory=list)
    queue: int = 256 * 1024
    datagram: int = MAX_FRAME_LEN
    forward_unverified: bool = False
    peer_timeout: float = 60.0
    retry: float | None = 8.0


def endpoint_options(
    endpoint: Endpoint, options: Mapping[str, Any], message_id: Callable[[object], int]
) -> EndpointOptions:
    """An endpoint with the options of docs/bridge.md. ConfigError names the one that is wrong.

    `message_id` turns a name or number of a message into its id, or raises ConfigError.
    """
    known = {
        "name", "group", "private", "sniffer", "bytes_per_second", "rate", "rates", "queue_bytes",
        "datagram_bytes", "forward_unverified", "peer_timeout", "retry", "urgent", "read_only", "silent",
        *BORDER_OPTIONS, *AUTOMATION_OPTIONS,
        *map("_".join, product(_VERBS, _LISTS, ("in", "out"))),
    }  # fmt: skip
    only_known(options, known)

    def message_ids(name: str, values: object) -> list[int]:
        return [_named(name, message_id, value) for value in listed(name, values)]

    for name in ("heartbeat", "request_streams"):
        if options.get("silent") and options.get(name) is not None:
            raise ConfigError(f"silent and {name} exclude each other: nothing leaves there")
    urgent = options.get("urgent")
    bytes_per_second = rate("bytes_per_second", options.get("bytes_per_second"))
    return EndpointOptions(
        name=text("name", options.get("name", str(endpoint))),
        endpoint=endpoint,
        group=None if options.get("group") is None else text("group", options["group"]),
        private=flag("private", options.get("private", False)),
        sniffer=flag("sniffer", options.get("sniffer", False)),
        forward_unverified=flag("forward_unverified", options.get("forward_unverified", False)),
        inbound=_filter(options, "in", "read_only", message_ids),
        outbound=_filter(options, "out", "silent", message_ids),
        border=border_from(options, message_ids),
        automation=automation_from(options),
        bytes_per_second=bytes_per_second,
        message_rate=rate("rate", options.get("rate")),
        message_rates=_rates(options.get("rates"), message_id),
        urgent=_urgent(message_ids("urgent", [] if urgent is None else urgent), bytes_per_second),
        queue=whole(
            "queue_bytes", options.get("queue_bytes", EndpointOptions.queue), 1 << 30, least=1024
        ),
        datagram=whole(
            "datagram_bytes", options.get("datagram_bytes", EndpointOptions.datagram), 65_507
        ),
        peer_timeout=seconds("peer_timeout", options.get("peer_timeout", 60.0), least=1e-3),
        retry=_retry(options.get("retry", EndpointOptions.retry)),
    )


def _filter(
    options: Mapping[str, Any],
    way: str,
    closed: str,
    message_ids: Callable[[str, object], list[int]],
) -> Filter:
    """The filter of one direction; the option `closed` lets nothing pass."""
    if flag(closed, options.get(closed, False)):
        return [(True, "messages", [])]
    lists = []
    for verb, what in product(_VERBS, _LISTS):
        name = f"{verb}_{what}_{way}"
        values = options.get(name)
        if values is not None:
            ids = (
                message_ids(name, values)
                if what == "messages"
                else [whole(name, value, 255) for value in listed(name, values)]
            )
            lists.append((verb == "allow", what, ids))
    return lists


def _urgent(messages: list[int], bytes_per_second: float | None) -> list[int]:
    """Heartbeats too where bytes are few: who hears none takes the vehicle for lost."""
    if bytes_per_second is None or HEARTBEAT in messages:
        return messages
    return [*messages, HEARTBEAT]


def _rates(
    rates: Mapping[object, object] | None, message_id: Callable[[object], int]
) -> list[tuple[int, float]]:
    if rates is None:
        return []
    if not hasattr(rates, "items"):
        raise ConfigError(f"rates must map messages to numbers, not {rates!r}")
    known: dict[int, float] = {}
    try:
        for name, each in rates.items():
            msgid = message_id(name)
            if msgid in known:
                raise ConfigError(f"{name!r} is a message that was named before")
            known[msgid] = rate(str(name), each) or 0.0
    except ConfigError as error:
        raise error.at("rates") from None
    return list(known.items())


def _named(option: str, message_id: Callable[[object], int], value: object) -> int:
    try:
        return message_id(value)
    except ConfigError as error:
        raise error.at(option) from None


def _retry(value: object) -> float | None:
    """The longest pause between two attempts; 0 or None for no second connection."""
    return None if not value else seconds("retry", value, least=1e-3)


@dataclass
class Config:
    """A bridge as a file describes it. `warnings` are lines about what has no effect here."""

    links: list[tuple[str, Endpoint, dict[str, Any]]] = field(default_factory=list)
    """Place in the file, endpoint, options."""
    settings: dict[str, Any] = field(default_factory=dict)
    recording: Recording | None = None
    dialect: Any = UPSTREAM
    """A dialect, or a list of several."""
    json: float | None = None
    """Seconds between two lines of counters that `mavwire bridge` prints."""
    http: Listen | None = None
    metrics: Listen | None = None
    sinks: list[SinkOptions] = field(default_factory=list)
    path: str = ""
    warnings: list[str] = field(default_factory=list)
