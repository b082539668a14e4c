"""Processes that are killed at random moments: what is half there afterwards, and what another run makes of it."""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from random import Random
from typing import Any

from encoder import attitude, frame, record

from hardening.tools import T0

COMMANDS = {
    "repair": ("repair", "LOG", "-o", "OUT/made.tlog", "--quiet"),
    "anonymize": ("anonymize", "LOG", "-o", "OUT/made.tlog", "--quiet"),
    "convert": ("convert", "LOG", "-o", "OUT", "--types", "ATTITUDE", "--quiet"),
    "convert to MCAP": ("convert", "LOG", "-o", "OUT", "--format", "mcap", "--quiet"),
}
DRAFTS = (".part", ".json")


def run(words: tuple[str, ...], log: Path, out: Path) -> None:
    """To its end, which must be a good one."""
    with begin(words, log, out) as process:
        if process.wait():
            raise RuntimeError(f"{words[0]} ended with {process.returncode}")


def begin(words: tuple[str, ...], log: Path, out: Path) -> subprocess.Popen[bytes]:
    filled = [word.replace("LOG", str(log)).replace("OUT", str(out)) for word in words]
    return subprocess.Popen([sys.executable, "-m", "mavwire", *filled])


def made(out: Path) -> dict[str, int]:
    """Files under their own names, and their sizes."""
    found = (one for one in out.rglob("*") if one.is_file() and not one.name.endswith(DRAFTS))
    return {str(one.relative_to(out)): one.stat().st_size for one in found}


def sweep(package: str, short: bool) -> dict[str, Any]:
    """Of so many kills of each command: outcomes that are not whole, and runs afterwards that do not make them so."""
    if package != "mavwire":
        return {}
    kills, rand = 4 if short else 25, Random(time.time_ns())
    torn = left = 0
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder, "flight.tlog")
        angles = (0.1, -0.2, 3.0, 0.0, 0.0, 0.5)
        log.write_bytes(
            b"".join(
                record(frame(30, attitude(n, *angles), n % 256), T0 + 10_000 * n)
                for n in range(40_000)
            )
            * 5
        )
        for name, words in COMMANDS.items():
            whole = Path(folder, name, "whole")
            whole.mkdir(parents=True)
            began = time.monotonic()
            run(words, log, whole)
            seconds, expected = time.monotonic() - began, made(whole)
            out = Path(folder, name, "out")
            out.mkdir()
            for _ in range(kills):
                if made(out).keys() == expected.keys():  # from the start again
                    shutil.rmtree(out)
                    out.mkdir()
                with begin(words, log, out) as process:
                    time.sleep(rand.uniform(0, seconds))
                    process.kill()
                torn += not made(out).items() <= expected.items()
            run(words, log, out)
            # Drafts of the others stay, by their documentation.
            drafts = words[0] == "convert" and any(out.rglob("*.part"))
            left += made(out) != expected or drafts
    return {f"of {kills * len(COMMANDS)}, torn": torn, "not mended by another run": left}
