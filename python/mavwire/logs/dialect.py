"""Dialects as arguments of readers."""

from __future__ import annotations

import os
from types import ModuleType
from typing import Any

Dialect = str | os.PathLike[str] | ModuleType
Dialects = Dialect | list[Dialect] | tuple[Dialect, ...]


def portable(dialect: Dialects) -> tuple[Any, bool]:
    """A dialect as another process finds it: a name, and whether it is that of a module to import.
    TypeError, as of what cannot be pickled, for a module that was made at run time.
    """
    if isinstance(dialect, list | tuple):
        return [portable(one) for one in dialect], False
    if isinstance(dialect, os.PathLike):
        return os.path.abspath(dialect), False
    if isinstance(dialect, str):
        return dialect, False
    if dialect.__name__.startswith("mavwire.dialects.loaded."):
        raise TypeError(f"{dialect.__name__} is of this process alone: give dialect= a path of XML")
    return dialect.__name__, True


def restored(name: Any, is_module: bool) -> Any:
    """The dialect that `portable` gave."""
    from importlib import import_module

    if isinstance(name, list):
        return [restored(*one) for one in name]
    return import_module(name) if is_module else name


def dialect_module(dialect: Dialects) -> Any:
    """The module of a dialect, as `open_log` takes it, or of several in a list or tuple: the first that knows
    an id names it. ValueError for any other argument; errors of an XML file as of `load`.
    """
    if hasattr(dialect, "MAVLink"):
        return dialect
    from mavwire._text import no_such_dialect
    from mavwire.dialects import load, merged
    from mavwire.links.state import load_dialect

    if isinstance(dialect, list | tuple) and dialect:
        return merged([dialect_module(one) for one in dialect])
    if isinstance(dialect, os.PathLike):
        return load(dialect)
    if not isinstance(dialect, str):
        raise ValueError(
            "a dialect is a name, the path of an XML file, a dialect module or a list of these,"
            f" not {dialect!r}"
        )
    if dialect.endswith(".xml") or os.sep in dialect:
        return load(dialect)
    try:
        return load_dialect(dialect, "2.0")
    except FileNotFoundError:
        raise ValueError(no_such_dialect(dialect)) from None
