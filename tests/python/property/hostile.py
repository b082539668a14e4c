"""How the boundary to Python is fuzzed: the same examples each time, or with MAVWIRE_EXAMPLES that many others."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress

from hypothesis import HealthCheck, settings
from watchdog import watched

WANTED = os.environ.get("MAVWIRE_EXAMPLES")
PROFILE = settings(
    max_examples=int(WANTED or 60),
    derandomize=WANTED is None,
    database=None,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.function_scoped_fixture],
)
# What an argument of a wrong type or value may raise. A panic of the native code, SystemError and
# RecursionError are none of these.
ORDINARY = (TypeError, ValueError, AttributeError, LookupError, OverflowError)


@contextmanager
def ordinary(*others: type[Exception]) -> Iterator[None]:
    """Lets ordinary exceptions pass, and nothing go on for ever."""
    with watched(), suppress(*ORDINARY, *others):
        yield
