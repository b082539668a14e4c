"""The installed pymavlink, as a private copy that nobody else sees.

It is imported past the alias that may stand in its place, and taken out of `sys.modules` again: its
globals are set to what the program sets in mavwire's module, which must not reach a pymavlink that
the program itself uses, and `install_as_pymavlink()` must find the name free.
"""

from __future__ import annotations

import logging
import sys
import threading
from types import ModuleType

from mavwire import _alias

PACKAGE = "pymavlink"

_modules: dict[str, ModuleType] = {}
_lock = threading.Lock()


def counterpart(name: str) -> ModuleType | None:
    """pymavlink's module for a built-in dialect module of mavwire's, None if it has none.

    ImportError where pymavlink is not installed.
    """
    with _lock:
        theirs = PACKAGE + name.removeprefix("mavwire")
        module = _modules.get(theirs) or _import_privately(theirs)
    if module is not None:
        module.__dict__["logger"] = _silent_logger()
    return module


def _import_privately(name: str) -> ModuleType | None:
    from importlib import import_module

    visible = _take_from_sys()
    finders = list(sys.meta_path)
    if _alias.is_installed():
        sys.meta_path.remove(_alias._finder)
    sys.modules.update(_modules)
    try:
        return import_module(name)
    except ModuleNotFoundError as error:
        if error.name == name:
            return None
        raise ImportError(
            f"MAVWIRE_SHADOW={PACKAGE} is set, but {PACKAGE} cannot be imported ({error}): "
            f"pip install {PACKAGE}, or unset the variable",
            name=error.name,
        ) from error
    finally:
        _modules.update(_take_from_sys())
        sys.modules.update(visible)
        sys.meta_path[:] = finders


def _take_from_sys() -> dict[str, ModuleType]:
    names = [name for name in list(sys.modules) if name.partition(".")[0] == PACKAGE]
    return {name: sys.modules.pop(name) for name in names}


def _silent_logger() -> logging.Logger:
    """A logger without output: mavwire has logged the traffic already."""
    logger = logging.Logger("mavwire.shadow")
    logger.disabled = True
    return logger
