"""`make bench`: one table, mavwire beside pymavlink and other readers, on the same bytes in the
same run.

Every package works in a process of its own on the same processor, in turns. A figure is the median
of several interleaved runs. The packages' findings are compared, so no row is fast by being wrong.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import subprocess
import sys
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from statistics import median
from typing import Any

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "python"))

import corpus as corpora  # noqa: E402
import document  # noqa: E402
import startup  # noqa: E402
from goals import DUMP_ROWS, ROWS, Row  # noqa: E402

REFERENCE = "pymavlink"
PEERS = ("fasttlogparser", "pymavlog")


class Worker:
    """A process that measures one package."""

    def __init__(self, package: str, corpus: corpora.Corpus, args: argparse.Namespace) -> None:
        self.package = package
        env = startup.environment() | {"MAVLINK20": "1", "MAVLINK_DIALECT": "ardupilotmega"}
        command = [sys.executable, str(HERE / "python" / "worker.py"), package]
        more = [str(corpus.folder), str(corpus.messages), str(args.processor), str(args.seconds)]
        self.process = subprocess.Popen(
            [*command, *more], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=env
        )

    def measure(self, case: str) -> dict[str, Any]:
        """One measurement; the other workers wait meanwhile."""
        assert self.process.stdin and self.process.stdout
        self.process.stdin.write(case + "\n")
        self.process.stdin.flush()
        line = self.process.stdout.readline()
        if not line:
            return {"failed": f"the process of {self.package} ended"}
        answer: dict[str, Any] = json.loads(line)
        return answer

    def close(self) -> None:
        """End the process."""
        assert self.process.stdin
        self.process.stdin.close()
        self.process.wait()


@dataclass
class Result:
    """All measurements of one row."""

    row: Row
    cpu: dict[str, list[float]] = field(default_factory=dict)
    wall: dict[str, list[float]] = field(default_factory=dict)
    digests: dict[str, Any] = field(default_factory=dict)
    notes: dict[str, str] = field(default_factory=dict)

    def add(self, package: str, answer: dict[str, Any]) -> None:
        """Take in one measurement."""
        for reason in ("failed", "unavailable"):
            if reason in answer:
                self.notes[package] = f"{reason}: {answer[reason]}"
                return
        self.cpu.setdefault(package, []).append(answer["cpu"])
        self.wall.setdefault(package, []).append(answer["wall"])
        self.digests[package] = answer["digest"]

    def ratio(self, package: str) -> float | None:
        """How many times as fast as the reference, in CPU time: the median over rounds that ran
        side by side.
        """
        pairs = zip(self.cpu.get(package, []), self.cpu.get(REFERENCE, []), strict=False)
        ratios = [theirs / ours for ours, theirs in pairs if ours > 0]
        return median(ratios) if ratios else None

    def agrees(self) -> bool:
        """Whether all packages found the same."""
        return len({json.dumps(one) for one in self.digests.values()}) <= 1


def chosen(row: Row, only: str | None) -> bool:
    """Whether a row is to be measured: `only` is its number (G1) or a part of its case."""
    return not only or only.upper() == row.number or only in row.case


def check_chosen(only: str | None) -> None:
    """End the program where `only` names no row, with those that there are."""
    rows = (*ROWS, *DUMP_ROWS)
    if any(chosen(row, only) for row in rows):
        return
    known = "\n".join(f"  {row.number:<4} {row.case}" for row in rows)
    raise SystemExit(f"--only {only}: no such row; there are\n{known}")


def run_cases(
    packages: list[str], corpus: corpora.Corpus, args: argparse.Namespace
) -> list[Result]:
    """Measure all rows, all packages in turn within every round."""
    results = [Result(row) for row in ROWS if chosen(row, args.only)]
    workers = [Worker(package, corpus, args) for package in packages]
    for number in range(args.runs):
        for result in results:
            progress(f"round {number + 1} of {args.runs}: {result.row.title}")
            for worker in workers:
                if worker.package not in PEERS or result.row.case == "columns":
                    result.add(worker.package, worker.measure(result.row.case))
    for worker in workers:
        worker.close()
    return results


def run_dumps(
    packages: list[str], corpus: corpora.Corpus, args: argparse.Namespace
) -> list[Result]:
    """The command line tools that print a log."""
    results = [Result(row) for row in DUMP_ROWS if chosen(row, args.only)]
    for _ in range(min(args.runs, 3)):
        for result in results:
            progress(result.row.title)
            for package in packages:
                try:
                    form = result.row.case.removeprefix("dump-")
                    answer = startup.dump_cost(package, corpus, form, args.processor)
                except (subprocess.CalledProcessError, OSError) as error:
                    answer = {"failed": str(error)}
                result.add(package, answer)
    return results


def run_startup(packages: list[str], corpus: corpora.Corpus, args: argparse.Namespace) -> list[str]:
    """Lines on import time and memory, which are no times for a message."""
    lines = []
    for module in ("mavutil", "dialects.v20.ardupilotmega"):
        progress(f"import of {module}")
        cells = []
        for package in packages:
            try:
                cost = startup.import_cost(f"{package}.{module}", args.processor, 2 * args.runs - 1)
                cells.append(f"{package} {cost['ms']:.1f} ms, {cost['mb']:+.1f} MB")
            except subprocess.CalledProcessError:
                cells.append(f"{package} failed")
        lines.append(
            f"G13  import {module}, beyond bare Python (must 40 ms, aim 20): " + "; ".join(cells)
        )
    progress("memory")
    cells = []
    for package in packages:
        try:
            kept = median(startup.kept_bytes(package, corpus, args.processor) for _ in range(3))
            cells.append(f"{package} {kept:.0f}")
        except subprocess.CalledProcessError:
            cells.append(f"{package} failed")
    lines.append("G16  bytes per kept message (must 160, aim 110): " + "; ".join(cells))
    return lines


def core_line() -> str | None:
    """The output of the core's own benchmark, where it was built."""
    tool = HERE.parent / "target" / "release" / "examples" / "hot_paths"
    if not tool.exists():
        return None
    out = subprocess.run([str(tool), "time"], check=True, capture_output=True, text=True).stdout
    return "G17  core, ns per frame (scan: must 30, aim 18): " + "; ".join(out.split("\n")).strip(
        "; "
    )


def filter_lines() -> list[str]:
    """The time that a filter saves where the other columns are decoded late."""
    command = [sys.executable, str(HERE / "python" / "pushed_filter.py")]
    out = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    title = "G18  a filter that keeps 1% of the rows, beside a filter on the whole frame"
    return [f"{title}: {line}" for line in out.splitlines()]


def progress(text: str) -> None:
    """Tell a waiting person what is going on."""
    if sys.stderr.isatty():
        sys.stderr.write(f"\r\x1b[K{text}")
        sys.stderr.flush()


def verdict(row: Row, ratio: float | None, rate: float) -> str:
    """The row's verdict against its goals."""
    if row.must is None:
        return ""
    if row.aim is not None and row.aim.met(ratio, rate):
        return "aim"
    return "must" if row.must.met(ratio, rate) else "BELOW"


def times(ratio: float | None) -> str:
    """A ratio to two digits."""
    if not ratio:
        return "-"
    return f"{ratio:.0f}x" if ratio >= 10 else f"{ratio:.2g}x"


def table(results: list[Result], subject: str) -> list[list[str]]:
    """Cells of the table, header first."""
    head = [
        "",
        "path",
        f"{REFERENCE} us",
        f"{subject} us",
        "msgs/s",
        "ratio",
        "must",
        "aim",
        "reaches",
        "others",
    ]
    rows = [head]
    for one in results:
        ours, theirs = (median(one.cpu[p]) if p in one.cpu else None for p in (subject, REFERENCE))
        ratio = one.ratio(subject)
        rate = 1e6 / ours if ours else 0.0
        others = [f"{p} {median(one.cpu[p]):.2f}" for p in PEERS if p in one.cpu]
        rows.append([
            one.row.number, one.row.title,
            f"{theirs:.2f}" if theirs is not None else "-",
            f"{ours:.3f}" if ours is not None else "-",
            f"{rate / 1e6:.2f}M" if ours else "-",
            times(ratio),
            str(one.row.must or ""), str(one.row.aim or ""),
            verdict(one.row, ratio, rate) if ours else "-", ", ".join(others),
        ])  # fmt: skip
    return rows


def aligned(rows: list[list[str]]) -> str:
    """Columns padded for a terminal."""
    widths = [max(len(row[n]) for row in rows) for n in range(len(rows[0]))]
    lines = []
    for row in rows:
        cells = [
            cell.ljust(width) if n in (0, 1, 6, 7, 8, 9) else cell.rjust(width)
            for n, (cell, width) in enumerate(zip(row, widths, strict=True))
        ]
        lines.append("  ".join(cells).rstrip())
    return "\n".join(lines)


def problems(results: list[Result]) -> list[str]:
    """Everything that makes the figures worthless."""
    found = []
    for one in results:
        found += [f"{one.row.title}: {p}: {note}" for p, note in one.notes.items()]
        if not one.agrees():
            found.append(f"{one.row.title}: the packages do not agree: {one.digests}")
    return found


def machine() -> str:
    """The machine of the figures."""
    name = platform.processor() or platform.machine()
    info = Path("/proc/cpuinfo")
    if info.exists():
        models = [line for line in info.read_text().splitlines() if line.startswith("model name")]
        name = models[0].split(":")[1].strip() if models else name
    return f"{name}, CPython {platform.python_version()}"


def arguments() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--messages", type=int, default=50_000, help="length of the log")
    parser.add_argument("--runs", type=int, default=5, help="interleaved rounds")
    parser.add_argument("--seconds", type=float, default=0.15, help="least work in one measurement")
    parser.add_argument("--subject", default="mavwire")
    parser.add_argument("--only", help="only rows of this number (G1), or whose case contains this")
    parser.add_argument("--processor", type=int, default=(os.cpu_count() or 1) - 1)
    parser.add_argument("--json", type=Path, help="write all measurements to a file")
    parser.add_argument("--markdown", type=Path, help="write the table to a file")
    parser.add_argument("--document", action="store_true", help="write it into the documents")
    return parser.parse_args()


def main() -> int:
    args = arguments()
    check_chosen(args.only)
    packages = list(dict.fromkeys([REFERENCE, args.subject]))
    corpus = corpora.prepare(args.messages, args.subject)
    peers = [peer for peer in PEERS if find_spec(peer)]
    results = run_cases([*packages, *peers], corpus, args) + run_dumps(packages, corpus, args)
    lines = [] if args.only else [*run_startup(packages, corpus, args), core_line() or ""]
    lines += [] if args.only else filter_lines()
    progress("")
    rows = table(results, args.subject)
    title = f"{args.messages:,} messages, medians of {args.runs} runs, CPU time on {machine()}"
    print("\n".join([title, "", aligned(rows), "", *filter(None, lines)]))
    wrong = problems(results)
    print("\n".join(wrong), file=sys.stderr)
    if args.json:
        plain = [
            {"case": r.row.case, "cpu": r.cpu, "wall": r.wall, "notes": r.notes} for r in results
        ]
        args.json.write_text(
            json.dumps({"title": title, "results": plain, "lines": lines}, indent=1)
        )
    lines = [line for line in lines if line]
    if args.markdown:
        args.markdown.write_text("\n".join([title, "", document.markdown(rows), "", *lines, ""]))
    if args.document and not wrong:
        document.update(title, rows, lines)
    return 1 if wrong else 0


if __name__ == "__main__":
    raise SystemExit(main())
