"""Show a message, an enum or a command; store MAVLink XML with descriptions.

The definitions that come with mavwire carry facts, and a line on what common messages are for. The
descriptions of upstream XML appear in docstrings, `enums` and here once they are stored: `sync`
copies a folder of it to the user's data folder, `status` shows what is stored there, `clear`
removes it.

examples:
  mavwire definitions show ATTITUDE
  mavwire definitions show 30
  mavwire definitions show MAV_STATE
  mavwire definitions show NAV_TAKEOFF
"""

from __future__ import annotations

import os
import shutil
import tempfile
from argparse import ArgumentParser, Namespace
from pathlib import Path

from mavwire.cli._errors import CommandError
from mavwire.dialects import UPSTREAM, _sources
from mavwire.dialects._descriptions import stored_folder


def add_arguments(parser: ArgumentParser) -> None:
    """`show NAME`, `sync DIR`, `status` or `clear`."""
    actions = parser.add_subparsers(dest="action", required=True, metavar="ACTION")
    show = actions.add_parser("show", help="fields of a message, values of an enum, a command")
    show.add_argument(
        "name", help="its name in any letter case, a command without MAV_CMD_, or a message id"
    )
    show.add_argument(
        "--dialect", default=UPSTREAM, help="whose definitions (default: %(default)s)"
    )
    sync = actions.add_parser("sync", help="store the *.xml files of a folder")
    sync.add_argument("folder", type=Path, help="folder with *.xml, or one above v1.0/")
    actions.add_parser("status", help="show what is stored")
    actions.add_parser("clear", help="remove what is stored")


def main(args: Namespace) -> int:
    """0; CommandError says what is wrong with the name, the folder or a file."""
    if args.action == "show":
        print(show(args.name, args.dialect))
    elif args.action == "sync":
        count = sync(args.folder)
        print(f"{count} definition files stored in {stored_folder()}")
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


def show(name: str, dialect: str) -> str:
    """What the dialect has under this name, as text."""
    from mavwire import mavutil
    from mavwire.cli._reading import definitions
    from mavwire.cli.dev._definition_text import describe

    with definitions(dialect, "2.0"):
        return describe(mavutil.mavlink, name)


def sync(folder: Path) -> int:
    """Checks every definition file of `folder` and stores them all, or none if one is wrong."""
    files = _definition_files(folder)
    for file in files:
        _check(file)
    target = stored_folder()
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=target.parent, prefix="definitions-") as folder_name:
            staging = Path(folder_name) / target.name
            staging.mkdir()
            for file in files:
                shutil.copyfile(file, staging / file.name)
            shutil.rmtree(target, ignore_errors=True)
            os.replace(staging, target)
    except OSError as error:
        raise CommandError(f"cannot write {target}: {error.strerror}") from None
    return len(files)


def _definition_files(folder: Path) -> list[Path]:
    if (folder / "v1.0").is_dir():
        folder /= "v1.0"
    if not folder.is_dir():
        raise CommandError(f"{folder} is not a folder; name the one that holds the *.xml files")
    files = sorted(folder.glob("*.xml"))
    if not files:
        raise CommandError(f"{folder} holds no *.xml files")
    return files


def _check(file: Path) -> None:
    """Refuses a file that is no MAVLink definition, before anything is stored."""
    from mavwire._native import DefinitionError, describe

    try:
        main_name, sources = _sources.collect(file, None)
        describe(main_name, sources)
    except (DefinitionError, ValueError, OSError) as error:
        raise CommandError(f"nothing stored: {error}") from None


def _status() -> str:
    files = sorted(stored_folder().glob("*.xml"))
    if not files:
        return f"nothing stored in {stored_folder()}; see `mavwire definitions sync --help`"
    names = ", ".join(file.stem for file in files)
    return f"{len(files)} definition files in {stored_folder()}: {names}"
