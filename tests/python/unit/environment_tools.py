"""Throw-away virtual environments that can import mavwire."""

from __future__ import annotations

import os
import subprocess
import venv
from pathlib import Path

import mavwire

PACKAGE_FOLDER = str(Path(mavwire.__file__).parent.parent)


class Environment:
    """A virtual environment that can import mavwire."""

    def __init__(self, folder: Path) -> None:
        venv.create(folder, with_pip=False)
        self.python = str(folder / "bin" / "python")
        self.site_packages = next((folder / "lib").glob("python*")) / "site-packages"
        self.mavwire_pth = self.site_packages / "mavwire.pth"
        self.mavwire_pth.write_text(PACKAGE_FOLDER)
        self.alias_pth = self.site_packages / "zz_mavwire_alias.pth"

    def run(self, *arguments: str, **variables: str) -> subprocess.CompletedProcess[str]:
        clean = {k: v for k, v in os.environ.items() if not k.startswith("PYTHON")}
        return subprocess.run(
            [self.python, *arguments],
            capture_output=True, text=True, env=clean | variables, timeout=60, check=False,
        )  # fmt: skip

    def alias(self, action: str, **variables: str) -> subprocess.CompletedProcess[str]:
        return self.run("-m", "mavwire", "alias", action, **variables)
