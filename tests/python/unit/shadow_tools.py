"""What the tests of shadow mode share: dialect modules made anew with the shadow, and ways to break
them.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Iterator
from types import ModuleType
from typing import Any

import pytest

KEY = bytes(range(32))


@pytest.fixture
def shadowed(monkeypatch: pytest.MonkeyPatch, oracle: str) -> Iterator[Callable[[str], ModuleType]]:
    """Imports a dialect module ("v20.common") anew, with the shadow around it."""
    monkeypatch.setenv("MAVWIRE_SHADOW", oracle)

    def load(name: str) -> ModuleType:
        parent, _, child = f"mavwire.dialects.{name}".rpartition(".")
        package = importlib.import_module(parent)
        if child in vars(package):
            monkeypatch.setattr(package, child, getattr(package, child))
        monkeypatch.delitem(sys.modules, f"{parent}.{child}", raising=False)
        return importlib.import_module(f"{parent}.{child}")

    with monkeypatch.context():
        yield load


def inner_class(module: ModuleType) -> Any:
    """The `MAVLink` that the shadow watches, to be broken by the test."""
    return module.MAVLink.__mro__[1]


class Log(list[bytes]):
    """A file that keeps frames."""

    write = list.append
