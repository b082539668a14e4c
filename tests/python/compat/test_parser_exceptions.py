"""An exception out of user code in the middle of a stream costs the message it is about, no other."""

from __future__ import annotations

import importlib
import logging
from typing import Any

KEY = bytes(range(32))


def dialect(package: str) -> Any:
    return importlib.import_module(f"{package}.dialects.v20.common")


def stream(mavlink: Any, signed: bool = False) -> bytes:
    """Six attitudes, noise, two attitudes."""
    mav = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
    if signed:
        mav.signing.secret_key, mav.signing.sign_outgoing = KEY, True
    frames = []
    for number in range(8):
        msg = mavlink.MAVLink_attitude_message(number, 0, 0, 0, 0, 0, 1)
        frames.append(bytes(msg.pack(mav)))
        mav.seq += 1
    return b"".join(frames[:6]) + b"noise" + b"".join(frames[6:])


def read(mav: Any, data: bytes) -> list[Any]:
    """What parsing to the end gives: messages and exceptions."""
    out: list[Any] = []
    while True:
        try:
            messages = mav.parse_buffer(data)
        except Exception as error:
            out.append(str(error))
        else:
            if not messages:
                return out
            out += [getattr(msg, "time_boot_ms", msg.get_type()) for msg in messages]
        data = b""


def parser(mavlink: Any) -> Any:
    class Choosy(mavlink.MAVLink):
        def decode(self, msgbuf: bytearray) -> Any:
            msg = super().decode(msgbuf)
            if msg.time_boot_ms == 3:
                raise ValueError("not three")
            return msg

    mav = Choosy(None)
    mav.robust_parsing = True
    return mav


def test_a_decoder_that_raises(oracle: str, subject: str) -> None:
    outcomes = []
    for package in (oracle, subject):
        mavlink = dialect(package)
        mav = parser(mavlink)
        outcomes.append((read(mav, stream(mavlink)), mav.total_packets_received))
    assert outcomes[0] == outcomes[1]
    assert outcomes[1][0] == ["not three", 4, 5, "BAD_DATA", 6, 7]


def test_a_log_handler_that_raises(subject: str) -> None:
    mavlink = dialect(subject)

    class Refusing(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            logger.removeHandler(self)
            raise ValueError(record.getMessage())

    logger = logging.getLogger(mavlink.__name__)
    logger.addHandler(Refusing())
    level = logger.level
    logger.setLevel(logging.INFO)
    mav = mavlink.MAVLink(None)
    mav.robust_parsing = True
    mav.signing.secret_key = KEY
    got = read(mav, stream(mavlink, signed=True))
    logger.setLevel(level)
    assert got == ["new stream", 1, 2, 3, 4, 5, "BAD_DATA", 6, 7]
