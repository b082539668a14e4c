"""One measurement of benches/bridge.py, in a process of its own; prints what it found as JSON."""

from __future__ import annotations

import json
import socket
import subprocess
import sys
import time
from typing import Any

from mavwire import Bridge
from mavwire.dialects.v20 import ardupilotmega as mavlink

# The sender wakes up this often: a burst is what is due meanwhile.
PAUSE = 0.0002
PACKET = 36


def frames(components: int) -> list[bytes]:
    """Frames of 36 bytes: each component in turn, at least 256 of them, sequence numbers in order."""
    turns = -(-256 // components)
    made = []
    for turn in range(turns):
        for n in range(components):
            mav = mavlink.MAVLink(None, 1 + n % 250, 1 + n // 250)
            mav.seq = turn % 256
            msg = mavlink.MAVLink_attitude_message(turn, 0.1, 0.2, 0.3, 0.4, 0.5, 0)
            made.append(bytes(msg.pack(mav)))
    assert {len(frame) for frame in made} == {PACKET}
    return made


def send(port: str, rate: str, components: str, seconds: str) -> None:
    """Send at an even rate: a whole number of frames each time it wakes up."""
    made, per_second = frames(int(components)), int(rate)
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


def forward(rate: str, outs: str, components: str, datagram: str, seconds: str) -> dict[str, Any]:
    sinks = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(int(outs))]
    # The same frames come round, and are no copies of each other.
    with Bridge(["udpin:127.0.0.1:0"]) as bridge:
        for sink in sinks:
            sink.bind(("127.0.0.1", 0))
            out = f"udpout:127.0.0.1:{sink.getsockname()[1]}"
            bridge.add(out, datagram_bytes=int(datagram))
        port = bridge.stats()["links"][0]["endpoint"].rpartition(":")[2]
        command = [sys.executable, __file__, "send", port, rate, components, seconds]
        began = time.process_time()
        sender = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True)
        answer = json.loads(sender.stdout)
        last = -1
        while (now := counts(bridge)[0]) != last:  # until nothing comes any more
            last = now
            time.sleep(0.2)
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


if __name__ == "__main__":
    what, *arguments = sys.argv[1:]
    if what == "send":
        send(*arguments)
    else:
        print(json.dumps(forward(*arguments)), flush=True)
