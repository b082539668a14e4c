"""Visible values of messages and links, in a form that compares across the packages.

Classes are compared by name. Fields are compared by their repr, so that NaN equals NaN and -0.0
differs from 0.0.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any, NamedTuple

HEADER = ("mlen", "seq", "srcSystem", "srcComponent", "msgId", "incompat_flags", "compat_flags")
SENDING = ("seq", "total_packets_sent", "total_bytes_sent")
RECEIVING = (
    "total_packets_received",
    "total_bytes_received",
    "total_receive_errors",
    "expected_length",
    "have_prefix_error",
)
SIGNING = (
    "stream_timestamps",
    "sig_count",
    "goodsig_count",
    "badsig_count",
    "unsigned_count",
    "reject_count",
)
# The texts of mavwire show no secret key; the fields are compared, the key among them.
KEY_TEXT = re.compile(r"(?<=secret_key : )\[[^]]*\]")


class Seen(NamedTuple):
    """A message as a user sees it."""

    class_name: str
    message_type: str
    text: str
    fields: str
    frame: bytes
    payload: bytes | bytearray | None
    crc: int | None
    signed: bool
    link_id: int | None
    header: dict[str, int]


class Raised(NamedTuple):
    """An exception instead of an answer."""

    error: str
    text: str


def message(msg: Any) -> Seen:
    """Everything a user sees of a message."""
    header = msg.get_header()
    return Seen(
        type(msg).__name__,
        msg.get_type(),
        KEY_TEXT.sub("", str(msg)),
        repr(msg.to_dict()),
        bytes(msg.get_msgbuf()),
        msg.get_payload(),
        msg.get_crc(),
        msg.get_signed(),
        msg.get_link_id(),
        {name: getattr(header, name) for name in HEADER},
    )


def raised(error: Exception) -> Raised:
    """The exception by name and text."""
    return Raised(type(error).__name__, str(error))


def outcome(call: Callable[[], Any]) -> Any:
    """The result of a call, or its exception as a value."""
    try:
        return call()
    except Exception as error:
        return raised(error)


def receiving_state(mav: Any) -> dict[str, Any]:
    """Counters of what was received, and what is left in the buffer."""
    seen = {name: getattr(mav, name) for name in RECEIVING}
    seen |= {f"signing.{name}": getattr(mav.signing, name) for name in SIGNING}
    if not mav.signing.sign_outgoing:  # else another thread may be sending, which moves it
        seen["signing.timestamp"] = mav.signing.timestamp
    return seen | {"buf_len()": mav.buf_len(), "bytes_needed()": mav.bytes_needed()}


def first_difference(ours: Any, theirs: Any) -> tuple[str, Any, Any]:
    """The name of the first difference, and its two values."""
    if isinstance(ours, Seen) and isinstance(theirs, Seen):
        ours, theirs = ours._asdict(), theirs._asdict()
    if isinstance(ours, dict) and isinstance(theirs, dict):
        for name, value in ours.items():
            if value != theirs[name]:
                return name, value, theirs[name]
    return "answer", ours, theirs
