"""Show a message, an enum or a command; compare, update and describe definitions.

Without an action it says which definitions are in use. `show` prints one message, enum or command. `diff` compares two
dialects, XML files or folders. `update` puts newer definitions in front of those of the dialect `upstream`, the default
of everything but `mavutil`; `update --revert` goes back.

The definitions that come with mavwire carry facts, and a line on what common messages are for. The descriptions of
upstream XML appear in docstrings, `enums`, MCAP files, the page of the bridge and here once they are stored: `sync`
copies them to the user's data folder from folders or from an installed pymavlink, and `clear` removes them. `stubs` writes
type stubs that have them.

examples:
  mavwire definitions show ATTITUDE
  mavwire definitions show 30
  mavwire definitions show NAV_TAKEOFF
  mavwire definitions diff common ardupilotmega
  mavwire definitions diff upstream path/to/mavlink
  mavwire definitions update https://github.com/mavlink/mavlink/archive/refs/heads/master.zip
  mavwire definitions sync path/to/mavlink path/to/ardupilot
"""

from __future__ import annotations

import json
import os
import shutil
import tempfile
import tomllib
from argparse import ArgumentParser, Namespace
from datetime import date
from pathlib import Path
from sysconfig import get_path
from typing import Any

from mavwire import dialects
from mavwire._atomic_file import replacing
from mavwire._native import DefinitionError, Dialect, definition_sources, describe
from mavwire._text import no_such_dialect
from mavwire.cli._errors import CommandError, refused
from mavwire.cli._shared_arguments import add_shared
from mavwire.dialects import UPSTREAM, _installed, _sources
from mavwire.dialects._descriptions import installed_folder, stored_folder


def add_arguments(parser: ArgumentParser) -> None:
    """An action, or none for `status`."""
    parser.set_defaults(action="status")
    actions = parser.add_subparsers(dest="action", metavar="ACTION")
    show = actions.add_parser("show", help="fields of a message, values of an enum, a command")
    show.add_argument(
        "name", help="its name in any letter case, a command without MAV_CMD_, or a message id"
    )
    add_shared(show, "any_dialect")
    diff = actions.add_parser("diff", help="what was added, removed and changed between two sets")
    for name in ("old", "new"):
        diff.add_argument(name, help="a built-in dialect, an XML file or a folder of them")
    diff.add_argument("--json", action="store_true", help="print JSON")
    _add_stores(actions)
    actions.add_parser("status", help="say which definitions and descriptions are in use")
    actions.add_parser("clear", help="remove the stored descriptions")


def _add_stores(actions: Any) -> None:
    """The actions that write files."""
    update = actions.add_parser("update", help="install newer definitions")
    update.add_argument(
        "sources",
        nargs="*",
        metavar="DIR-or-URL",
        help="a checkout, a folder or archive of XML files, or an https address of an archive or XML file; "
        "of several the first one counts",
    )
    update.add_argument("--revert", action="store_true", help="go back to the definitions before")
    sync = actions.add_parser("sync", help="store the descriptions of the *.xml files of folders")
    sync.add_argument(
        "folders",
        type=Path,
        nargs="*",
        metavar="DIR",
        help="a checkout or folder of XML files; of several the first one counts (default: that of an installed pymavlink)",
    )
    stubs = actions.add_parser("stubs", help="write type stubs with descriptions for editors")
    stubs.add_argument(
        "folder",
        type=Path,
        nargs="?",
        default=Path(get_path("purelib")),
        help="where packages are (default: those of this environment)",
    )


def main(args: Namespace) -> int:
    """0; CommandError says what is wrong with the name, the folder or a file."""
    if args.action == "show":
        print(show(args.name, args.dialect))
    elif args.action == "diff":
        print(diff(args.old, args.new, args.json))
    elif args.action == "update":
        print(revert() if args.revert else update(args.sources))
    elif args.action == "sync":
        count = sync(args.folders)
        print(f"{count} definition files stored in {stored_folder()}")
    elif args.action == "stubs":
        from mavwire.cli.dev import _described_stubs

        count = _described_stubs.write(args.folder)
        print(f"{count} described messages in {args.folder / _described_stubs.PACKAGE}")
    elif args.action == "clear":
        _clear(stored_folder())
        print(f"{stored_folder()} removed")
    else:
        print(_status())
    return 0


def _clear(folder: Path) -> None:
    if folder.is_symlink():  # which `rmtree` refuses; where it leads is not ours
        folder.unlink()
    elif folder.exists():
        shutil.rmtree(folder)


def show(name: str, dialect: str | list[str]) -> str:
    """The definition with this name in the dialect, or in the first of several, as text."""
    from mavwire import mavutil
    from mavwire.cli._reading import definitions
    from mavwire.cli.dev._definition_text import describe

    with definitions(dialect, "2.0"):
        return describe(mavutil.mavlink, name)


def diff(old: str, new: str, as_json: bool) -> str:
    """The differences of two sets of definitions."""
    from mavwire.cli.dev._definition_facts import as_text, changes, of_set

    for name in (old, new):
        if name not in dialects.names() and not os.path.exists(name):
            raise CommandError(no_such_dialect(name))
    with refused(OSError, DefinitionError):
        difference = changes(of_set(old), of_set(new))
    if as_json:
        return json.dumps(difference, indent=2)
    return as_text(difference) or "no difference"


def update(sources: list[str]) -> str:
    """Install newer definitions, if they make a dialect; a line about them, and the differences."""
    from mavwire.cli.dev._definition_facts import as_text, changes, of_sets
    from mavwire.cli.dev._definition_fetch import fetch

    if not sources:
        raise CommandError("name a folder, an archive or an https address, or say --revert")
    archive = Path(_installed.archive())
    before = _installed.read(str(archive))[0] if _installed.dialect("2.0") else []
    try:
        sets, days = zip(*map(fetch, sources), strict=True)
        for wire in ("1.0", "2.0"):
            Dialect.upstream_with([*sets], wire)
        old, new = of_sets(before, with_upstream=True), of_sets([*sets], with_upstream=True)
    except DefinitionError as error:
        raise CommandError(f"nothing installed: {error}") from None
    newest = max(filter(None, days), default=None)
    facts = {
        "sources": [one if "://" in one else os.path.abspath(one) for one in sources],
        "newest": newest and newest.isoformat(),
        "installed": date.today().isoformat(),
    }
    archive.parent.mkdir(parents=True, exist_ok=True)
    if archive.is_file():
        with replacing(_installed.previous()) as file:
            file.write(archive.read_bytes())
    with replacing(archive) as file:
        file.write(_installed.packed(sets, facts))
    difference = as_text(changes(old, new)) or "no difference"
    return f"installed in {archive}: {UPSTREAM} has {len(new.messages)} messages now\n{difference}"


def revert() -> str:
    """Go back to the definitions before the last update."""
    archive, previous = Path(_installed.archive()), Path(_installed.previous())
    if previous.is_file():
        os.replace(previous, archive)
    elif os.path.lexists(archive):
        archive.unlink()
    else:
        raise CommandError("no definitions are installed")
    return _in_use()


def sync(folders: list[Path]) -> int:
    """Checks every definition file of the folders and stores them all, or none if one is wrong."""
    from mavwire.cli.dev._definition_facts import definition_files

    folders = folders or [one for one in [installed_folder()] if one is not None]
    if not folders:
        raise CommandError("pymavlink is not installed: name a folder of XML files")
    with refused(OSError):
        files = [
            (f"{number:03}", file)
            for number, folder in enumerate(folders)
            for file in definition_files(folder)
        ]
    for _, file in files:
        _check(file)
    target = stored_folder()
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=target.parent, prefix="definitions-") as folder_name:
            staging = Path(folder_name) / target.name
            staging.mkdir()
            for number, file in files:
                (staging / number).mkdir(exist_ok=True)
                shutil.copyfile(file, staging / number / file.name)
            shutil.rmtree(target, ignore_errors=True)
            os.replace(staging, target)
    except OSError as error:
        raise CommandError(f"cannot write {target}: {error.strerror}") from None
    return len(files)


def _check(file: Path) -> None:
    """Refuses a file that is no MAVLink definition, before anything is stored."""
    try:
        describe(*_sources.collect(file, None))
    except (ValueError, OSError) as error:
        raise CommandError(f"nothing stored: {error}") from None


def _status() -> str:
    pins = tomllib.loads(definition_sources())
    rows = [
        f"{name} {row['revision'][:12]} ({row['date']})"
        for name, row in pins.items()
        if "date" in row
    ]
    files = sorted(stored_folder().glob("*/*.xml"))
    names = ", ".join(dict.fromkeys(file.stem for file in files))
    stored = f"{len(files)} definition files in {stored_folder()}: {names}"
    missing = f"nothing stored in {stored_folder()}; see `mavwire definitions sync --help`"
    return "\n".join(
        [f"built in: {', '.join(rows)}", _in_use(), f"descriptions: {stored if files else missing}"]
    )


def _in_use() -> str:
    """Which definitions the dialect `upstream` has."""
    archive = _installed.archive()
    if _installed.dialect("2.0") is None:
        return f"{UPSTREAM}: built in"
    facts = _installed.read(archive)[1]
    newest = f", files up to {facts['newest']}" if facts.get("newest") else ""
    sources = " ".join(facts["sources"])
    return (
        f"{UPSTREAM}: built in and {sources}{newest}, installed {facts['installed']} in {archive}"
    )
