"""Tools as programs under the names of pymavlink's scripts: `python -m mavwire.tools.mavparms`."""

from __future__ import annotations

import os
import sys
from typing import NoReturn


def run(file: str) -> NoReturn:
    """Run the tool whose module this file is, with the arguments of the process, and end it."""
    from mavwire.cli import main
    from mavwire.cli.dev.tools import scripts

    sys.exit(main([scripts()[os.path.basename(file)], *sys.argv[1:]]))
