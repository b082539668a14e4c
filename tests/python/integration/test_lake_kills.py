"""Runs that add to a lake or merge its files, killed at random moments: some of what `python -m lake_kills` tries."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("deltalake")
pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
TESTS = Path(__file__).parents[1]


def test_a_lake_survives_kills() -> None:
    # A process of its own: one that forks must not have used deltalake.
    made = subprocess.run(
        [sys.executable, "-m", "lake_kills", "--kills", "10"],
        cwd=TESTS, capture_output=True, text=True, check=False, timeout=280,
    )  # fmt: skip
    assert made.returncode == 0, made.stderr[-3000:]
    assert "no row lost, none twice" in made.stdout
