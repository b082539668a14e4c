"""What `import mavwire` gives."""

from __future__ import annotations

import subprocess
import sys

import mavwire
import pytest


@pytest.mark.parametrize("name", ["aio", "bridge", "fleet", "sim"])
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
