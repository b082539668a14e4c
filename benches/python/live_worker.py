"""One measurement of benches/live.py, in a process of its own; prints what it found as JSON."""

from __future__ import annotations

import importlib
import json
import os
import queue
import socket
import subprocess
import sys
import threading
import time
from contextlib import suppress
from typing import Any

# The sender wakes up this often: a burst is what arrived meanwhile.
PAUSE = 0.0002
# A stream is over when nothing came for so long.
SILENCE = 1.5
PACKET = 36
# How often each of many links gets a datagram.
ROUNDS = 20


def frames(package: str) -> list[bytes]:
    """256 frames of 36 bytes, one for each sequence number: ATTITUDE with a last field of zero."""
    root = package.partition(".")[0]
    mavlink = importlib.import_module(f"{root}.dialects.v20.ardupilotmega")
    mav = mavlink.MAVLink(None, 1, 1)
    made = []
    for seq in range(256):
        mav.seq = seq
        made.append(mavlink.MAVLink_attitude_message(seq, 0.1, 0.2, 0.3, 0.4, 0.5, 0).pack(mav))
    assert {len(frame) for frame in made} == {PACKET}
    return made


def connect(package: str, kind: str) -> tuple[Any, int]:
    """A link that listens on a free port, and the port."""
    kinds = {"udpin": socket.SOCK_DGRAM, "tcpin": socket.SOCK_STREAM}
    with socket.socket(socket.AF_INET, kinds[kind]) as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    mavutil = importlib.import_module(f"{package.partition('.')[0]}.mavutil")
    return mavutil.mavlink_connection(f"{kind}:127.0.0.1:{port}"), port


def send(package: str, kind: str, port: str, rate: str, seconds: str) -> None:
    """Send at an even rate: a whole number of packets each time it wakes up."""
    made = frames(package)
    is_udp = kind == "udpin"
    sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM if is_udp else socket.SOCK_STREAM)
    sock.connect(("127.0.0.1", int(port)))
    wanted, sent, start = int(int(rate) * float(seconds)), 0, time.perf_counter()
    while sent < wanted:
        due = min(wanted, int((time.perf_counter() - start) * int(rate)) + 1)
        if is_udp:
            for n in range(sent, due):
                sock.send(made[n & 255])
        elif due > sent:
            sock.sendall(b"".join(made[n & 255] for n in range(sent, due)))
        sent = due
        time.sleep(PAUSE)
    print(json.dumps({"sent": sent, "seconds": time.perf_counter() - start}))


def start_sender(package: str, kind: str, port: int, rate: str, seconds: str) -> Any:
    command = [sys.executable, __file__, "send", package, kind, str(port), rate, seconds]
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True)


def receive(package: str, kind: str, rate: str, seconds: str) -> dict[str, Any]:
    if package.endswith(".aio"):
        return receive_aio(package, kind, rate, seconds)
    link, port = connect(package, kind)
    sender = start_sender(package, kind, port, rate, seconds)
    assert link.recv_match(blocking=True, timeout=20) is not None
    received, began = 1, time.process_time()
    while link.recv_match(blocking=True, timeout=SILENCE) is not None:
        received += 1
    cpu = time.process_time() - began
    sent = json.loads(sender.communicate()[0])["sent"]
    return {"received": received, "lost": sent - received, "cpu": cpu}


def receive_aio(package: str, kind: str, rate: str, seconds: str) -> dict[str, Any]:
    """The same with `async for` in an asyncio loop."""
    import asyncio

    aio = importlib.import_module(package)

    async def main() -> tuple[int, int, float]:
        sync, port = connect(package, kind)
        async with aio.Link(sync) as link:
            sender = start_sender(package, kind, port, rate, seconds)
            stream, received, began = link.stream(), 0, 0.0
            with suppress(TimeoutError):
                async with asyncio.timeout(20) as silence:
                    async for _ in stream:
                        if received == 0:
                            began = time.process_time()
                            when = asyncio.get_running_loop().time() + float(seconds) + SILENCE
                            silence.reschedule(when)
                        received += 1
            cpu = time.process_time() - began
            return received, json.loads(sender.communicate()[0])["sent"], cpu

    received, sent, cpu = asyncio.run(main())
    return {"received": received, "lost": sent - received, "cpu": cpu}


def soak(package: str, rate: str, seconds: str) -> None:
    """Receive for long, and tell about loss and memory each minute."""
    link, port = connect(package, "udpin")
    sender = start_sender(package, "udpin", port, rate, seconds)
    received, report, began = 0, time.monotonic() + 10, time.process_time()
    while link.recv_match(blocking=True, timeout=20 if received == 0 else SILENCE) is not None:
        received += 1
        if time.monotonic() > report:
            report += 60
            print(f"{received:,} received, {link.mav_loss} lost, {resident():,} kB", flush=True)
    cpu = time.process_time() - began
    answer = json.loads(sender.communicate()[0])
    print(
        f"{received:,} of {answer['sent']:,} received in {answer['seconds']:.0f} s, "
        f"{1e6 * cpu / received:.2f} us CPU each, {resident():,} kB"
    )


def resident() -> int:
    """Resident memory in kB, where the system tells."""
    try:
        with open("/proc/self/statm") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") // 1024
    except OSError:
        return 0


def idle(package: str, links: str) -> dict[str, Any]:
    """The share of a processor that threads take which wait on links, or tasks."""
    if package.endswith(".aio"):
        return idle_aio(package, links)
    waiting = [connect(package, "udpin")[0] for _ in range(int(links))]
    for link in waiting:
        threading.Thread(target=link.recv_match, kwargs={"blocking": True}, daemon=True).start()
    time.sleep(0.5)
    seconds, began, cpu = 3.0, time.perf_counter(), time.process_time()
    time.sleep(seconds)
    return {"share": (time.process_time() - cpu) / (time.perf_counter() - began)}


def responsive(package: str, links: str) -> dict[str, Any]:
    """Seconds from a datagram to its message in hand, the usual and the longest, while many links wait
    in one process, each in a thread or a task of its own. The datagrams go to one after another.
    """
    waiting = [connect(package, "udpin") for _ in range(int(links))]
    arrived: queue.SimpleQueue[float] = queue.SimpleQueue()
    receive_all = receive_in_tasks if package.endswith(".aio") else receive_in_threads
    receive_all(package, [link for link, _ in waiting], arrived)
    time.sleep(0.5)
    frame, took = frames(package)[0], []
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        for n in range(ROUNDS * len(waiting)):
            time.sleep(PAUSE)
            sent = time.perf_counter()
            sock.sendto(frame, ("127.0.0.1", waiting[n % len(waiting)][1]))
            took.append(arrived.get(timeout=20) - sent)
    return {"median": sorted(took)[len(took) // 2], "longest": max(took)}


def receive_in_threads(package: str, links: list[Any], arrived: queue.SimpleQueue[float]) -> None:
    def receive(link: Any) -> None:
        while link.recv_match(blocking=True) is not None:
            arrived.put(time.perf_counter())

    for link in links:
        threading.Thread(target=receive, args=[link], daemon=True).start()


def receive_in_tasks(package: str, links: list[Any], arrived: queue.SimpleQueue[float]) -> None:
    import asyncio

    aio = importlib.import_module(package)

    async def receive(link: Any) -> None:
        async for _ in aio.Link(link):
            arrived.put(time.perf_counter())

    async def main() -> None:
        await asyncio.gather(*map(receive, links))

    threading.Thread(target=lambda: asyncio.run(main()), daemon=True).start()


def idle_aio(package: str, links: str) -> dict[str, Any]:
    import asyncio

    aio = importlib.import_module(package)

    async def main() -> float:
        waiting = [aio.Link(connect(package, "udpin")[0]) for _ in range(int(links))]
        tasks = [asyncio.create_task(link.recv_msg()) for link in waiting]
        await asyncio.sleep(0.5)
        began, cpu = time.perf_counter(), time.process_time()
        await asyncio.sleep(3.0)
        share = (time.process_time() - cpu) / (time.perf_counter() - began)
        for task in tasks:
            task.cancel()
        return share

    return {"share": asyncio.run(main())}


def main(what: str, *arguments: str) -> None:
    if what in ("send", "soak"):
        globals()[what](*arguments)
    else:
        print(json.dumps(globals()[what](*arguments)), flush=True)
        os._exit(0)  # threads may still be waiting


if __name__ == "__main__":
    main(*sys.argv[1:])
