"""Runs an installed pymavlink in its own process, to generate languages other than Python.

pymavlink is not imported here: it has another licence, and the alias gives its name to mavwire.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from mavwire._alias_metadata import installed_folder

__all__ = ["generate", "installed_folder"]

_PROGRAM = """
import json, sys
folder, options, files = json.loads(sys.argv[1])
alias = sys.modules.get("mavwire._alias")
if alias is not None:
    alias.uninstall_as_pymavlink()
sys.path.insert(0, folder)
from pymavlink.generator import mavgen
sys.exit(not mavgen.mavgen(mavgen.Opts(**options), files))
"""


def generate(folder: Path, options: dict[str, Any], filenames: Sequence[str]) -> bool:
    """Run the generator of the pymavlink in `folder`, with its output; return whether it succeeded."""
    task = json.dumps([str(folder), options, list(filenames)])
    # -P: a file in the current folder must not hide a module that pymavlink imports.
    command = [sys.executable, "-P", "-c", _PROGRAM, task]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    print(done.stdout, end="")
    print(done.stderr, end="", file=sys.stderr)
    return done.returncode == 0
