"""`make soak`: what a ground station does, for as long as wanted, and nothing may be lost or grow.

    simulated flight -> UDP -> mavwire bridge -> UDP -> mavutil link that records -> logs -> decoded and compared

Each part is a process of its own; the flight is that of a simulated copter, over and over at `--rate` frames a second. A log
is closed at `--log-bytes`, decoded, compared frame by frame with what was sent, and removed. With `--hostile` garbage
comes to other ports of the same bridge as fast as it can be sent, over UDP and over TCP connections that come and go. To the
flight's own ports there come, steadily, good frames of all senders that can be made up, garbage from senders that change,
and a TCP client that reads nothing. The flight must come through all the same.

Prints a line each `--interval`: frames, and memory, descriptors and processor time of bridge and receiver; `--json` keeps
them. Fails where a frame is missing, where a log differs, or where memory or descriptors grow, and
where there are too few lines to see that.
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
from typing import Any, NamedTuple

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
MOST_NANOSECONDS = 100.0
"""Of processor time that the bridge may take for each byte that reaches it, beside hostile peers."""
MOST_COMPONENTS = 255 * 256
"""That a bridge may know: there are no more."""
WARM_UP = 0.1
"""Share of the samples in which buffers and pools still fill."""
LEAST_SAMPLES = 10
"""With fewer no growth can be seen."""
TRIAL = 5.0
"""Seconds of each flight that looks for the capacity, the first at FIRST_RATE frames a second."""
CONFIRMATION = 30.0
"""Seconds for which a capacity must hold: a short flight can pass between two pauses of the system."""
FIRST_RATE = 2500
FULL_PACE = 0.95
"""A sender below this share of its rate makes no more."""
SHARE = 0.8
"""Of the capacity, by `--rate auto`."""


class Flight(NamedTuple):
    """Frames sent and in how many seconds, what the link saw to the end, and the bridge."""

    sent: int
    seconds: float
    end: dict[str, Any]
    bridge: dict[str, Any]


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
    """The answer of a worker."""
    assert process.stdin is not None
    process.stdin.write(word + "\n")
    process.stdin.flush()
    return told(process)


def settled(samples: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Without those in which buffers and pools still fill, and the table of components."""
    known = samples[-1]["components"] if samples else 0
    filled = next((n for n, one in enumerate(samples) if one["components"] == known), 0)
    return samples[max(int(len(samples) * WARM_UP), filled) :]


def growth(samples: list[dict[str, Any]], key: str) -> float:
    """By how much the mean of the last third is above that of the first."""
    values = [one[key] for one in settled(samples)]
    third = max(len(values) // 3, 1)
    return sum(values[-third:]) / third - sum(values[:third]) / third


def wrong(
    sent: int, end: dict[str, Any], samples: list[dict[str, Any]], descriptors: float = 0.5
) -> list[str]:
    """Failures of a run."""
    found = []
    if end["received"] != sent or end["compared"] != sent:
        found.append(
            f"of {sent:,} frames {end['received']:,} came and {end['compared']:,} were in the logs"
        )
    if end["difference"] is not None:
        found.append(f"the logs differ from what was sent at frame {end['difference']:,}")
    if len(samples) < LEAST_SAMPLES or len(settled(samples)) < LEAST_SAMPLES / 2:
        found.append(
            f"{len(samples)} samples show no growth: it takes {LEAST_SAMPLES}, by a shorter --interval"
        )
    for part in ("bridge", "link") if samples else ():
        if (more := growth(samples, f"{part} kB")) > GROWTH:
            found.append(f"the memory of the {part} grew by {more:,.0f} kB")
        if (further := growth(samples, f"{part} fd")) > descriptors:
            found.append(f"the {part} has {further:.1f} more descriptors")
    return found


def too_dear(bridge: dict[str, Any]) -> list[str]:
    """Costs that hostile peers cause the bridge, above the limits."""
    found = []
    if (each := nanoseconds(bridge)) > MOST_NANOSECONDS:
        found.append(f"{each:.1f} ns CPU a byte are more than {MOST_NANOSECONDS:g}")
    if bridge["components"] > MOST_COMPONENTS:
        found.append(f"the bridge knows {bridge['components']:,} components")
    return found


def nanoseconds(bridge: dict[str, Any]) -> float:
    """Processor time of the bridge for each byte that came to it."""
    return 1e9 * float(bridge["CPU"]) / max(int(bridge["came"]), 1)


def sample(began: float, bridge: dict[str, Any], link: dict[str, Any]) -> dict[str, Any]:
    """A line of the table."""
    return {
        "s": round(time.monotonic() - began, 1),
        "frames": link["received"],
        "compared": link["compared"],
        **{f"{part} {key}": one[key] for part, one in (("bridge", bridge), ("link", link)) for key in ("kB", "fd", "CPU")},
        "garbage": bridge["garbage"],
        "components": bridge["components"],
    }  # fmt: skip


def fly(
    args: argparse.Namespace, rate: int, seconds: float, samples: list[dict[str, Any]] | None = None
) -> Flight:
    """A flight through all parts; with `samples` these are taken, kept there and printed."""
    with ExitStack() as stack:
        folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="mavwire-soak-"))
        link = start(stack, "link", folder, args.log_bytes)
        bridge = start(stack, "bridge", told(link)["port"])
        ports = told(bridge)
        enemies = []
        if args.hostile:
            enemies.append(start(stack, "attack", ports["hostile UDP"], ports["hostile TCP"]))
            enemies.append(start(stack, "intrude", ports["honest"], ports["viewers"]))
            told(enemies[-1])
        sender = start(stack, "send", ports["honest"], rate, seconds)
        began = time.monotonic()
        while samples is not None and sender.poll() is None:
            try:
                sender.wait(args.interval)
            except subprocess.TimeoutExpired:
                samples.append(sample(began, asked(bridge), asked(link)))
                print(LINE.format(*(f"{samples[-1][name]:,}" for name in _columns())), flush=True)
        report = told(sender)
        if any(one.poll() is not None for one in enemies):
            raise SystemExit("a hostile peer has ended before the flight: it proves nothing")
        return Flight(report["sent"], report["seconds"], asked(link, "end"), asked(bridge))


def tried(args: argparse.Namespace, rate: int, seconds: float) -> tuple[int, int]:
    """Frames a second that a flight made, and how many frames it lost."""
    flight = fly(args, rate, seconds)
    lost = flight.sent - flight.end["received"]
    made = int(flight.sent / max(flight.seconds, seconds))
    print(
        f"{made:,} frames a second for {seconds:g} s: {lost:,} of {flight.sent:,} lost", flush=True
    )
    return made, lost


def capacity(args: argparse.Namespace) -> int:
    """Frames a second that come through: doubled until one is lost, or until the sender makes no more,
    then confirmed by a longer flight, or by that of the first lower rate that loses none."""
    good, rate = 0, FIRST_RATE
    while True:
        made, lost = tried(args, rate, TRIAL)
        if not lost:
            good = made
        if lost or made < FULL_PACE * rate:
            break
        rate *= 2
    while good >= SHARE * FIRST_RATE:
        made, lost = tried(args, good, CONFIRMATION)
        if not lost:
            return made
        good = int(SHARE * good)
    raise SystemExit(f"not even {FIRST_RATE:,} frames a second come through")


def run(args: argparse.Namespace) -> int:
    """0 if all is well."""
    rate = int(SHARE * capacity(args)) if args.rate == "auto" else int(args.rate)
    print(LINE.format(*HEAD))
    samples: list[dict[str, Any]] = []
    flight = fly(args, rate, args.seconds, samples)
    sent, end, last = flight.sent, flight.end, flight.bridge
    problems = wrong(sent, end, samples, HOSTILE_PEERS if args.hostile else 0.5)
    problems += too_dear(last) if args.hostile else []
    print(
        f"{sent:,} frames sent at {rate:,} a second, {end['received']:,} received, {end['compared']:,} in the logs"
    )
    print(
        f"bridge {1e6 * last['CPU'] / sent:.1f} us CPU a frame, link {1e6 * end['CPU'] / sent:.1f}, logs decoded with them"
    )
    if args.hostile:
        print(
            f"{last['garbage'] / 1e6:,.0f} MB of garbage and {last['components']:,} components reached the bridge, "
            f"{nanoseconds(last):.1f} ns CPU for each byte that came"
        )
    print("\n".join(problems) or "nothing lost, nothing grew")
    if args.json:
        found = {"rate": rate, "seconds": args.seconds, "hostile": args.hostile, "sent": sent, "end": end,
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
        "--rate",
        default="20000",
        help="frames a second [default: 20000], or auto: 80%% of what comes through in trials",
    )
    parser.add_argument(
        "--interval",
        type=float,
        help="of the lines, in seconds [default: a twentieth of the time, 30 at most]",
    )
    parser.add_argument("--log-bytes", type=int, default=64 << 20, help="when the next log begins")
    parser.add_argument(
        "--hostile", action="store_true", help="garbage and hostile peers beside it"
    )
    parser.add_argument("--json", metavar="FILE", help="keep the samples")
    args = parser.parse_args()
    if args.rate != "auto" and not (args.rate.isdecimal() and int(args.rate)):
        parser.error(f"--rate is auto or frames a second, not {args.rate!r}")
    args.interval = args.interval or min(30.0, args.seconds / 20)
    return run(args)


if __name__ == "__main__":
    raise SystemExit(main())
