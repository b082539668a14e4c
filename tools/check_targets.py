#!/usr/bin/env python3
"""`cargo check` for other systems than this one: `make targets`.

`cargo check` links nothing, but build scripts compile C. zig is the C compiler for each system. A target is skipped, with a
message, if rustup cannot fetch its standard library.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
# Rust's name of a target, and zig's.
TARGETS = {
    "x86_64-unknown-linux-musl": "x86_64-linux-musl",
    "aarch64-unknown-linux-musl": "aarch64-linux-musl",
    "aarch64-unknown-linux-gnu": "aarch64-linux-gnu",
    "armv7-unknown-linux-gnueabihf": "arm-linux-gnueabihf",
    "x86_64-pc-windows-gnu": "x86_64-windows-gnu",
    "aarch64-apple-darwin": "aarch64-macos",
}
# zig has its own names for targets. The arguments of the `cc` crate with other names are removed.
COMPILER = """#!/bin/sh
for argument; do
    shift
    case "$argument" in --target=*) ;; *) set -- "$@" "$argument" ;; esac
done
exec "{python}" -m ziglang cc -target {zig} "$@"
"""
ARCHIVER = """#!/bin/sh
exec "{python}" -m ziglang ar "$@"
"""


def write_program(path: Path, text: str) -> str:
    """An executable file."""
    path.write_text(text)
    path.chmod(0o755)
    return str(path)


def check(target: str, folder: Path) -> bool:
    """Whether everything compiles for a target."""
    suffix = target.replace("-", "_")
    compiler = COMPILER.format(python=sys.executable, zig=TARGETS[target])
    tools = {
        f"CC_{suffix}": write_program(folder / f"cc-{target}", compiler),
        f"AR_{suffix}": write_program(folder / "ar", ARCHIVER.format(python=sys.executable)),
    }
    command = ["cargo", "check", "--quiet", "--workspace", "--locked", "--target", target]
    done = subprocess.run(command, cwd=ROOT, env={**os.environ, **tools}, check=False)
    return done.returncode == 0


def main(names: list[str]) -> int:
    """1 if something does not compile for one of the targets."""
    failed = 0
    with tempfile.TemporaryDirectory() as folder:
        for target in names or TARGETS:
            if subprocess.run(["rustup", "target", "add", target], check=False).returncode:
                print(f"{target}: rustup cannot fetch its standard library, left out", flush=True)
                failed += "GITHUB_ACTIONS" in os.environ  # which reaches everything
                continue
            good = check(target, Path(folder))
            failed += not good
            print(f"{target}: {'compiles' if good else 'DOES NOT COMPILE'}", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
