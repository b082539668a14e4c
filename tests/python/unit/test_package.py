"""What `import mavwire` gives."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import mavwire
import pytest
from mavwire.dialects import UPSTREAM


@pytest.mark.parametrize(
    "name",
    "aio bridge dialects expression fleet logs mavutil plots shadow sim tools traffic".split(),
)
def test_modules_need_no_import_of_their_own(name: str) -> None:
    program = f"import mavwire; assert {name!r} in dir(mavwire); print(mavwire.{name}.__name__)"
    done = subprocess.run(
        [sys.executable, "-c", program], check=False, capture_output=True, text=True
    )
    assert (done.returncode, done.stdout.strip()) == (0, f"mavwire.{name}"), done.stderr


def test_importing_it_imports_no_module_of_it() -> None:
    program = "import sys, mavwire; print([n for n in sys.modules if n.startswith('mavwire.')])"
    done = subprocess.run(
        [sys.executable, "-c", program], check=False, capture_output=True, text=True
    )
    assert done.stdout.strip() == "[]", done.stdout + done.stderr


def test_what_there_is_not_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="module 'mavwire' has no attribute 'fleets'"):
        mavwire.fleets  # noqa: B018


@pytest.mark.parametrize("folder", ["v10", "v20"])
def test_definitions_are_beside_the_dialects(folder: str) -> None:
    """Programs look for them by the place of the package, as they do in pymavlink."""
    source = Path(__file__).parents[3] / "message_definitions" / "v1.0"
    program = (
        "import mavwire; mavwire.install_as_pymavlink(); import os, pymavlink\n"
        f"print(os.path.join(os.path.dirname(pymavlink.__file__), 'dialects', {folder!r}))"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], check=True, capture_output=True, text=True
    )
    copies = {path.name: path.read_bytes() for path in Path(done.stdout.strip()).glob("*.xml")}
    assert copies == {path.name: path.read_bytes() for path in source.glob("*.xml")}
    dialects = {path.stem for path in Path(mavwire.__path__[0], "dialects", folder).glob("*.py")}
    assert {Path(name).stem for name in copies} == dialects - {"__init__", UPSTREAM}
