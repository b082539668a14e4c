"""Let mavwire answer "import pymavlink" for every program of this Python environment.

One line in a .pth file of the environment's site-packages does it; nothing is changed in an
installed pymavlink, and --disable brings it back.
"""

from __future__ import annotations

import os
import site
import subprocess
import sys
import sysconfig
from argparse import ArgumentParser, Namespace
from collections.abc import Callable

from mavwire._alias import COMPATIBLE_VERSION
from mavwire._atomic_file import replace_text
from mavwire.cli._errors import CommandError

# Read in alphabetical order; files that add folders to sys.path, such as an editable install's,
# come first.
PTH_NAME = "zz_mavwire_alias.pth"

# One line, or site.py would not run it. It hides errors: Python would report them at each start, also
# after mavwire is uninstalled. --status finds them.
PTH_LINE = (
    'import sys; exec("try:\\n from mavwire._alias import install_for_environment as _install'
    '\\n _install()\\nexcept Exception:\\n pass", {})\n'
)

_PROBE = """
try:
    import pymavlink
except ImportError:
    print("none")
else:
    loader = type(pymavlink.__loader__).__module__
    if loader == "mavwire._alias":
        print("mavwire")
    else:
        version = getattr(pymavlink, "__version__", "of unknown version")
        print("pymavlink", version, "from", pymavlink.__file__)
"""


def add_arguments(parser: ArgumentParser) -> None:
    """One action, and where."""
    action = parser.add_mutually_exclusive_group(required=True)
    action.add_argument("--enable", dest="action", action="store_const", const=enable)
    action.add_argument("--disable", dest="action", action="store_const", const=disable)
    action.add_argument(
        "--status",
        dest="action",
        action="store_const",
        const=status,
        help="say what 'import pymavlink' gives; exit code 0 when it is mavwire, else 1",
    )
    parser.add_argument(
        "--user", action="store_true", help="the user's site-packages instead of the environment's"
    )


def main(args: Namespace) -> int:
    """Do what was asked; 0 when ``import pymavlink`` is afterwards what was asked for."""
    action: Callable[[str], int] = args.action
    return action(_folder(args.user))


def enable(folder: str) -> int:
    """Write the file and prove that it works."""
    path = os.path.join(folder, PTH_NAME)
    try:
        replace_text(path, PTH_LINE)
    except OSError as error:
        raise CommandError(_cannot("write", path, error)) from None
    return status(folder)


def disable(folder: str) -> int:
    """Remove the file and say what is imported then."""
    path = os.path.join(folder, PTH_NAME)
    try:
        os.unlink(path)
        print(f"removed {path}")
    except FileNotFoundError:
        print(f"not enabled: there is no {path}")
    except OSError as error:
        raise CommandError(_cannot("remove", path, error)) from None
    what = _what_pymavlink_is()
    print(_describe(what))
    return 1 if what == "mavwire" else 0


def status(folder: str) -> int:
    """Say where the alias is enabled and what a fresh interpreter really imports."""
    enabled = [path for path in _known_files(folder) if os.path.exists(path)]
    for path in enabled:
        print(f"enabled by {path}")
    if not enabled:
        print("not enabled")
    what = _what_pymavlink_is()
    print(_describe(what))
    if enabled and what.startswith("pymavlink"):
        print("PYTHONPATH names the folder of this pymavlink, so Python finds it before the alias")
    elif enabled and what != "mavwire":
        print(
            "the file has no effect: can this interpreter import mavwire, "
            "and does it read its site-packages?"
        )
    return 0 if what == "mavwire" else 1


def _folder(user: bool) -> str:
    """The folder whose .pth files the interpreter reads at start."""
    if user:
        if not site.ENABLE_USER_SITE:
            raise CommandError("this interpreter does not read the user's site-packages")
        folder = site.getusersitepackages()
        os.makedirs(folder, exist_ok=True)
        return folder
    folder = sysconfig.get_path("purelib")
    read = site.getsitepackages()
    return folder if folder in read or not read else read[0]


def _known_files(folder: str) -> list[str]:
    folders = [folder, *site.getsitepackages()]
    if site.ENABLE_USER_SITE:
        folders.append(site.getusersitepackages())
    return [os.path.join(f, PTH_NAME) for f in dict.fromkeys(folders)]


def _what_pymavlink_is() -> str:
    """The module that a new interpreter of this environment imports. It searches this folder only if
    PYTHONPATH names it (-P).
    """
    command = [sys.executable, "-P", "-c", _PROBE]
    result = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    if result.returncode != 0:
        reason = result.stderr.strip().rpartition("\n")[2]
        raise CommandError(f"'import pymavlink' fails: {reason}")
    return result.stdout.strip()


def _describe(what: str) -> str:
    if what == "none":
        return "import pymavlink: there is no such module"
    if what == "mavwire":
        return f"import pymavlink: gives mavwire (as pymavlink {COMPATIBLE_VERSION})"
    return f"import pymavlink: gives {what}"


def _cannot(verb: str, path: str, error: OSError) -> str:
    return f"cannot {verb} {path}: {error.strerror}; use a virtual environment, or --user"
