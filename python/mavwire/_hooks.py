"""What programs replace in the modules and classes that pymavlink has too.

pymavlink looks a name of its modules up whenever it uses it, so `mavutil.time = clock` or
`monkeypatch.setattr(DFReader, "DFFormat", Mine)` has an effect there. mavwire's modules hold names of
what is implemented elsewhere, partly natively. A name that is replaced in a `ReplaceableModule` is
therefore replaced wherever its implementation looks that name up; a name that is not looked up at all
warns. Nothing is paid for that while nothing is replaced.
"""

from __future__ import annotations

import sys
from types import ModuleType

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from typing import Any, ClassVar

_ABSENT: Any = object()


class ReplaceableModule(ModuleType):
    """The class of modules of which programs may replace names."""

    # Modules, and packages with the modules in them, that use the names.
    _users: ClassVar[tuple[str, ...]] = ()
    # Name -> what to do instead of replacing it.
    _not_called: ClassVar[dict[str, str]] = {}
    # Name -> what is told of a new value, and whether it is the original one.
    _callbacks: ClassVar[dict[str, Callable[[Any, bool], None]]] = {}
    # Replaced names and their originals. Each module has its own.
    _originals: dict[str, Any]

    def __setattr__(self, name: str, value: Any) -> None:
        if name.startswith("_") or hasattr(type(self), name):
            super().__setattr__(name, value)
            return
        before = getattr(self, name, _ABSENT)
        super().__setattr__(name, value)
        original = vars(self).setdefault("_originals", {}).setdefault(name, before)
        if name in self._not_called and value is not original:
            warn_not_called(f"{self.__name__}.{name}", self._not_called[name])
        elif before is not _ABSENT and before is not value:
            self._use(name, before, value, value is original)

    def __delattr__(self, name: str) -> None:
        """Take a replacement back, as mock.patch does with a name that is made when it is first asked for."""
        replacement = vars(self).get(name, _ABSENT)
        super().__delattr__(name)
        original = vars(self).get("_originals", {}).get(name, _ABSENT)
        if original is not _ABSENT and original is not replacement:
            self._use(name, replacement, original, True)

    def _use(self, name: str, before: Any, value: Any, is_original: bool) -> None:
        """Let what is behind this module use `value` where it used `before`."""
        # All of them are imported before one is changed: classes derive from those that are replaced.
        for names in list(self._namespaces()):
            if names.get(name) is before:
                names[name] = value
        if name in self._callbacks:
            self._callbacks[name](value, is_original)

    def _namespaces(self) -> Iterator[dict[str, Any]]:
        for name in self._users:
            module = _import(name)
            yield vars(module)
            for inner in _modules_of(module):
                yield vars(_import(f"{name}.{inner}"))


# For standard modules that pymavlink's have as attributes.
IN_STANDARD_MODULE = (
    "replace the function in the module itself, as in monkeypatch.setattr('time.time', ...)"
)


def make_replaceable(module: ModuleType, kind: type[ReplaceableModule]) -> None:
    """Give a module the class that notices what is replaced in it."""
    kind.__name__ = kind.__qualname__ = ModuleType.__name__
    module.__class__ = kind


def quick_methods(cls: Any, base: type | None = None) -> list[tuple[type | None, str, Any]]:
    """The methods that native code stands for, as they are in `cls`, and in a `base` that it hides.

    Objects that are made while a program has others in their place are read by these others.
    """
    names = cls._QUICK_METHODS
    methods = [(None, name, getattr(cls, name)) for name in names if hasattr(cls, name)]
    hidden = [(base, name, getattr(base, name)) for name in names if hasattr(base, name)]
    return [*methods, *hidden]


def warn_not_called(name: str, advice: str) -> None:
    """Say that what a program replaces is not called, and what to do."""
    import warnings

    text = f"{name} was replaced, and mavwire does not call it: {advice}"
    warnings.warn(text, RuntimeWarning, stacklevel=3)


def _import(name: str) -> ModuleType:
    __import__(name)
    return sys.modules[name]


def _modules_of(package: ModuleType) -> list[str]:
    import pkgutil

    return [found.name for found in pkgutil.iter_modules(getattr(package, "__path__", []))]
