#!/usr/bin/env python3
"""Check a wheel as it will be released: its tags and contents, its symbols, and that it works.

    tools/check_wheel.py dist/mavwire-0.1.0-cp311-abi3-*.whl

The wheel goes into a virtual environment of its own, without any index and with nothing on the path
that could compile, and has to make, read and convert a log there, and fly a simulated vehicle.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
import venv
import zipfile
from pathlib import Path

SMOKE = Path(__file__).with_name("wheel_smoke.py")
NEEDED = (
    "mavwire/__init__.py",
    "mavwire/py.typed",
    "mavwire/_native.pyi",
    "mavwire/_data/summaries.toml",
    "mavwire/_data/earth_field.json",
    "mavwire/bridge/inspector.html",
    "mavwire/plots/_assets/chart.js",
    "mavwire/dialects/v20/ardupilotmega.pyi",
    "mavwire/dialects/v10/common.xml",
    "mavwire/dialects/v20/common.xml",
)
NATIVE = re.compile(r"mavwire/_native(\.abi3\.so|\.pyd)")
LICENCES = re.compile(r"[^/]+\.dist-info/licenses/LICENSE-(APACHE|MIT)")
ALLOWED = re.compile(
    r"mavwire/.+\.(pyi?|json|toml|js|css|html|xml)|mavwire/py\.typed|[^/]+\.dist-info/.+"
)


def main() -> int:
    """0; SystemExit says what is wrong."""
    if len(sys.argv) != 2:
        raise SystemExit("usage: check_wheel.py WHEEL")
    wheel = Path(sys.argv[1])
    check_name(wheel.name)
    with zipfile.ZipFile(wheel) as archive:
        check_contents(archive.namelist())
    check_symbols(wheel)
    check_install(wheel)
    print(f"{wheel.name}: {wheel.stat().st_size / 1e6:.1f} MB, stable ABI only, works")
    return 0


def check_name(name: str) -> None:
    """One wheel serves CPython 3.11 and all that follow."""
    if not re.fullmatch(r"mavwire-[^-]+-cp311-abi3-[\w.]+\.whl", name):
        raise SystemExit(f"{name}: not a wheel for the stable ABI of CPython 3.11")


def check_contents(names: list[str]) -> None:
    """Everything that is needed, and nothing that is not."""
    missing = sorted(set(NEEDED) - set(names))
    if missing:
        raise SystemExit(f"missing: {', '.join(missing)}")
    if sum(bool(NATIVE.fullmatch(name)) for name in names) != 1:
        raise SystemExit("there must be exactly one extension module")
    if sum(bool(LICENCES.fullmatch(name)) for name in names) != 2:
        raise SystemExit("the licences are missing")
    foreign = [name for name in names if not (ALLOWED.fullmatch(name) or NATIVE.fullmatch(name))]
    if foreign:
        raise SystemExit(f"not to be in it: {', '.join(foreign)}")


def check_symbols(wheel: Path) -> None:
    """Nothing outside the stable ABI is used."""
    subprocess.run([sys.executable, "-m", "abi3audit", "--strict", wheel], check=True)


def check_install(wheel: Path) -> None:
    """Install it where nothing else is, and use it."""
    with tempfile.TemporaryDirectory(prefix="mavwire-wheel-") as folder:
        home = Path(folder) / "env"
        venv.create(home, with_pip=True)
        scripts = home / ("Scripts" if os.name == "nt" else "bin")
        environment = {
            name: value
            for name, value in os.environ.items()
            if not name.startswith(("PYTHON", "PYO3", "CARGO", "RUST", "VIRTUAL_ENV"))
        }
        system = [] if os.name != "nt" else [str(Path(os.environ["SYSTEMROOT"]) / "System32")]
        environment["PATH"] = os.pathsep.join([str(scripts), *system])
        python = str(scripts / "python")
        for command in (
            [python, "-m", "pip", "--quiet", "--disable-pip-version-check", "install", "--no-index", str(wheel.resolve())],
            [python, str(SMOKE)],
        ):  # fmt: skip
            subprocess.run(command, check=True, cwd=folder, env=environment)


if __name__ == "__main__":
    sys.exit(main())
