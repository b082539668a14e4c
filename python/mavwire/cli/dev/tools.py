"""Give the tools the names of pymavlink's scripts: `mavlogdump.py`, `mavparms.py` and so on.

The scripts go to DIR, or to the environment's own folder of scripts. A file there that is not mavwire's, such
as pymavlink's own script, is left alone; --uninstall removes what --install wrote and nothing else.
"""

from __future__ import annotations

import os
import shlex
import sys
import sysconfig
from argparse import ArgumentParser, Namespace

from mavwire._atomic_file import replace_text
from mavwire.cli import COMMANDS
from mavwire.cli._errors import tell

MARK = '# Written by "mavwire tools --install"; "mavwire tools --uninstall" removes it.'
# A mark further down is not that of a script which was written here.
MARK_WITHIN = 8192
# Some kernels take no more of a first line.
MOST_SHEBANG = 120


def add_arguments(parser: ArgumentParser) -> None:
    parser.add_argument(
        "folder", metavar="DIR", nargs="?", help="(default: the environment's folder of scripts)"
    )
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--install", action="store_true", help="write the scripts")
    what.add_argument("--uninstall", action="store_true", help="remove them")
    what.add_argument("--status", action="store_true", help="tell which of them there are")


def main(args: Namespace) -> int:
    """Run the subcommand; 1 if a script could not be written because another file is there."""
    folder = args.folder or sysconfig.get_path("scripts")
    if args.install:
        return _install(folder)
    if args.uninstall:
        own = _own(folder)
        for name in own:
            os.remove(os.path.join(folder, name))
        print(f"{len(own)} scripts removed from {folder}")
        return 0
    _status(folder)
    return 0


def scripts() -> dict[str, str]:
    """Name of the script -> name of the subcommand."""
    return {f"{script}.py": name for name, (_, script, _) in COMMANDS.items() if script}


def _install(folder: str) -> int:
    os.makedirs(folder, exist_ok=True)
    written, foreign = 0, []
    for name, verb in scripts().items():
        path = os.path.join(folder, name)
        if os.path.lexists(path) and not _is_own(path):
            foreign.append(name)
            continue
        replace_text(path, _script(verb), permissions=0o755)
        written += 1
    print(f"{written} scripts written to {folder}")
    if foreign:
        tell(
            f"mavwire tools: left alone, they are not mavwire's: {', '.join(sorted(foreign))};"
            " 'mavwire VERB' runs mavwire's all the same"
        )
    return 1 if foreign else 0


def _script(verb: str) -> str:
    return (
        f"{_launch(sys.executable)}"
        f"{MARK}\n"
        "import sys\n\n"
        "from mavwire.cli import main\n\n"
        f'sys.exit(main(["{verb}", *sys.argv[1:]]))\n'
    )


def _launch(interpreter: str) -> str:
    """The first lines of a script for this interpreter. The kernel cuts its path at a space and at some
    length. A shell starts such a path, and Python reads the line of the shell as a string.
    """
    if " " not in interpreter and len(interpreter) <= MOST_SHEBANG:
        return f"#!{interpreter}\n"
    return f"#!/bin/sh\n'''exec' {shlex.quote(interpreter)} \"$0\" \"$@\"\n' '''\n"


def _is_own(path: str) -> bool:
    """Whether `--install` wrote this file. A link is somebody else's, wherever it leads."""
    if os.path.islink(path) or not os.path.isfile(path):
        return False
    with open(path, "rb") as file:
        return MARK.encode() in file.read(MARK_WITHIN).splitlines()


def _own(folder: str) -> list[str]:
    """The scripts of ours that are in the folder, also those of an older mavwire."""
    if not os.path.isdir(folder):
        return []
    names = (name for name in os.listdir(folder) if name.endswith(".py"))
    return sorted(name for name in names if _is_own(os.path.join(folder, name)))


def _status(folder: str) -> None:
    own = _own(folder)
    for name, verb in sorted(scripts().items()):
        path = os.path.join(folder, name)
        if name in own:
            state = "mavwire's"
        else:
            state = "not mavwire's" if os.path.lexists(path) else "not there"
        print(f"{name:<32} {state:<14} mavwire {verb}")
