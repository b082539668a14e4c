"""Packages that import their modules when somebody asks for a name of them."""

from __future__ import annotations

import sys
from collections.abc import Callable
from importlib import import_module


def attributes(package: str, modules: dict[str, str]) -> Callable[[str], object]:
    """A `__getattr__` for `package`. `modules` maps a public name to its module, relative to the package."""

    def getattribute(name: str) -> object:
        if name not in modules:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        value: object = getattr(import_module(f"{package}.{modules[name]}"), name)
        setattr(sys.modules[package], name, value)  # so that it is asked for once
        return value

    return getattribute
