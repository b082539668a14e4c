"""Signing: what must hold, case by case, and what someone without the key can do."""

from __future__ import annotations

import io
import struct
from collections.abc import Callable
from typing import Any

from encoder import frame, heartbeat, signed

from hardening.tools import KEY, dialect_of

BEAT = struct.pack("<I5B", 4, 2, 3, 81, 4, 3)
UNKNOWN = 70_000
MINUTE = 6_000_000
MAX = (1 << 48) - 1
OTHER = bytes(32)


class Party:
    """A MAVLink object with a key, and what came of each frame."""

    def __init__(self, package: str, timestamp: int = 0, **signing: Any) -> None:
        self.out = io.BytesIO()
        self.mav = dialect_of(package).MAVLink(self.out, 255, 190)
        self.mav.robust_parsing = True
        self.mav.signing.secret_key = KEY
        self.mav.signing.sign_outgoing = True
        self.mav.signing.timestamp = timestamp
        for name, value in signing.items():
            setattr(self.mav.signing, name, value)

    def takes(self, data: bytes) -> bool:
        """Whether a message came of it."""
        try:
            found = self.mav.parse_buffer(bytearray(data)) or []
        except Exception:
            return False
        return any(msg.get_type() != "BAD_DATA" for msg in found)

    def message(self, data: bytes) -> Any:
        (msg,) = self.mav.parse_buffer(bytearray(data))
        return msg

    def sent(self) -> bytes:
        self.out.seek(0)
        self.out.truncate()
        self.mav.heartbeat_send(2, 3, 81, 4, 4)
        return self.out.getvalue()

    def sent_timestamp(self) -> int:
        return int.from_bytes(self.sent()[-12:-6], "little")


def beat(timestamp: int, key: bytes = KEY, link_id: int = 3, sysid: int = 1) -> bytes:
    return signed(0, BEAT, key, timestamp, link_id, sysid=sysid)


def flipped(data: bytes, at: int) -> bytes:
    copy = bytearray(data)
    copy[at] ^= 1
    return bytes(copy)


def refuses_key(package: str, length: int) -> bool:
    try:
        Party(package, secret_key=bytes(length)).sent()
    except Exception:
        return True
    return False


def allowing(package: str, answer: Any = True) -> Party:
    return Party(package, allow_unsigned_callback=lambda _mav, _msgid: answer)


def raising(package: str) -> Party:
    def callback(_mav: Any, _msgid: int) -> bool:
        raise KeyError

    return Party(package, allow_unsigned_callback=callback)


def streams(party: Party) -> dict[Any, int]:
    return dict(party.mav.signing.stream_timestamps)


def blocked(package: str) -> bool:
    """Whether a forged packet of the last timestamp there is shuts out a genuine one."""
    party = Party(package)
    party.takes(beat(MAX, OTHER))
    return not party.takes(beat(1000))


def reopened(package: str) -> bool:
    """Whether a captured packet is taken ten minutes later, after its stream was opened by forging."""
    party = Party(package)
    party.takes(beat(500, OTHER))
    party.mav.signing.timestamp = 10 * MINUTE
    return party.takes(beat(1000))


def forged_moves(party: Party) -> bool:
    party.takes(beat(MAX // 2, OTHER))
    return bool(party.mav.signing.timestamp > 1000)


def sequence(package: str, *frames: bytes) -> list[bool]:
    party = Party(package)
    return [party.takes(one) for one in frames]


def keyless(package: str, data: bytes) -> Any:
    party = Party(package, secret_key=None, sign_outgoing=False)
    return party.message(data)


def unknown_signed(key: bytes) -> bytes:
    return signed(UNKNOWN, b"\1\2\3", key, 1000, crc_extra=77)


CASES: dict[str, Callable[[str], bool]] = {
    "R30 block of 13 bytes": lambda p: len(Party(p).sent()) == len(heartbeat()) + 13,
    "R30 flag": lambda p: Party(p).sent()[2] == 1,
    "R32 as the formula says": lambda p: Party(p, 1000, link_id=3).sent()
    == signed(0, BEAT, KEY, 1000, sysid=255, compid=190),
    "R32 good one": lambda p: Party(p).takes(beat(1000)),
    "R32 another key": lambda p: not Party(p).takes(beat(1000, OTHER)),
    "R32 flipped digest": lambda p: not Party(p).takes(flipped(beat(1000), -1)),
    "R32 flipped timestamp": lambda p: not Party(p).takes(flipped(beat(1000), -12)),
    "R32 flipped link id": lambda p: not Party(p).takes(flipped(beat(1000), -13)),
    "R32 flipped payload": lambda p: not Party(p).takes(flipped(beat(1000), 12)),
    "R34 rises": lambda p: rises(Party(p, 1000)),
    "R34 not beyond 48 bits": lambda p: not wraps(p),
    "R37 follows a good one": lambda p: follows(p),
    "R37 never back": lambda p: stays(p),
    "R38 not a forged one": lambda p: not forged_moves(Party(p)),
    "R38 not one let pass": lambda p: not forged_moves(allowing(p)),
    "R39 replay": lambda p: sequence(p, beat(1000), beat(1000)) == [True, False],
    "R39 older": lambda p: sequence(p, beat(1000), beat(999)) == [True, False],
    "R39 newer": lambda p: sequence(p, beat(1000), beat(1001)) == [True, True],
    "R39 another link": lambda p: sequence(p, beat(1000), beat(900, link_id=4)) == [True, True],
    "R39 another system": lambda p: sequence(p, beat(1000), beat(900, sysid=9)) == [True, True],
    "R40 too old": lambda p: not Party(p, 1001 + MINUTE).takes(beat(1000)),
    "R40 a minute": lambda p: Party(p, 1000 + MINUTE).takes(beat(1000)),
    "R41 forged first packet": lambda p: not blocked(p),
    "R41 forged in a stream": lambda p: sequence(p, beat(1000), beat(MAX, OTHER), beat(1001))
    == [True, False, True],
    "R41 no replay window": lambda p: not reopened(p),
    "R41 no stream by forging": lambda p: not opened_by(p, beat(1000, OTHER)),
    "R41 no stream by a bad checksum": lambda p: not opened_by(p, flipped(beat(1000), -15)),
    "R43 unsigned": lambda p: not Party(p).takes(heartbeat()),
    "R43 let pass": lambda p: allowing(p).takes(heartbeat()),
    "R44 version 1": lambda p: not Party(p).takes(heartbeat(v1=True)),
    "R44 version 1 let pass": lambda p: allowing(p).takes(heartbeat(v1=True)),
    "R45 callback says no": lambda p: not allowing(p, False).takes(heartbeat()),
    "R45 callback says nothing": lambda p: not allowing(p, None).takes(heartbeat()),
    "R45 callback fails": lambda p: not raising(p).takes(heartbeat()),
    "R46 not by default": lambda p: not Party(p).takes(frame(109, bytes(9))),
    "R47 let pass, not signed": lambda p: not allowing(p).message(heartbeat()).get_signed(),
    "R47 good, signed": lambda p: Party(p).message(beat(1000)).get_signed(),
    "R48 unknown id unsigned": lambda p: not Party(p).takes(frame(UNKNOWN, b"x", crc_extra=77)),
    "R48 unknown id badly signed": lambda p: not Party(p).takes(unknown_signed(OTHER)),
    "R48 unknown id well signed": lambda p: Party(p).takes(unknown_signed(KEY)),
    "R50 without a key": lambda p: keyless(p, beat(1000)).get_type() == "HEARTBEAT",
    "R50 not verified": lambda p: not keyless(p, beat(1000)).get_signed(),
    "R31 no key of 0 bytes": lambda p: refuses_key(p, 0),
    "R31 no key of 5 bytes": lambda p: refuses_key(p, 5),
    "R31 no key of 33 bytes": lambda p: refuses_key(p, 33),
}  # fmt: skip


def rises(party: Party) -> bool:
    stamps = [party.sent_timestamp() for _ in range(5)]
    return stamps == sorted(set(stamps))


def wraps(package: str) -> bool:
    """Whether the sender begins again at 0 after a peer used the last timestamp."""
    party = Party(package, 1000)
    party.takes(beat(MAX))
    try:
        first = party.sent_timestamp()
        return party.sent_timestamp() <= first
    except Exception:
        return False


def follows(package: str) -> bool:
    party = Party(package)
    party.takes(beat(1000))
    return bool(party.mav.signing.timestamp >= 1000)


def stays(package: str) -> bool:
    party = Party(package, 5000)
    party.takes(beat(1000))
    return bool(party.mav.signing.timestamp == 5000)


def opened_by(package: str, data: bytes) -> bool:
    party = Party(package)
    party.takes(data)
    return bool(streams(party))


def holds(case: Callable[[str], bool], package: str) -> bool:
    try:
        return bool(case(package))
    except Exception:
        return False


def cases(package: str, short: bool) -> dict[str, Any]:
    """How many of what must hold does not."""
    failed = [name for name, case in CASES.items() if not holds(case, package)]
    return {f"of {len(CASES)} must-cases, failed": len(failed)}


def attacks(package: str, short: bool) -> dict[str, Any]:
    """What someone without the key achieves."""

    def answer(achieved: bool) -> str:
        return "yes" if achieved else "no"

    return {
        "one forged packet blocks a stream": answer(blocked(package)),
        "it reopens the replay window": answer(reopened(package)),
        "an unknown id passes unsigned": answer(not CASES["R48 unknown id unsigned"](package)),
    }
