"""`make bench-bridge`: forwarding through a bridge.

One process sends 36-byte frames, or a vehicle's mix, over UDP on this machine, another one runs a bridge with that link in
and one or more out. Printed are the frames that did not go through and the CPU time of the bridge for
each frame that came in, user and system; the time of the sender is not in it. Nobody reads at the
other ends, which costs the bridge the same and the machine less.

`--soak 600` forwards for ten minutes at `--rate` and prints loss, memory and latency each minute.
`--peers` compares `mavwire bridge` with mavlink-router and mavp2p, as far as they are in PATH, and a loop over pymavlink:
evenly spaced frames and bursts, several links, a slow serial link beside a fast one. Printed are medians of losses, CPU
time of a frame, added latency and memory (see `python/router_worker.py`).
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from typing import Any

WORKER = Path(__file__).parent / "python" / "bridge_worker.py"
# Goal G12 of docs/benchmarks.md.
MUST = "8 us a frame, lossless at 60,000 frames/s; aim: 5 us, 100,000"
# Rate, links out, components that send frames of one length or `MIX` for those of a vehicle, longest datagram (0: one
# frame in each).
MIX = "mix"
Case = tuple[int, int, int | str, int]
CASES: tuple[Case, ...] = (
    (1_000, 1, 1, 280),
    (10_000, 1, 1, 280),
    (60_000, 1, 1, 280),
    (100_000, 1, 1, 280),
    (20_000, 1, 10, 280),
    (20_000, 1, 1_000, 280),
    (20_000, 10, 10, 280),
    (20_000, 1, 10, 0),
    (20_000, 10, 10, 0),
    (20_000, 1, MIX, 280),
    (20_000, 10, MIX, 280),
    (20_000, 1, MIX, 0),
    (20_000, 10, MIX, 0),
)

ROUTER_WORKER = WORKER.with_name("router_worker.py")
PYTHON = [sys.executable, str(ROUTER_WORKER)]
# mavlink-router needs a file, and no TCP server on a port that may be taken.
MAIN_CONF = "[General]\nTcpServerPort=0\n"
# Routers, and how they are told their ends: a word with IN, OUT or TTY comes once for each end of that kind. The last
# two stand for no packing and no router.
PEERS = {
    "mavwire": [sys.executable, "-m", "mavwire", "bridge", "udpin:127.0.0.1:IN", "udpout:127.0.0.1:OUT", "serial:TTY:57600"],
    "mavwire, unpacked": [*PYTHON, "forward_unpacked", "udpin:127.0.0.1:IN", "udpout:127.0.0.1:OUT", "serial:TTY:57600"],
    "mavlink-routerd": ["mavlink-routerd", "-c", "CONF", "-e127.0.0.1:OUT", "127.0.0.1:IN", "TTY:57600"],
    "mavp2p": ["mavp2p", "--hb-disable", "udps:127.0.0.1:IN", "udpc:127.0.0.1:OUT", "serial:TTY:57600"],
    "pymavlink loop": [*PYTHON, "forward_with_pymavlink", "udpin:127.0.0.1:IN", "udpout:127.0.0.1:OUT"],
}  # fmt: skip
# Frames a second, seconds between bursts (0: evenly spaced), links in, links out, a serial link beside them.
Shape = tuple[int, float, int, int, int]
SHAPES: tuple[Shape, ...] = (
    (1_000, 0, 1, 1, 0),
    (20_000, 0, 1, 1, 0),
    (50_000, 0, 1, 1, 0),
    (20_000, 0.001, 1, 1, 0),
    (50_000, 0.001, 1, 1, 0),
    (100_000, 0.001, 1, 1, 0),
    (20_000, 0, 1, 10, 0),
    (20_000, 0, 10, 1, 0),
    (20_000, 0, 1, 1, 1),
)
COLUMNS = ("lost", "micros", "p50", "p99", "mb")
# The pymavlink loop takes no more than a few thousand frames a second, from one link.
PYMAVLINK_SHAPES = SHAPES[:1]


def compare(seconds: float, runs: int) -> None:
    """The table of routers: in each run they come in turns, row by row."""
    found: dict[tuple[Shape, str], list[dict[str, float]]] = {}
    missing = [name for name, command in PEERS.items() if shutil.which(command[0]) is None]
    with TemporaryDirectory() as directory:
        conf = Path(directory) / "main.conf"
        conf.write_text(MAIN_CONF)
        for _ in range(runs):
            for shape in SHAPES:
                for name, command in PEERS.items():
                    if name in missing or (
                        name == "pymavlink loop" and shape not in PYMAVLINK_SHAPES
                    ):
                        continue
                    words = [word.replace("CONF", str(conf)) for word in command]
                    rate, gap, *ends = shape
                    worker = [*PYTHON, "measure", *map(str, (rate, seconds, gap, *ends)), *words]
                    done = subprocess.run(worker, capture_output=True, text=True, check=False)
                    if done.returncode:
                        print(f"{name}, {rate:,}: {done.stderr.strip()[-200:]}", file=sys.stderr)
                    else:
                        found.setdefault((shape, name), []).append(json.loads(done.stdout))
    print("| frames/s | senders | in, out | router | lost | us CPU | p50 us | p99 us | MB |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    for ((rate, gap, ins, outs, serial), name), rows in found.items():
        cells = [f"{median(row[column] for row in rows):,.1f}" for column in COLUMNS]
        links = f"{ins}, {outs}{' and serial' if serial else ''}"
        senders = f"bursts, {1_000 * gap:g} ms" if gap else "even"
        print(f"| {rate:,} | {senders} | {links} | {name} | {' | '.join(cells)} |")
    for name in missing:
        print(f"{name} is not in PATH", file=sys.stderr)


def measure(case: Case, seconds: float) -> dict[str, Any]:
    """The findings of a measuring process."""
    numbers = map(str, (*case, seconds))
    command = [sys.executable, str(WORKER), "forward", *numbers]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    answer: dict[str, Any] = json.loads(done.stdout)
    return answer


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=5.0)
    parser.add_argument("--runs", type=int, default=3, help="the median of so many")
    parser.add_argument("--rate", type=int, default=50_000, help="frames a second of the soak")
    parser.add_argument("--soak", type=float, metavar="SECONDS")
    parser.add_argument("--interval", type=float, default=60.0, help="of the lines of a soak")
    parser.add_argument("--peers", action="store_true", help="compare with other routers")
    parser.add_argument("--json", metavar="FILE")
    args = parser.parse_args()
    if args.soak:
        command = [
            sys.executable,
            str(WORKER),
            "soak",
            *map(str, (args.rate, args.soak, args.interval)),
        ]
        return subprocess.run(command, check=False).returncode
    if args.peers:
        compare(args.seconds, args.runs)
        return 0
    print(f"goal: {MUST}\n")
    print(
        f"{'rate/s':>9}{'out':>5}{'components':>12}{'datagram':>10}{'sent':>10}{'lost':>9}{'us CPU':>9}"
    )
    rows = []
    for case in CASES:
        rate, outs, components, datagram = case
        found = [measure(case, args.seconds) for _ in range(args.runs)]
        found.sort(key=lambda one: one["micros"])
        middle = found[len(found) // 2]
        lost = sum(one["lost"] for one in found)
        rows.append({"case": case, "runs": found})
        print(
            f"{rate:>9,}{outs:>5}{components:>12}{datagram:>10,}{middle['sent']:>10,}{lost:>9,}"
            f"{middle['micros']:>9.2f}",
            flush=True,
        )
    if args.json:
        found_all = {"time": time.time(), "processors": os.cpu_count(), "rows": rows}
        Path(args.json).write_text(json.dumps(found_all, indent=1))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
