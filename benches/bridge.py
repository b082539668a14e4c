"""`make bench-bridge`: forwarding through a bridge.

One process sends 36-byte frames over UDP on this machine, another one runs a bridge with that link in
and one or more out. Printed are the frames that did not go through and the CPU time of the bridge for
each frame that came in, user and system; the time of the sender is not in it. Nobody reads at the
other ends, which costs the bridge the same and the machine less.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

WORKER = Path(__file__).parent / "python" / "bridge_worker.py"
# Goal G12 of docs/benchmarks.md.
MUST = "8 us a frame, lossless at 60,000 frames/s; aim: 5 us, 100,000"
# Rate, links out, components that send, longest datagram (0: one frame in each).
CASES = (
    (1_000, 1, 1, 0),
    (10_000, 1, 1, 0),
    (60_000, 1, 1, 0),
    (100_000, 1, 1, 0),
    (20_000, 1, 10, 0),
    (20_000, 1, 1_000, 0),
    (20_000, 10, 10, 0),
    (20_000, 1, 10, 1_400),
    (20_000, 10, 10, 1_400),
)


def measure(case: tuple[int, int, int, int], seconds: float) -> dict[str, Any]:
    """What a measuring process found."""
    numbers = map(str, (*case, seconds))
    command = [sys.executable, str(WORKER), "forward", *numbers]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    answer: dict[str, Any] = json.loads(done.stdout)
    return answer


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=5.0)
    parser.add_argument("--runs", type=int, default=3, help="the median of so many")
    parser.add_argument("--json", metavar="FILE")
    args = parser.parse_args()
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
            f"{rate:>9,}{outs:>5}{components:>12,}{datagram:>10,}{middle['sent']:>10,}{lost:>9,}"
            f"{middle['micros']:>9.2f}",
            flush=True,
        )
    if args.json:
        found_all = {"time": time.time(), "processors": os.cpu_count(), "rows": rows}
        Path(args.json).write_text(json.dumps(found_all, indent=1))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
