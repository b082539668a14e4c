"""Send the frames of a telemetry log as they were received, at their pace or faster.

examples:
  mavwire replay flight.tlog                          to 127.0.0.1:14550
  mavwire replay flight.tlog --speed 10 --out tcpin:0.0.0.0:5760
"""

from __future__ import annotations

import sys
import time
from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

from mavwire.cli._errors import refused, tell
from mavwire.cli._foreign import warn_without_records
from mavwire.cli._values import factor, split
from mavwire.dialects import UPSTREAM

if TYPE_CHECKING:
    from mavwire.bridge import Bridge
    from mavwire.logs import TelemetryLog

DEFAULT_OUT = "udpout:127.0.0.1:14550"
# Bytes that may wait for a slow peer: some minutes of a radio's traffic.
QUEUE = 16 << 20
# Frames of this many seconds leave together; a gap in the log longer than the other is cut short.
STEP = 0.005
LONGEST_GAP = 10.0
# How long the last frames may take to leave.
LINGER = 10.0
BATCH_BYTES = 32 << 10


def add_arguments(parser: ArgumentParser) -> None:
    parser.add_argument("log", metavar="LOG", help="a telemetry log")
    parser.add_argument(
        "--out", metavar="ENDPOINT", action="append",
        help=f"where to, as for `mavwire bridge`; may be repeated [default: {DEFAULT_OUT}]",
    )  # fmt: skip
    parser.add_argument(
        "--speed", type=factor, default=1.0, metavar="X", help="times real time [default: 1]"
    )
    parser.add_argument("--types", metavar="LIST", help="only these messages: ATTITUDE,GPS_RAW_INT")


def main(args: Namespace) -> int:
    """Replay until the end of the log, or until interrupted."""
    from mavwire.bridge import Bridge, ConfigError

    types = split(args.types, "--types")
    bridge = Bridge(dedup=0)
    with refused(OSError, ValueError, RuntimeError), refused(ConfigError, exit_code=2):
        log = opened(args.log)
        frames = ((msg._timestamp, bytes(msg.get_msgbuf())) for msg in log.messages(types=types))
        for out in args.out or [DEFAULT_OUT]:
            # A sniffer gets all frames, also those to other systems and those that its own system sent.
            bridge.add(out, sniffer=True, read_only=True, queue_bytes=QUEUE)
        bridge.start()
    with bridge:
        wait_for_peers(bridge)
        count = replay(frames, bridge.send, args.speed)
        lost = drain(bridge)
    if not count:
        warn_without_records("replay", args.log, UPSTREAM)
    print(f"{count} frames" + (f", {lost} of them dropped" if lost else ""), file=sys.stderr)
    return 0


def opened(path: str) -> TelemetryLog:
    """The log; ValueError for what is none, and for one that has no record as far as can be told."""
    from mavwire.logs import LogFormatError, TelemetryLog
    from mavwire.logs.no_records import check_records

    try:
        log = TelemetryLog(path)
    except LogFormatError:
        check_records(path, UPSTREAM)  # in the words of other commands, where it was cut off
        raise
    if log.compressed:
        check_records(path, UPSTREAM)
    return log


def replay(
    frames: Iterable[tuple[float, bytes]],
    send: Callable[[bytes], Any],
    speed: float,
    clock: Callable[[], float] = time.monotonic,
    sleep: Callable[[float], Any] = time.sleep,
) -> int:
    """Hand frames to `send` at their times, `speed` times as fast; how many there were.

    Times that go back, as where logs were joined, and gaps of more than ten seconds make no pause.
    """
    count = 0
    last: float | None = None
    due = clock()
    waiting = bytearray()
    for stamp, frame in frames:
        gap = 0.0 if last is None else stamp - last
        last = stamp
        due += gap / speed if 0 <= gap <= LONGEST_GAP else 0.0
        ahead = due - clock()
        if waiting and (ahead > STEP or len(waiting) > BATCH_BYTES):
            send(bytes(waiting))
            waiting.clear()
        if ahead > STEP:
            sleep(ahead)
        waiting += frame
        count += 1
    if waiting:
        send(bytes(waiting))
    return count


def wait_for_peers(bridge: Bridge) -> None:
    """Wait until each link has someone at its other end."""
    told = False
    while waiting := alone(bridge.stats()):
        if not told:
            tell(f"waiting for {', '.join(waiting)}")
            told = True
        time.sleep(0.05)


def alone(stats: dict[str, Any]) -> list[str]:
    """The links without anyone at the other end, with the ports that they listen on."""
    links = stats["links"]
    up = {one["name"] for one in links if one["state"] == "up"}
    return [one["endpoint"] for one in links if one["name"] not in up and not one["peer"]]


def drain(bridge: Bridge) -> int:
    """Wait until everything has left; how many frames did not."""
    end = time.monotonic() + LINGER
    while True:
        links = bridge.stats()["links"]
        if not any(one["queued_bytes"] for one in links) or time.monotonic() > end:
            return sum(one["dropped"] for one in links)
        time.sleep(0.02)
