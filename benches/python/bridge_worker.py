"""One measurement of benches/bridge.py, in a process of its own; prints what it found as JSON."""

from __future__ import annotations

import json
import socket
import subprocess
import sys
import time
from contextlib import suppress
from itertools import islice
from typing import Any

from live_worker import resident
from mavwire import Bridge, traffic
from mavwire.dialects.v20 import ardupilotmega as mavlink

# The sender wakes up this often: a burst is what is due meanwhile.
PAUSE = 0.0002
PACKET = 36
# The vehicle of the mix, and where a frame says who sent it.
VEHICLE, SYSID_AT = 1, 5


def frames(components: str) -> list[bytes]:
    """Frames of 36 bytes: each component in turn, at least 256 of them, sequence numbers in order. Or `mix`: those of
    a vehicle in the air, 35 bytes in the mean. Its station's are left out: they are for the vehicle, which is heard on
    the link that they come over, so none is forwarded."""
    if components == "mix":
        every = (frame for _, frame in traffic.frames(traffic.Options()))
        return list(islice((frame for frame in every if frame[SYSID_AT] == VEHICLE), 5_000))
    count = int(components)
    made = []
    for turn in range(-(-256 // count)):
        for n in range(count):
            mav = mavlink.MAVLink(None, 1 + n % 250, 1 + n // 250)
            mav.seq = turn % 256
            msg = mavlink.MAVLink_attitude_message(turn, 0.1, 0.2, 0.3, 0.4, 0.5, 0)
            made.append(bytes(msg.pack(mav)))
    assert {len(frame) for frame in made} == {PACKET}
    return made


def send(port: str, rate: str, components: str, seconds: str) -> None:
    """Send at an even rate: a whole number of frames each time it wakes up."""
    made, per_second = frames(components), int(rate)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.connect(("127.0.0.1", int(port)))
        wanted, sent, start = int(per_second * float(seconds)), 0, time.perf_counter()
        while sent < wanted:
            due = min(wanted, int((time.perf_counter() - start) * per_second) + 1)
            for n in range(sent, due):
                sock.send(made[n % len(made)])
            sent = due
            time.sleep(PAUSE)
    print(json.dumps({"sent": sent, "seconds": time.perf_counter() - start}))


def counts(bridge: Bridge) -> tuple[int, int, int]:
    """Frames received, frames sent, and frames dropped."""
    links = bridge.stats()["links"]
    totals = [sum(one[key] for one in links) for key in ("received", "sent", "dropped")]
    return totals[0], totals[1], totals[2]


def start_sender(port: str, rate: str, components: str, seconds: str) -> subprocess.Popen[str]:
    command = [sys.executable, __file__, "send", port, rate, components, seconds]
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True)


def forward(rate: str, outs: str, components: str, datagram: str, seconds: str) -> dict[str, Any]:
    sinks = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(int(outs))]
    # The same frames come round, and are no copies of each other.
    with Bridge(["udpin:127.0.0.1:0"]) as bridge:
        for sink in sinks:
            sink.bind(("127.0.0.1", 0))
            out = f"udpout:127.0.0.1:{sink.getsockname()[1]}"
            bridge.add(out, datagram_bytes=int(datagram))
        port = bridge.stats()["links"][0]["endpoint"].rpartition(":")[2]
        began = time.process_time()
        answer = json.loads(start_sender(port, rate, components, seconds).communicate()[0])
        settle(bridge)
        cpu = time.process_time() - began
        received, sent, _ = counts(bridge)
    for sink in sinks:
        sink.close()
    lost = answer["sent"] - sent // len(sinks)
    return {
        "sent": answer["sent"],
        "seconds": answer["seconds"],
        "received": received,
        "lost": lost,
        "cpu": cpu,
        "micros": 1e6 * cpu / max(received, 1),
    }


def settle(bridge: Bridge) -> None:
    """Wait until nothing comes any more."""
    last = -1
    while (now := counts(bridge)[0]) != last:
        last = now
        time.sleep(0.2)


def soak(rate: str, seconds: str, interval: str) -> None:
    """Forward for long; each minute, or other interval, what was lost so far, memory and latency."""
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sink,
        Bridge(["udpin:127.0.0.1:0"]) as bridge,
    ):
        sink.bind(("127.0.0.1", 0))
        out = bridge.add(f"udpout:127.0.0.1:{sink.getsockname()[1]}")
        port = bridge.stats()["links"][0]["endpoint"].rpartition(":")[2]
        sender, began = start_sender(port, rate, "1", seconds), time.process_time()
        while sender.poll() is None:
            with_timeout(sender, float(interval))
            print(soak_line(bridge, out), flush=True)
        answer = json.loads(sender.communicate()[0])
        settle(bridge)
        cpu, (received, sent, _) = time.process_time() - began, counts(bridge)
        print(
            f"{sent:,} of {answer['sent']:,} forwarded in {answer['seconds']:.0f} s, "
            f"{answer['sent'] - sent:,} lost, {1e6 * cpu / max(received, 1):.2f} us CPU each\n"
            f"{soak_line(bridge, out)}",
            flush=True,
        )


def with_timeout(process: subprocess.Popen[str], seconds: float) -> None:
    with suppress(subprocess.TimeoutExpired):
        process.wait(seconds)


def soak_line(bridge: Bridge, out: str) -> str:
    """The state of a soak: the numbers are those since its start."""
    stats = bridge.stats()
    link = next(one for one in stats["links"] if one["name"] == out)
    missing = sum(one["lost"] for one in stats["components"])
    overrun = sum(one["overrun"] or 0 for one in stats["links"])
    late = ", ".join(
        f"{name} {1e6 * (seconds or 0):,.0f} us" for name, seconds in link["latency"].items()
    )
    return (
        f"{stats['uptime']:>6.0f} s: {link['sent']:>12,} forwarded, {missing:,} missing, {overrun:,} overrun, "
        f"{link['dropped']:,} dropped, {resident():,} kB, latency {late}"
    )


if __name__ == "__main__":
    what, *arguments = sys.argv[1:]
    if what in ("send", "soak"):
        globals()[what](*arguments)
    else:
        print(json.dumps(forward(*arguments)), flush=True)
