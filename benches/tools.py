"""`make bench-tools`: mavwire's tools beside pymavlink's scripts, as whole processes over one log.

The programs take turns on one processor; a figure is the median of the rounds in CPU time, user and
system. Everything that they print and write must be the same. Beyond start: the time of the same
program on a log of 20 messages taken off.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import sys
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "python"))

import corpus as corpora  # noqa: E402
import document  # noqa: E402
import startup  # noqa: E402
from compare import aligned, machine, progress, times  # noqa: E402

PACKAGES = ("pymavlink", "mavwire")
# Verb, pymavlink's script, and the options before the log.
TOOLS = (
    ("parms", "mavparms.py", ""),
    ("flightmodes", "mavflightmodes.py", ""),
    ("flighttime", "mavflighttime.py", ""),
    ("summarize", "mavsummarize.py", ""),
    ("mission", "mavmission.py", ""),
    ("togpx", "mavtogpx.py", ""),
    ("search", "mavsearch.py", "--types STATUSTEXT"),
    ("loss", "mavloss.py", "--stats"),
    ("extract", "mavextract.py", "--mode none"),
    ("extract", "mavextract.py", "--mode loiter"),
    ("tomfile", "mavtomfile.py", ""),
)
LOG = "flight.tlog"
# Seconds beyond its start that a program must take for a ratio.
LEAST = 0.01


def command(package: str, verb: str, script: str, options: str) -> list[str]:
    """The command that runs in a folder with the log."""
    scripts = Path(sys.executable).parent
    program = [scripts / script] if package == "pymavlink" else [scripts / "mavwire", verb]
    return [sys.executable, *map(str, program), *options.split(), LOG]


def cost(program: list[str], log: str, processor: int) -> tuple[float, str]:
    """CPU seconds of a program, and a digest of all that it prints and writes."""
    with TemporaryDirectory() as folder:
        os.symlink(log, os.path.join(folder, LOG))
        cpu, _, output = startup.child(program, processor, folder)
        digest = hashlib.sha256(output)
        for path in sorted(Path(folder).iterdir()):
            if not path.is_symlink():
                digest.update(path.name.encode() + path.read_bytes())
    return cpu, digest.hexdigest()


def measure(tool: tuple[str, str, str], corpus: corpora.Corpus, processor: int) -> list[float]:
    """CPU seconds of one round: pymavlink whole and started only, then mavwire. ValueError if they
    do not agree.
    """
    seconds, digests = [], []
    for package in PACKAGES:
        program = command(package, *tool)
        for log in (corpus.tlog, corpus.short):
            cpu, digest = cost(program, log, processor)
            seconds.append(cpu)
            digests.append(digest)
    if digests[:2] != digests[2:]:
        raise ValueError(f"{' '.join(command('mavwire', *tool))}: the packages do not agree")
    return seconds


def row(tool: tuple[str, str, str], rounds: list[list[float]]) -> list[str]:
    """Cells of the table: medians of the rounds, and of the ratios within them."""
    theirs, ours = (median(one[at] for one in rounds) for at in (0, 2))
    whole = median(one[0] / one[2] for one in rounds)
    # A run that is too short for the clock of the system gives no ratio.
    clear = median(one[2] - one[3] for one in rounds) >= LEAST
    beyond = median((one[0] - one[1]) / max(one[2] - one[3], LEAST) for one in rounds)
    start, our_start = (median(one[at] for one in rounds) * 1000 for at in (1, 3))
    name = f"{tool[0]} {tool[2]}".strip()
    cells = [f"`{name}`", f"{theirs:.2f} s", f"{ours:.2f} s", times(whole)]
    return [*cells, times(beyond if clear else None), f"{start:.0f} ms", f"{our_start:.0f} ms"]


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--messages", type=int, default=100_000, help="length of the log")
    parser.add_argument("--runs", type=int, default=3, help="interleaved rounds")
    parser.add_argument("--only", default="", help="only tools whose name contains this")
    parser.add_argument("--processor", type=int, default=(os.cpu_count() or 1) - 1)
    parser.add_argument(
        "--document", action="store_true", help="write it into docs/pymavlink-tools.md"
    )
    args = parser.parse_args()
    corpus = corpora.prepare(args.messages, "mavwire")
    tools = [tool for tool in TOOLS if args.only in tool[0]]
    rounds: list[list[list[float]]] = [[] for _ in tools]
    for number in range(args.runs):
        for tool, kept in zip(tools, rounds, strict=True):
            progress(f"round {number + 1} of {args.runs}: {tool[0]}")
            kept.append(measure(tool, corpus, args.processor))
    progress("")
    rows = [
        ["tool", "script", "mavwire", "times as fast", "beyond start", "script's start", "start"]
    ]
    rows += [row(tool, kept) for tool, kept in zip(tools, rounds, strict=True)]
    title = f"{args.messages:,} messages, medians of {args.runs} runs, CPU time on {machine()}"
    print(f"{title}\n\n{aligned(rows)}")
    if args.document:
        path = document.ROOT / "docs" / "pymavlink-tools.md"
        content = f"{title}.\n\n{document.markdown(rows)}"
        document.write(path, "tools", content)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
