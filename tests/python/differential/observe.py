"""What a user can see of a message and of a parser, as plain comparable values.

Types are compared by name and not by identity, since the two packages have classes of their own.
Floats are compared by their repr, so that NaN equals NaN and -0.0 differs from 0.0.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

COUNTERS = (
    "total_packets_received",
    "total_bytes_received",
    "total_receive_errors",
    "have_prefix_error",
    "expected_length",
    "seq",
)
SIGNING_COUNTERS = (
    "sig_count",
    "goodsig_count",
    "badsig_count",
    "unsigned_count",
    "reject_count",
    "timestamp",
)
HEADER = ("mlen", "seq", "srcSystem", "srcComponent", "msgId", "incompat_flags", "compat_flags")

# The value of a key in a text or in JSON.
KEY_TEXT = re.compile(r'(?<=secret_key : |secret_key": )\[[^]]*\]')
# All bytes of a message whose definition is not there.
BYTES = re.compile(r"\[[^]]*\]")


def raised(action: Callable[[], Any]) -> Any:
    """The result of a call, or the type and text of what it raised."""
    try:
        return action()
    except Exception as error:
        return f"RAISES {type(error).__name__}: {error}"


def without_key(msg: Any, shown: str) -> str:
    """A text of a message without the secret key, which mavwire alone hides."""
    return (BYTES if msg.get_type() == "UNKNOWN_256" else KEY_TEXT).sub("", shown)


def text(msg: Any) -> str:
    """`str(msg)`."""
    return without_key(msg, str(msg))


def json(msg: Any) -> Any:
    """`msg.to_json()`."""
    answer = raised(msg.to_json)
    return without_key(msg, answer) if isinstance(answer, str) else answer


def message(msg: Any) -> tuple[Any, ...]:
    """Everything but the JSON and the re-encoding: cheap enough for millions of messages."""
    header = msg.get_header()
    return (
        type(msg).__name__,
        msg.get_type(),
        text(msg),
        repr(msg.to_dict()),
        bytes(msg.get_msgbuf()),
        msg.get_payload(),
        msg.get_crc(),
        msg.get_signed(),
        msg.get_link_id(),
        tuple(getattr(header, name) for name in HEADER),
    )


def message_methods(msg: Any) -> tuple[Any, ...]:
    """The rest of the accessors, for the smaller runs."""
    names = msg.get_fieldnames()
    return (
        names,
        [repr(getattr(msg, name)) for name in names],
        [repr(msg.format_attr(name)) for name in names],
        [repr(getattr(msg, f"_{name}_raw", None)) for name in names],
        (msg.get_msgId(), msg.get_srcSystem(), msg.get_srcComponent(), msg.get_seq()),
        type(msg.get_msgbuf()).__name__,
        type(msg.get_payload()).__name__,
        raised(lambda: msg[0]),
        raised(lambda: hash(msg)),
        sorted(vars(msg).keys() & set(names)),
    )


def reencoded(msg: Any, mav: Any) -> Any:
    """The frame that packing the message again gives, sent from the same place with the same
    sequence number.
    """
    header = msg.get_header()
    mav.seq, mav.srcSystem, mav.srcComponent = header.seq, header.srcSystem, header.srcComponent
    return raised(lambda: msg.pack(mav))


def parser(mav: Any) -> tuple[Any, ...]:
    """Counters and the state of the receive buffer."""
    return (
        tuple(getattr(mav, name) for name in COUNTERS),
        tuple(getattr(mav.signing, name) for name in SIGNING_COUNTERS),
        mav.buf_len(),
        mav.bytes_needed(),
    )


def difference(ours: Any, theirs: Any, place: str = "") -> str:
    """Where two observations first differ, short enough to read."""
    pair = (ours, theirs)
    if all(isinstance(one, tuple | list) for one in pair) and len(ours) == len(theirs):
        for index, (our, their) in enumerate(zip(ours, theirs, strict=True)):
            if our != their:
                return difference(our, their, f"{place}[{index}]")
    return f"at {place or 'top'}\n subject {ours!r:.500}\n oracle  {theirs!r:.500}"
