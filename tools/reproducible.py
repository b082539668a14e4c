#!/usr/bin/env python3
"""Whether a wheel can be built again, byte by byte: `make reproducible`.

The committed sources are unpacked in two folders of different names and built in each, with a target folder of its own.
What is told to the compiler makes paths and times no part of the outcome; `--environment` prints it.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
TWICE = ("one", "another-place")


def source_date() -> int:
    """Seconds since 1970 of the last commit, unless SOURCE_DATE_EPOCH says something else."""
    if given := os.environ.get("SOURCE_DATE_EPOCH"):
        return int(given)
    command = ["git", "log", "-1", "--format=%ct"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    return int(done.stdout) if done.returncode == 0 else 315_532_800  # 1980, where zip files begin


def environment(sources: Path, cargo_home: Path) -> dict[str, str]:
    """Environment variables that make a build in `sources` independent of place and time."""
    places = {sources: "/mavwire", cargo_home: "/cargo"}
    flags = [f"--remap-path-prefix={place}={name}" for place, name in places.items()]
    return {
        "SOURCE_DATE_EPOCH": str(source_date()),
        "RUSTFLAGS": " ".join(flags),
        "CARGO_INCREMENTAL": "0",
    }


def cargo_home() -> Path:
    return Path(os.environ.get("CARGO_HOME") or Path.home() / ".cargo")


def build(folder: Path, profile: str) -> Path:
    """The wheel of the committed sources, unpacked and built in `folder`."""
    folder.mkdir()
    archive = subprocess.run(
        ["git", "archive", "HEAD"], cwd=ROOT, stdout=subprocess.PIPE, check=True
    )
    subprocess.run(["tar", "-x", "-C", str(folder)], input=archive.stdout, check=True)
    out = folder / "dist"
    command = [
        sys.executable,
        "-m",
        "maturin",
        "build",
        "--locked",
        "--profile",
        profile,
        "--out",
        str(out),
    ]
    own = {
        **os.environ,
        **environment(folder, cargo_home()),
        "CARGO_TARGET_DIR": str(folder / "target"),
    }
    subprocess.run(command, cwd=folder, env=own, check=True)
    (wheel,) = out.glob("*.whl")
    return wheel


def differences(one: Path, other: Path) -> list[str]:
    """The differences between two wheels, by the files in them; empty if all bytes are equal."""
    if one.read_bytes() == other.read_bytes():
        return []
    with zipfile.ZipFile(one) as first, zipfile.ZipFile(other) as second:
        names = sorted({*first.namelist(), *second.namelist()})
        both = set(first.namelist()) & set(second.namelist())
        found = [f"{name}: only in one" for name in names if name not in both]
        found += [f"{name}: other content" for name in names
                  if name in both and first.read(name) != second.read(name)]  # fmt: skip
    return found or ["the same files, packed otherwise"]


def main() -> int:
    """1 if the two wheels differ."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--profile", default="release", help="of Cargo (default: release)")
    parser.add_argument("--environment", action="store_true", help="only print the variables")
    args = parser.parse_args()
    if args.environment:
        for name, value in environment(ROOT, cargo_home()).items():
            print(f"{name}={value}")
        return 0
    with tempfile.TemporaryDirectory(prefix="mavwire-") as folder:
        wheels = []
        for name in TWICE:
            built = build(Path(folder, name), args.profile)
            wheels.append(Path(shutil.copy(built, Path(folder, f"{name}.whl"))))
            shutil.rmtree(Path(folder, name))
        wrong = differences(*wheels)
        digest = hashlib.sha256(wheels[0].read_bytes()).hexdigest()
    print("\n".join(wrong) or f"two builds, one wheel: SHA-256 {digest}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
