"""Real logs for tests: the files of the directory that MAVWIRE_LOGS names, or of `logs` in a
directory `shared` beside the checkout.
"""

from __future__ import annotations

import os
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
LOGS = Path(os.environ.get("MAVWIRE_LOGS", ROOT.parent / "shared" / "logs"))


def logs(*patterns: str) -> list[Path]:
    """The logs that have such a name."""
    return sorted(path for pattern in patterns for path in LOGS.glob(pattern))


def each_log(*patterns: str) -> pytest.MarkDecorator:
    """Run a test with each log that has such a name as its argument `path`; where there is none the
    test is skipped and says what it wants.
    """
    found = logs(*patterns)
    if found:
        return pytest.mark.parametrize("path", found, ids=lambda path: path.name)
    notice = f"no {' or '.join(patterns)} in {LOGS}: set MAVWIRE_LOGS to a directory of logs"
    return pytest.mark.parametrize("path", [pytest.param(None, marks=pytest.mark.skip(notice))])
