"""Modules of which programs may replace names, as in pymavlink.

pymavlink looks up the names of its modules at each use. So `mavutil.time = clock` or
`monkeypatch.setattr(DFReader, "DFFormat", Mine)` has an effect there. mavwire's public modules import
their names from other modules, some of which are native. A `ReplaceableModule` therefore replaces a name
in all modules that use it. If no module looks the name up, it warns. Programs that replace nothing pay
nothing for this.

Links import `monotonic` by name for their time-outs (`from time import monotonic`). So `mavutil.time = clock`
does not move time-outs: with a clock that never advances they would never end.
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
    """A module of which programs may replace names."""

    # Modules and packages that use the names.
    _users: ClassVar[tuple[str, ...]] = ()
    # Name -> advice for a name whose replacement has no effect.
    _not_called: ClassVar[dict[str, str]] = {}
    # Name -> function to call with the new value, and whether it is the original.
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
        """Restore the original. mock.patch deletes names that the module makes at their first use."""
        replacement = vars(self).get(name, _ABSENT)
        super().__delattr__(name)
        original = vars(self).get("_originals", {}).get(name, _ABSENT)
        if original is not _ABSENT and original is not replacement:
            self._use(name, replacement, original, True)

    def _use(self, name: str, before: Any, value: Any, is_original: bool) -> None:
        """Make the modules behind this one use `value` instead of `before`."""
        # All are imported before the first is changed: their classes may derive from the original.
        for names in list(self._namespaces()):
            if names.get(name) is before:
                names[name] = value
        if name in self._callbacks:
            self._callbacks[name](value, is_original)

    def _namespaces(self) -> Iterator[dict[str, Any]]:
        for user in self._users:
            module = _import(user)
            yield vars(module)
            for inner in _modules_of(module):
                yield vars(_import(inner))


# The advice for standard modules, which pymavlink's modules have as attributes.
IN_STANDARD_MODULE = (
    "replace the function in the module itself, as in monkeypatch.setattr('time.time', ...)"
)


def make_replaceable(module: ModuleType, kind: type[ReplaceableModule]) -> None:
    """Make a module notice the replacement of its names."""
    kind.__name__ = kind.__qualname__ = ModuleType.__name__
    module.__class__ = kind


def quick_methods(cls: Any, base: type | None = None) -> list[tuple[type | None, str, Any]]:
    """The methods of `cls` that native code skips, and those of a `base` that `cls` overrides.

    Native code compares them with the methods of each new object, and calls those that a program replaced.
    """
    names = cls._QUICK_METHODS
    methods = [(None, name, getattr(cls, name)) for name in names if hasattr(cls, name)]
    hidden = [(base, name, getattr(base, name)) for name in names if hasattr(base, name)]
    return [*methods, *hidden]


def warn_not_called(name: str, advice: str) -> None:
    """Warn that a replacement is not called, and say what to do."""
    import warnings

    text = f"{name} was replaced, and mavwire does not call it: {advice}"
    warnings.warn(text, RuntimeWarning, stacklevel=3)


def _import(name: str) -> ModuleType:
    __import__(name)
    return sys.modules[name]


def _modules_of(package: ModuleType) -> Iterator[str]:
    """The names of the modules of a package."""
    import pkgutil

    for found in pkgutil.iter_modules(getattr(package, "__path__", [])):
        yield f"{package.__name__}.{found.name}"
