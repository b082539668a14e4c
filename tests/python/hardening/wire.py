"""Garbage and damage in a stream."""

from __future__ import annotations

import math
import time
from random import Random
from typing import Any

from encoder import attitude, frame, heartbeat

from hardening.tools import good, memory, parse, parser_of

POLICIES = {"mavwire": ("skip", "rescan"), "pymavlink": ("skip",)}
MINIMAL = bytes([0xFE, 0, 0, 0, 0, 0, 0, 0])


def patterns(size: int) -> dict[str, bytes]:
    return {
        "all 0xFD": b"\xfd" * size,
        "all 0xFE": b"\xfe" * size,
        "random": Random(1).randbytes(size),
        "zeros": bytes(size),
        "minimal headers": MINIMAL * (size // len(MINIMAL)),
    }


def seconds_to_parse(package: str, resync: str, data: bytes) -> float:
    """CPU time."""
    mav = parser_of(package, resync)
    before = time.process_time()
    for _ in parse(mav, data):
        pass
    return max(time.process_time() - before, 1e-6)


def garbage(package: str, short: bool) -> dict[str, Any]:
    """Megabytes for each second of CPU time, under each policy that the package has."""
    size = (4 << 20 if package == "mavwire" else 1 << 18) // (8 if short else 1)
    return {
        f"{name}, {resync}": round(size / 1e6 / seconds_to_parse(package, resync, data), 1)
        for resync in POLICIES[package]
        for name, data in patterns(size).items()
    }


def growth(package: str, short: bool) -> dict[str, Any]:
    """By which power of its size input takes longer: the worst pattern."""
    # Large enough that nothing stays in the caches of the processor.
    size = (1 << 22 if package == "mavwire" else 1 << 16) // (4 if short else 1)
    worst = 0.0
    for resync in POLICIES[package]:
        small, large = patterns(size), patterns(8 * size)
        for name in small:
            # In turns, so that a slow minute is slow for both.
            pairs = [
                [seconds_to_parse(package, resync, one[name]) for one in (small, large)]
                for _ in range(4)
            ]
            times = [min(column) for column in zip(*pairs, strict=True)]
            worst = max(worst, math.log(times[1] / times[0], 8))
    return {"exponent": round(worst, 2)}


def telemetry(count: int) -> list[bytes]:
    rand = Random(1)
    frames = []
    for seq in range(count):
        angles = [rand.gauss(0, 1) for _ in range(6)]
        if seq % 4 == 0:
            frames.append(heartbeat(seq))
        else:
            frames.append(frame(30, attitude(seq, *angles), seq % 256))
    return frames


def lossy(frames: list[bytes]) -> tuple[bytes, int]:
    """1% of the bytes are lost; how many frames lost none."""
    rand, kept, intact = Random(2), [], 0
    for one in frames:
        left = bytes(byte for byte in one if rand.random() >= 0.01)
        kept.append(left)
        intact += len(left) == len(one)
    return b"".join(kept), intact


def found(package: str, stream: bytes) -> int:
    """Frames of known messages, by the policy that looks everywhere."""
    mav = parser_of(package, "rescan")
    return sum(msg.get_msgId() >= 0 for msg in parse(mav, stream, 1000))


def kept(package: str, short: bool) -> dict[str, Any]:
    """Good frames of damaged streams."""
    beats = [heartbeat(seq) for seq in range(1000)]
    stream, intact = lossy(telemetry(13_330))
    false_headers = b"".join(b"\xfd\xff\x01" + beat for beat in beats)
    return {
        "of 100 after one stray 0xFD": found(package, b"\xfd" + b"".join(beats[:100])),
        "of 1,000 with FD FF 01 before each": found(package, false_headers),
        # More than there are would be as wrong.
        f"intact frames lost of {intact:,} at 1% byte loss": abs(intact - found(package, stream)),
    }


def unaligned(package: str, short: bool) -> dict[str, Any]:
    """Kilobytes that a parser keeps after 8 MB that never end with a frame."""
    return {f"kB, {resync}": kept_of_unaligned(package, resync) for resync in POLICIES[package]}


def kept_of_unaligned(package: str, resync: str) -> int | str:
    mav = parser_of(package, resync)
    stream = heartbeat() * 2000
    chunk = stream[5:] + stream[:5]

    def megabytes(count: int) -> bool:
        """Whether each chunk gave the messages that end in it."""
        came = chunks = 0
        while chunks * len(chunk) < count * 1_000_000:
            came += good(mav.parse_buffer(bytearray(chunk)) or [])
            chunks += 1
        return came == 2000 * chunks

    mav.parse_buffer(bytearray(stream[:5]))
    is_read = megabytes(1)
    before = memory()
    is_read &= megabytes(8)
    return max(memory() - before, 0) // 1000 if is_read else "the messages do not come"
