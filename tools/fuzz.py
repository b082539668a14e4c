"""Builds the fuzz targets of rust/fuzz with libFuzzer and the address sanitizer, and runs each for some time.

Needs a nightly toolchain, and fails without one unless told to go on (`--without-nightly skip`). Prints executions,
coverage and findings of each target. An input that stops a target stays in rust/fuzz/artifacts; `--keep`
adds the inputs that reach something new to the corpus, fewest and shortest.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

FUZZ = Path(__file__).parents[1] / "rust" / "fuzz"
TRIPLE = "x86_64-unknown-linux-gnu" if sys.platform == "linux" else "aarch64-apple-darwin"
# Flags that cargo-fuzz passes too.
FLAGS = (
    "-Zsanitizer=address --cfg fuzzing -Cpasses=sancov-module "
    "-Cllvm-args=-sanitizer-coverage-level=4 "
    "-Cllvm-args=-sanitizer-coverage-inline-8bit-counters "
    "-Cllvm-args=-sanitizer-coverage-pc-table "
    "-Cllvm-args=-sanitizer-coverage-trace-compares"
)
# Longest inputs: telemetry of some seconds. Slower ones than `timeout` seconds count as a failure.
LIMITS = ("-max_len=4096", "-timeout=20", "-rss_limit_mb=2048", "-print_final_stats=1")
EXECUTIONS = re.compile(r"stat::number_of_executed_units:\s*(\d+)")
COVERAGE = re.compile(r"cov: (\d+)")


def targets() -> list[str]:
    manifest = tomllib.loads((FUZZ / "Cargo.toml").read_text(encoding="utf-8"))
    return [one["name"] for one in manifest["bin"]]


def has_nightly() -> bool:
    command = ["rustup", "run", "nightly", "rustc", "--version"]
    try:
        return subprocess.run(command, capture_output=True, check=False).returncode == 0
    except FileNotFoundError:
        return False


def build() -> Path:
    """The folder of the programs."""
    folder = Path(os.environ.get("CARGO_TARGET_DIR", FUZZ / "target"))
    command = ["cargo", "+nightly", "build", "--quiet", "--release", "--locked", "--bins"]
    subprocess.run(
        [*command, "--features", "libfuzzer", "--target", TRIPLE],
        cwd=FUZZ,
        env={**os.environ, "RUSTFLAGS": FLAGS},
        check=True,
    )
    return folder / TRIPLE / "release"


def run(programs: Path, name: str, seconds: int, keep: bool, seed: int) -> bool:
    """Runs a target over its corpus; whether it held."""
    corpus, dictionary = FUZZ / "corpus" / name, FUZZ / "dictionaries" / f"{name}.dict"
    artifacts = FUZZ / "artifacts" / name
    artifacts.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as found:
        command = [str(programs / name), found, str(corpus), f"-max_total_time={seconds}", *LIMITS]
        command.append(f"-seed={seed}")
        command.append(f"-artifact_prefix={artifacts}/")
        if dictionary.exists():
            command.append(f"-dict={dictionary}")
        done = subprocess.run(
            command, capture_output=True, text=True, errors="replace", check=False
        )
        if keep:
            merge = [str(programs / name), "-merge=1", "-max_len=1024", str(corpus), found]
            subprocess.run(merge, capture_output=True, check=False)
    executions = EXECUTIONS.search(done.stderr)
    coverage = [int(number) for number in COVERAGE.findall(done.stderr)]
    count = int(executions[1]) if executions else 0
    # A program that tried nothing has found nothing, either.
    held = done.returncode == 0 and count > 0
    said = "held" if held else "FAILED"
    print(f"{name:<20}{count:>14,}{max(coverage, default=0):>10,}  {said}", flush=True)
    if not held:
        print("\n".join(done.stderr.splitlines()[-40:]))
    return held


def some_seconds(text: str) -> int:
    """How long to fuzz: with 0 or less libFuzzer goes on for ever."""
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError(f"1 or more, not {number}")
    return number


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description="Fuzzes rust/fuzz.")
    parser.add_argument("targets", nargs="*", help="those alone")
    parser.add_argument("--seconds", type=some_seconds, default=20, help="for each target")
    parser.add_argument(
        "--seed", type=int, default=0, help="of what is tried (default: another each time)"
    )
    parser.add_argument("--keep", action="store_true", help="add what is new to the corpus")
    parser.add_argument(
        "--without-nightly",
        choices=("fail", "skip"),
        default="fail",
        help="what to do where there is no nightly Rust [default: fail]",
    )
    options = parser.parse_args(arguments)
    if unknown := set(options.targets) - set(targets()):
        parser.error(f"no target {', '.join(sorted(unknown))}; there are: {', '.join(targets())}")
    if not has_nightly():
        needed = "fuzzing needs nightly Rust: rustup toolchain install nightly"
        if options.without_nightly == "fail":
            print(f"error: {needed}", file=sys.stderr)
            return 2
        print(f"WARNING: NOTHING WAS FUZZED, {needed}", file=sys.stderr)
        if os.environ.get("GITHUB_ACTIONS"):
            print(f"::warning title=Nothing was fuzzed::{needed}")
        return 0
    names = options.targets or targets()
    programs = build()
    print(f"{'target':<20}{'executions':>14}{'coverage':>10}")
    held = [run(programs, name, options.seconds, options.keep, options.seed) for name in names]
    return 0 if all(held) else 1


if __name__ == "__main__":
    sys.exit(main())
