"""`make bench-live`: receiving from live links, mavwire beside pymavlink.

For each rate one process sends 36-byte frames to another on this machine, which receives them with
`recv_match(blocking=True)`, or with `async for` from mavwire.aio. Printed are the packets that were
lost, the CPU time of the receiver for each packet, user and system, and how many times that pymavlink
takes; the time of the sender is not in it. Then the CPU time of 100 links on which nothing arrives, how
soon one of them has a message in hand, and how soon Ctrl-C ends a blocking receive on each transport;
`--waiting` prints these alone.

`--soak 600` receives for ten minutes at `--rate` and prints loss and memory each minute.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

PACKAGES = ("mavwire", "mavwire.aio", "pymavlink")
KINDS = ("udpin", "tcpin")
WORKER = Path(__file__).parent / "python" / "live_worker.py"
INTERRUPT = WORKER.with_name("interrupt_worker.py")
TRANSPORTS = ("udpin", "udpout", "udpbcast", "mcast", "tcp", "tcpin", "reconnecting", "uds", "ws",
              "wsserver", "serial", "exec")  # fmt: skip
LINKS = "100"
# Goal G12 of docs/benchmarks.md.
MUST = "8 us a packet, lossless at 50,000 packets/s; aim: 4.5 us, 100,000"


def worker(*arguments: str, script: Path = WORKER) -> dict[str, Any]:
    """The findings of a measuring process."""
    env = {**os.environ, "MAVLINK20": "1", "MAVLINK_DIALECT": "ardupilotmega"}
    command = [sys.executable, str(script), *arguments]
    done = subprocess.run(command, env=env, capture_output=True, text=True, check=False)
    if done.returncode:
        return {"failed": done.stderr.strip().splitlines()[-1] if done.stderr else "no answer"}
    answer: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return answer


def rates(args: argparse.Namespace) -> list[dict[str, Any]]:
    """The table of rates."""
    print(f"{'link':<8}{'rate/s':>9}  {'package':<12}{'received':>10}{'lost':>9}{'us CPU':>9}"
          f"{'pymavlink':>12}")  # fmt: skip
    rows = []
    for kind in KINDS:
        for rate in args.rates:
            group = []
            for package in args.packages:
                found = worker("receive", package, kind, str(rate), str(args.seconds))
                group.append(found | {"kind": kind, "rate": rate, "package": package})
            for line in rate_lines(group):
                print(line)
            rows += group
    return rows


def micros(found: dict[str, Any]) -> float:
    """CPU time for a packet; infinite where none came."""
    return 1e6 * found["cpu"] / found["received"] if found.get("received") else math.inf


def rate_lines(group: list[dict[str, Any]]) -> list[str]:
    """The lines of one link and rate: the last column is pymavlink's time as a multiple of each."""
    theirs = [micros(found) for found in group if found["package"] == "pymavlink"]
    lines = []
    for found in group:
        line = f"{found['kind']:<8}{found['rate']:>9,}  {found['package']:<12}"
        if "failed" in found:
            lines.append(f"{line}  {found['failed']}")
            continue
        own = micros(found)
        line += f"{found['received']:>10,}{found['lost']:>9,}{own:>9.2f}"
        if theirs and math.isfinite(theirs[0]) and math.isfinite(own):
            line += f"{theirs[0] / own:>10.1f} x"
        lines.append(line)
    return lines


def waiting(package: str) -> dict[str, Any]:
    """The cost of links that wait, and the time until they wake up."""
    idle = worker("idle", package, LINKS)
    awake = worker("responsive", package, LINKS)
    print(f"\n{package}: {LINKS} idle links take {100 * idle['share']:.2f}% of a processor;")
    usual, longest = 1e3 * awake["median"], 1e3 * awake["longest"]
    print(f"    a message to one of them is there after {usual:.2f} ms, {longest:.0f} ms at most")
    return {"package": package, "idle": idle, "responsive": awake}


def interrupts(packages: list[str]) -> list[dict[str, Any]]:
    """The table of Ctrl-C."""
    print("\nms from Ctrl-C to the end of a blocking receive, the longest of ten")
    print(f"{'link':<14}", *[f"{package:>12}" for package in packages])
    rows = []
    for kind in TRANSPORTS:
        shown = []
        for package in packages:
            found = worker(package, kind, script=INTERRUPT)
            rows.append({"package": package, "kind": kind, "interrupt": found})
            shown.append("-" if "failed" in found else f"{1e3 * found['seconds']:.1f}")
        print(f"{kind:<14}", *[f"{text:>12}" for text in shown])
    return rows


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rates", type=lambda s: [int(n) for n in s.split(",")],
                        default=[1_000, 10_000, 20_000, 50_000, 100_000])  # fmt: skip
    parser.add_argument("--seconds", type=float, default=3.0)
    parser.add_argument("--packages", type=lambda s: s.split(","), default=list(PACKAGES))
    parser.add_argument("--rate", type=int, default=80_000, help="packets a second of the soak")
    parser.add_argument("--soak", type=float, metavar="SECONDS")
    parser.add_argument("--waiting", action="store_true", help="leave out the table of rates")
    parser.add_argument("--json", metavar="FILE")
    args = parser.parse_args()
    if args.soak:
        command = [sys.executable, str(WORKER), "soak", "mavwire", str(args.rate), str(args.soak)]
        return subprocess.run(command, env={**os.environ, "MAVLINK20": "1"}, check=False).returncode
    rows = []
    if not args.waiting:
        print(f"goal: {MUST}\n")
        rows = rates(args)
    rows += [waiting(package) for package in args.packages]
    rows += interrupts(args.packages)
    if args.json:
        found = {"time": time.time(), "processors": os.cpu_count(), "rows": rows}
        Path(args.json).write_text(json.dumps(found, indent=1))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
