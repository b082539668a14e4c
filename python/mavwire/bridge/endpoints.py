"""Endpoints as users write them: the words of mavlink_connection and those of mavp2p."""

from __future__ import annotations

import re

from .checks import whole
from .errors import ConfigError
from .options import DEFAULT_BAUD, Endpoint

WORDS = {
    "udpout": "udpout",
    "udpin": "udpin",
    "udp": "udpin",
    "udpbcast": "udpbcast",
    "tcp": "tcp",
    "tcpin": "tcpin",
    # mavp2p
    "udpc": "udpout",
    "udps": "udpin",
    "udpb": "udpbcast",
    "tcpc": "tcp",
    "tcps": "tcpin",
}
MOST_DIGITS = 10
FORMS = (
    "udpin:HOST:PORT, udpout:HOST:PORT, udpbcast:HOST:PORT, tcp:HOST:PORT, tcpin:HOST:PORT, "
    "serial:DEVICE:BAUD or DEVICE,BAUD"
)


def parse_endpoint(text: str) -> Endpoint:
    """The endpoint that a text names. ConfigError says what is wrong with it."""
    word, colon, rest = text.partition(":")
    if colon and word in WORDS:
        return _network(text, WORDS[word], rest)
    if colon and word == "serial":
        return _serial(text, rest)
    if text.startswith("/"):
        return _serial(text, text)
    raise ConfigError(f"{text!r} is no endpoint; say {FORMS}")


def _network(text: str, kind: str, rest: str) -> Endpoint:
    match = re.fullmatch(r"(?:\[([^\]]+)\]|([^:\[\]]*)):([0-9]+)", rest)
    if match is None:
        raise ConfigError(f"{text!r} lacks host or port; say {text.partition(':')[0]}:HOST:PORT")
    least = 0 if kind in ("udpin", "tcpin") else 1
    port = _number(f"the port of {text!r}", match[3], 65535, least)
    host = match[1] or match[2]
    if not host:
        if least:
            raise ConfigError(f"{text!r} lacks a host")
        host = "0.0.0.0"
    return Endpoint(kind, host, port)


def _serial(text: str, rest: str) -> Endpoint:
    match = re.fullmatch(r"(.+?)(?:[:,]([0-9]+))?", rest)
    if match is None:
        raise ConfigError(f"{text!r} lacks a device; say serial:DEVICE:BAUD")
    baud = DEFAULT_BAUD
    if match[2] is not None:
        baud = _number(f"the speed of {text!r}", match[2], 2**31, 1)
    return Endpoint("serial", match[1], baud=baud)


def _number(what: str, digits: str, most: int, least: int) -> int:
    # int() refuses some thousand digits in words of its own.
    value = int(digits) if len(digits) <= MOST_DIGITS else most + 1
    return whole(what, value, most, least=least)
