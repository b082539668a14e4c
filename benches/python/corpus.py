"""The bytes that every package is measured on: one flight, framed in every way a benchmark needs.

Made once by the traffic generator and kept below target/, under a name that changes with the
generator's sources. Run as a script with DIRECTORY PACKAGE MESSAGES it makes the files in a process
of its own.
"""

from __future__ import annotations

import hashlib
import importlib
import json
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import dataflash_log

ROOT = Path(__file__).parents[2]
KEY = bytes(range(32))
FILES: dict[str, dict[str, Any]] = {
    "stream": {},
    "version1": {"version": 1},
    "corrupt": {"corruption": 0.01},
    "signed": {"signing_key": KEY},
}


@dataclass(frozen=True)
class Corpus:
    """Where the files are and how many messages each has."""

    folder: Path
    messages: int

    @property
    def tlog(self) -> str:
        """Path of the telemetry log."""
        return str(self.folder / "flight.tlog")

    @property
    def short(self) -> str:
        """Path of a log of 20 messages, to take the start of a program off its running time."""
        return str(self.folder / "short.tlog")

    @property
    def dataflash(self) -> str:
        """Path of the dataflash log."""
        return str(self.folder / "flight.BIN")

    def raw(self, name: str) -> bytes:
        """Bytes of a stream without timestamps: `stream`, `version1`, `corrupt` or `signed`."""
        return (self.folder / f"{name}.raw").read_bytes()


def chunks(data: bytes, size: int) -> list[bytes]:
    """The data in pieces of one size."""
    return [data[at : at + size] for at in range(0, len(data), size)]


def prepare(messages: int, package: str) -> Corpus:
    """The corpus of this length, made now where it is not there yet."""
    sources = sorted((ROOT / "python" / "mavwire" / "traffic").glob("*.py"))
    own = [Path(__file__), Path(dataflash_log.__file__)]
    digest = hashlib.sha256(b"".join(one.read_bytes() for one in [*sources, *own]))
    folder = ROOT / "target" / "bench" / f"{messages}-{digest.hexdigest()[:12]}"
    if not (folder / "complete").exists():
        folder.mkdir(parents=True, exist_ok=True)
        command = [sys.executable, __file__, str(folder), package, str(messages)]
        subprocess.run(command, check=True)
    return Corpus(folder, messages)


def make(folder: Path, package: str, messages: int) -> None:
    """Write all files."""
    if package != "mavwire":  # the generator itself needs nothing of the package but its dialect
        sys.path.insert(0, str(ROOT / "python"))
    from mavwire import traffic

    dialect = importlib.import_module(f"{package}.dialects.v20.ardupilotmega")
    traffic.generate(folder / "flight.tlog", messages, dialect=dialect)
    traffic.generate(folder / "short.tlog", 20, dialect=dialect)
    for name, more in FILES.items():
        options = traffic.Options(messages, **more)
        with (folder / f"{name}.raw").open("wb") as file:
            for _, frame, _ in traffic.records(options, dialect):
                file.write(frame)
    dataflash_log.write(folder / "flight.BIN", messages)
    (folder / "complete").write_text(json.dumps({"messages": messages}))


if __name__ == "__main__":
    make(Path(sys.argv[1]), sys.argv[2], int(sys.argv[3]))
