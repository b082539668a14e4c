"""The commands under the names of pymavlink's scripts: `python -m mavwire.tools.mavparms`.

`mavwire.cli.COMMANDS` tells their names. Each prints what the script prints, for the same options; docs/pymavlink-tools.md
says what differs.
"""

from __future__ import annotations

import sys
from importlib.util import spec_from_file_location

from mavwire.cli import COMMANDS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from importlib.machinery import ModuleSpec

_SCRIPTS = {f"{__name__}.{script}" for _, script, _ in COMMANDS.values() if script}


class _Finder:
    """Finds one program, `_script.py`, under the name of every script."""

    @staticmethod
    def find_spec(name: str, path: object = None, target: object = None) -> ModuleSpec | None:
        if name not in _SCRIPTS:
            return None
        return spec_from_file_location(name, f"{__path__[0]}/_script.py")


sys.meta_path.append(_Finder)
