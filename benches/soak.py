"""`make soak`: what a ground station does, for as long as wanted, and nothing may be lost or grow.

    simulated flight -> UDP -> mavwire bridge -> UDP -> mavutil link that records -> logs -> decoded and compared

Each part is a process of its own; the flight is that of a simulated copter, over and over at `--rate` frames a second. A log
is closed at `--log-bytes`, decoded, compared frame by frame with what was sent, and removed. With `--hostile` garbage
comes to a port of the same bridge as fast as it can be sent, over UDP and over TCP connections that come and go, and the
flight must come through all the same.

Prints a line each `--interval`: frames, and memory, descriptors and processor time of bridge and receiver; `--json` keeps
them. Fails where a frame is missing, where a log differs, or where memory or descriptors grow.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from contextlib import ExitStack
from pathlib import Path
from typing import Any

WORKER = Path(__file__).parent / "python" / "soak_worker.py"
LINE = "{:>7} {:>13} {:>13} {:>11} {:>11} {:>9} {:>9} {:>11} {:>11}"
HEAD = (
    "s",
    "frames",
    "compared",
    "bridge kB",
    "link kB",
    "bridge fd",
    "link fd",
    "bridge CPU",
    "link CPU",
)
GROWTH = 4096
"""kB that the memory of a process may differ by between the first and the last third of a run."""
HOSTILE_PEERS = 64
"""Descriptors that hostile TCP connections may have more or less: those that a server of a bridge takes."""
WARM_UP = 0.1
"""Share of the samples in which buffers and pools still fill."""


def start(stack: ExitStack, *words: object, **options: Any) -> subprocess.Popen[str]:
    """A worker, which is gone when the stack ends."""
    command = [sys.executable, str(WORKER), *map(str, words)]
    process = subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, **options
    )
    stack.callback(process.wait)
    stack.callback(process.kill)
    return process


def told(process: subprocess.Popen[str]) -> Any:
    """The next line of a worker; SystemExit where there is none."""
    assert process.stdout is not None
    line = process.stdout.readline()
    if not line:
        raise SystemExit(f"a worker has ended with {process.wait()}")
    return json.loads(line)


def asked(process: subprocess.Popen[str], word: str = "sample") -> Any:
    """What a worker answers."""
    assert process.stdin is not None
    process.stdin.write(word + "\n")
    process.stdin.flush()
    return told(process)


def growth(samples: list[dict[str, Any]], key: str) -> float:
    """By how much the mean of the last third is above that of the first, behind the warm-up."""
    values = [one[key] for one in samples][int(len(samples) * WARM_UP) :]
    third = max(len(values) // 3, 1)
    return sum(values[-third:]) / third - sum(values[:third]) / third


def wrong(
    sent: int, end: dict[str, Any], samples: list[dict[str, Any]], descriptors: float = 0.5
) -> list[str]:
    """What was not as it must be."""
    found = []
    if end["received"] != sent or end["compared"] != sent:
        found.append(
            f"of {sent:,} frames {end['received']:,} came and {end['compared']:,} were in the logs"
        )
    if end["difference"] is not None:
        found.append(f"the logs differ from what was sent at frame {end['difference']:,}")
    for part in ("bridge", "link"):
        if (more := growth(samples, f"{part} kB")) > GROWTH:
            found.append(f"the memory of the {part} grew by {more:,.0f} kB")
        if (further := growth(samples, f"{part} fd")) > descriptors:
            found.append(f"the {part} has {further:.1f} more descriptors")
    return found


def sample(began: float, bridge: dict[str, Any], link: dict[str, Any]) -> dict[str, Any]:
    """A line of the table."""
    return {
        "s": round(time.monotonic() - began, 1),
        "frames": link["received"],
        "compared": link["compared"],
        **{f"{part} {key}": one[key] for part, one in (("bridge", bridge), ("link", link)) for key in ("kB", "fd", "CPU")},
        "garbage": bridge["garbage"],
    }  # fmt: skip


def run(args: argparse.Namespace, folder: str) -> int:
    """0 if all is well."""
    samples: list[dict[str, Any]] = []
    with ExitStack() as stack:
        link = start(stack, "link", folder, args.log_bytes)
        bridge = start(stack, "bridge", told(link)["port"])
        ports = told(bridge)
        sender = start(stack, "send", ports["honest"], args.rate, args.seconds)
        if args.hostile:
            start(stack, "attack", ports["hostile UDP"], ports["hostile TCP"])
        print(LINE.format(*HEAD))
        began = time.monotonic()
        while sender.poll() is None:
            try:
                sender.wait(args.interval)
            except subprocess.TimeoutExpired:
                samples.append(sample(began, asked(bridge), asked(link)))
                print(LINE.format(*(f"{samples[-1][name]:,}" for name in _columns())), flush=True)
        sent = told(sender)["sent"]
        end, last = asked(link, "end"), asked(bridge)
    problems = wrong(sent, end, samples, HOSTILE_PEERS if args.hostile else 0.5)
    print(
        f"{sent:,} frames sent at {args.rate:,} a second, {end['received']:,} received, {end['compared']:,} in the logs"
    )
    print(
        f"bridge {1e6 * last['CPU'] / sent:.1f} us CPU a frame, link {1e6 * end['CPU'] / sent:.1f}, logs decoded with them"
    )
    if args.hostile:
        megabytes = last["garbage"] / 1e6
        each = 1e9 * last["CPU"] / max(last["garbage"], 1)
        print(
            f"{megabytes:,.0f} MB of garbage reached the bridge, {each:.1f} ns CPU a byte at most"
        )
    print("\n".join(problems) or "nothing lost, nothing grew")
    if args.json:
        found = {"rate": args.rate, "seconds": args.seconds, "hostile": args.hostile, "sent": sent, "end": end,
                 "problems": problems, "samples": samples}  # fmt: skip
        Path(args.json).write_text(json.dumps(found, indent=1) + "\n")
    return 1 if problems else 0


def _columns() -> tuple[str, ...]:
    return ("s", "frames", "compared", *HEAD[3:])


def main() -> int:
    parser = argparse.ArgumentParser(prog="make soak", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)  # fmt: skip
    parser.add_argument("--seconds", type=float, default=1800.0)
    parser.add_argument(
        "--rate", type=int, default=20_000, help="frames a second [default: 20,000]"
    )
    parser.add_argument("--interval", type=float, default=30.0, help="of the lines, in seconds")
    parser.add_argument("--log-bytes", type=int, default=64 << 20, help="when the next log begins")
    parser.add_argument(
        "--hostile", action="store_true", help="garbage and hostile peers beside it"
    )
    parser.add_argument("--json", metavar="FILE", help="keep the samples")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="mavwire-soak-") as folder:
        return run(args, folder)


if __name__ == "__main__":
    raise SystemExit(main())
