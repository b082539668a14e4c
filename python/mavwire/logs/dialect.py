"""Dialects as arguments of readers."""

from __future__ import annotations

import os
from types import ModuleType

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def portable(dialect: str | os.PathLike[str] | ModuleType) -> tuple[str, bool]:
    """A dialect as another process finds it: a name, and whether it is that of a module to import.
    TypeError, as of what cannot be pickled, for a module that was made at run time.
    """
    if isinstance(dialect, os.PathLike):
        return os.path.abspath(dialect), False
    if isinstance(dialect, str):
        return dialect, False
    if dialect.__name__.startswith("mavwire.dialects.loaded."):
        raise TypeError(f"{dialect.__name__} is of this process alone: give dialect= a path of XML")
    return dialect.__name__, True


def restored(name: str, is_module: bool) -> str | ModuleType:
    """The dialect that `portable` gave."""
    from importlib import import_module

    return import_module(name) if is_module else name


def dialect_module(dialect: str | os.PathLike[str] | ModuleType) -> Any:
    """The module of a dialect, as `open_log` takes it. ValueError for any other argument; errors
    of an XML file as of `load`.
    """
    if hasattr(dialect, "MAVLink"):
        return dialect
    from importlib import import_module

    from mavwire.dialects import load, names

    if isinstance(dialect, os.PathLike):
        return load(dialect)
    if not isinstance(dialect, str):
        raise ValueError(
            f"a dialect is a name, the path of an XML file or a dialect module, not {dialect!r}"
        )
    if dialect.endswith(".xml") or os.sep in dialect:
        return load(dialect)
    if dialect not in names():
        raise ValueError(f"no such dialect: {dialect!r}")
    return import_module(f"mavwire.dialects.v20.{dialect}")
