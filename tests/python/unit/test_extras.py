"""What the tests skip for want of a package is said, and not skipped where all of them have to run."""

from __future__ import annotations

import os
import re
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import pytest

REQUIREMENTS = Path(__file__).parents[3] / "requirements" / "test.txt"


def is_missing(name: str) -> bool:
    try:
        version(name)
    except PackageNotFoundError:
        return True
    return False


def test_packages_without_which_tests_are_skipped_are_there():
    lines = REQUIREMENTS.read_text().splitlines()
    names = [re.split(r"[=<>\[ ]", line)[0] for line in lines if line and line[0] not in "#-"]
    assert len(names) > 10
    missing = [name for name in names if is_missing(name)]
    if missing and not os.environ.get("CI"):
        pytest.skip(f"tests that need them are skipped: {', '.join(missing)}")
    assert not missing, "install requirements/test.txt"
