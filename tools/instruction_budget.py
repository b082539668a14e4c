"""The regression gate on speed: instructions of the hot paths, counted by callgrind, against a
committed budget.

Times on a shared machine differ by a third from run to run, instruction counts by a thousandth.
Each path is run twice with different lengths; the difference, divided by the difference in length,
is the cost of one message without the cost of starting up. More than 3% above the budget fails;
`--update` writes a new budget, to be committed with the reason.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
BUDGET = ROOT / "benches" / "instruction_budget.json"
TOLERANCE = 0.03
RUST = ("scan", "scan-rescan", "route", "decode", "encode", "verify", "text", "json")
BRIDGE = ("forward", "border")
PYTHON = (
    "parse", "noise", "recv_match", "instances", "filter", "fields", "pack", "send", "verify",
)  # fmt: skip
TABLES = ("columns", "columns-bin", "parquet")
# How many messages the short and the long run have, and how far memory is moved in the runs.
LENGTHS = {
    "rust": (10_000, 40_000), "bridge": (2_000, 12_000), "python": (2_000, 22_000),
    "tables": (20_000, 60_000),
}  # fmt: skip
PADDINGS = {"rust": (0,), "bridge": (0, 0), "python": (0, 1_000, 5_000), "tables": (0, 0)}
COLLECTED = re.compile(r"Collected\s*:\s*(\d+)")


class Unmeasured(RuntimeError):
    """A program could not be built or did not run."""


def build(package: str, example: str) -> list[str]:
    """The command of a Rust program, built as continuous integration builds everything."""
    command = ["cargo", "build", "--quiet", "--locked", "--profile", "ci"]
    what = ["-p", package, "--example", example]
    done = subprocess.run([*command, *what], cwd=ROOT, check=False)
    if done.returncode:
        raise Unmeasured(f"the example {example} does not build")
    return [str(ROOT / "target" / "ci" / "examples" / example)]


def instructions(command: list[str], padding: int) -> int:
    """Instructions that a program executes; `padding` moves its memory a little."""
    tool = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null"]
    env = {"PATH": os.environ["PATH"], "HOME": "/", "PYTHONHASHSEED": "0", "PAD": "x" * padding}
    env["RAYON_NUM_THREADS"] = "1"  # threads that wait count too
    done = subprocess.run([*tool, *command], capture_output=True, text=True, env=env, check=False)
    found = COLLECTED.search(done.stderr)
    if done.returncode or not found:
        raise Unmeasured(f"{' '.join(command)}: {done.stderr[-600:]}")
    return int(found[1])


def per_message(
    command: list[str], case: str, lengths: tuple[int, int], paddings: tuple[int, ...]
) -> float:
    """Instructions for one message: the least of several memory layouts.

    CPython's caches of attributes are indexed by addresses; in an unlucky layout two names of a hot
    loop share a place and the loop costs a tenth more. The least is what the code itself costs.
    """
    short, long = (
        min(instructions([*command, case, str(n)], padding) for padding in paddings)
        for n in lengths
    )
    return (long - short) / (lengths[1] - lengths[0])


def measure(only: str | None) -> dict[str, float]:
    """All paths, by `language/case`."""
    hot_loops = [sys.executable, str(ROOT / "benches" / "python" / "hot_loops.py")]
    programs = (
        ("rust", RUST, lambda: build("mavwire-core", "hot_paths")),
        ("bridge", BRIDGE, lambda: build("mavwire-io", "forward")),
        ("python", PYTHON, lambda: hot_loops),
        ("tables", TABLES, lambda: hot_loops),
    )
    measured = {}
    for language, cases, prepare in programs:
        wanted = [case for case in cases if not only or only in f"{language}/{case}"]
        command = prepare() if wanted else []
        if wanted:
            subprocess.run([*command, wanted[0], "1000"], check=False)  # leaves compiled modules
        for case in wanted:
            name = f"{language}/{case}"
            measured[name] = round(
                per_message(command, case, LENGTHS[language], PADDINGS[language]), 1
            )
            print(f"  {name:<22}{measured[name]:>12,.1f} instructions per message", flush=True)
    return measured


def judge(measured: dict[str, float], budget: dict[str, float]) -> list[str]:
    """Measurements over the budget, and measurements or budgets that are missing."""
    found = []
    for name, count in measured.items():
        allowed = budget.get(name)
        if allowed is None:
            found.append(f"{name} has no budget: run tools/instruction_budget.py --update")
        elif count > allowed * (1 + TOLERANCE):
            found.append(f"{name}: {count:,.1f} is {count / allowed - 1:.1%} over {allowed:,.1f}")
        elif count < allowed * (1 - TOLERANCE):
            print(f"  {name} is {1 - count / allowed:.1%} below its budget: consider --update")
    return found


def toolchain() -> str:
    """The compiler and the interpreter that the counts belong to."""
    rustc = subprocess.run(["rustc", "--version"], capture_output=True, text=True, check=True)
    return f"{' '.join(rustc.stdout.split()[:2])}, CPython {sys.version.split()[0]}"


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--update", action="store_true", help="write the budget")
    parser.add_argument("--only", help="only paths whose name contains this")
    args = parser.parse_args()
    if shutil.which("valgrind") is None:
        print("valgrind is not installed: the instruction budget was NOT checked", file=sys.stderr)
        return 1 if os.environ.get("CI") == "true" else 0
    kept = json.loads(BUDGET.read_text()) if BUDGET.exists() else {"instructions": {}}
    try:
        measured = measure(args.only)
    except Unmeasured as error:
        print(f"instruction budget: {error}", file=sys.stderr)
        return 1
    if args.update:
        merged = kept["instructions"] | measured
        content = {"toolchain": toolchain(), "instructions": merged}
        BUDGET.write_text(json.dumps(content, indent=1) + "\n")
        return 0
    problems = judge(measured, kept["instructions"])
    if problems and kept.get("toolchain") != toolchain():
        print(f"note: the budget was made with {kept.get('toolchain')}, this is {toolchain()}")
    print("\n".join(problems), file=sys.stderr)
    return 1 if problems else 0


if __name__ == "__main__":
    raise SystemExit(main())
