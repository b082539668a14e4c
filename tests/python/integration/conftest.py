"""What every integration test begins with."""

from __future__ import annotations

import pytest


@pytest.fixture(autouse=True)
def no_dialect_in_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    """pymavlink keeps the dialect that a test chose in the environment, which programs would inherit."""
    monkeypatch.delenv("MAVLINK_DIALECT", raising=False)
