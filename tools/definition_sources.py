"""message_definitions/sources.toml: the origin of the definitions, the digests of what was read and written, and the
changes of messages that somebody accepted.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import subprocess
import tomllib
from dataclasses import dataclass, field
from datetime import date
from pathlib import Path
from typing import Any

from mavwire.cli.dev._definition_facts import definition_files

DEFINITIONS = Path(__file__).resolve().parent.parent / "message_definitions"
SOURCES = DEFINITIONS / "sources.toml"
UNION = DEFINITIONS / "upstream" / "upstream.xml"
HISTORY = UNION.with_name("history.xml")
WRITTEN = "written"
ACCEPTED = "accepted"
HEAD = """# Where the definitions come from: the SHA-256 of each file that was read, and of each file that was written.
# Written by tools/import_definitions.py and tools/union_definitions.py. `[[accepted]]` is written by hand:
# tools/definitions_check.py prints it for each change that is held back.
"""


@dataclass
class Source:
    """A repository at a commit, or a package of a version, with the digests of its files."""

    name: str
    revision: str = ""
    date: date | None = None
    sha256: dict[str, str] = field(default_factory=dict)

    def __str__(self) -> str:
        return f"{self.name} {self.revision[:12]} ({self.date})"


@dataclass(frozen=True)
class Accepted:
    """A change that the union takes: of a message id, the old and the new CRC_EXTRA; of an enum, the old and the new
    entry as `NAME = VALUE`. Without `new` a message is removed.
    """

    old: int | str
    id: int | None = None
    enum: str | None = None
    new: int | str | None = None
    reason: str = ""

    def __str__(self) -> str:
        rows = {"id": self.id, "enum": self.enum, "old": self.old, "new": self.new}
        rows["reason"] = self.reason
        lines = [f"{key} = {json.dumps(value)}" for key, value in rows.items() if value is not None]
        return "\n".join(["[[accepted]]", *lines])


def accepted(path: Path = SOURCES) -> list[Accepted]:
    """The accepted changes in the order of the file."""
    content = tomllib.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}
    return [Accepted(**row) for row in content.get(ACCEPTED, [])]


def digest(path: Path) -> str:
    """The SHA-256 of a file."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def digests(folder: Path) -> dict[str, str]:
    """The SHA-256 of each definition file in a folder."""
    return {path.name: digest(path) for path in definition_files(folder)}


def load(path: Path = SOURCES) -> dict[str, Source]:
    """The sources by name, and under `WRITTEN` what was written."""
    if not path.is_file():
        return {}
    content = tomllib.loads(path.read_text(encoding="utf-8"))
    return {
        name: Source(name, row.get("revision", ""), row.get("date"), row["sha256"])
        for name, row in content.items()
        if name != ACCEPTED
    }


def save(*changed: Source, path: Path = SOURCES) -> None:
    """Replace these sources and keep the others."""
    sources = load(path) | {source.name: source for source in changed}
    lines = [HEAD, *(f"{one}\n" for one in accepted(path))]
    for name, source in sorted(sources.items()):
        if source.revision:
            lines += [f'["{name}"]', f'revision = "{source.revision}"', f"date = {source.date}\n"]
        lines += [f'["{name}".sha256]']
        lines += [f'"{file}" = "{value}"' for file, value in sorted(source.sha256.items())]
        lines += [""]
    path.write_text("\n".join(lines), encoding="utf-8", newline="\n")


def save_written(*files: Path, path: Path = SOURCES) -> None:
    """Note the digests of written files."""
    source = load(path).get(WRITTEN, Source(WRITTEN))
    source.sha256 |= {file.relative_to(DEFINITIONS).as_posix(): digest(file) for file in files}
    save(source, path=path)


def checkout(folder: Path) -> Source:
    """The source that a folder of a Git checkout belongs to. ValueError where it is none."""

    def git(*arguments: str) -> str:
        command = ["git", "-C", str(folder), *arguments]
        done = subprocess.run(command, check=False, capture_output=True, text=True)
        if done.returncode:
            raise ValueError(f"{folder}: {done.stderr.strip()}; name its origin with --pin")
        return done.stdout.strip()

    address = git("remote", "get-url", "origin").removesuffix("/").removesuffix(".git")
    name = "/".join(address.replace(":", "/").split("/")[-2:])
    revision, day = git("log", "-1", "--format=%H %cs").split()
    return Source(name, revision, date.fromisoformat(day), digests(folder))


class Pin(argparse.Action):
    """`--pin NAME REVISION DATE` as a `Source`."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: Any,
        option: str | None = None,
    ) -> None:
        name, revision, day = values
        try:
            source = Source(name, revision, date.fromisoformat(day))
        except ValueError as error:
            parser.error(f"--pin: {error}")
        namespace.pin = [*(namespace.pin or []), source]


def add_pin(parser: argparse.ArgumentParser) -> None:
    """The option `--pin`, once for each folder."""
    parser.add_argument(
        "--pin",
        nargs=3,
        action=Pin,
        metavar=("NAME", "REVISION", "DATE"),
        help="origin of a folder, in the order of the folders",
    )
