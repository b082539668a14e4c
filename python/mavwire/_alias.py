"""``import pymavlink`` gives mavwire: the finder behind ``install_as_pymavlink``, ``mavwire run``
and ``mavwire alias``.

A finder in front of ``sys.meta_path`` answers for ``pymavlink`` and everything below it.
``pymavlink.x`` is the very module object ``mavwire.x``, so classes, state and ``isinstance`` agree
whichever name a program uses, and pickles load under both. The package ``pymavlink`` itself is a
small module of its own, since its version is that of the pymavlink release mavwire is compatible
with.

This module is imported at interpreter start where the alias is enabled for an environment: it
imports nothing that the interpreter has not imported already.
"""

from __future__ import annotations

import sys
from _thread import RLock

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from importlib.machinery import ModuleSpec
    from importlib.metadata import Distribution, DistributionFinder
    from types import CodeType, ModuleType
    from typing import Any

__all__ = [
    "COMPATIBLE_VERSION",
    "AliasError",
    "install_as_pymavlink",
    "is_installed",
    "uninstall_as_pymavlink",
]

COMPATIBLE_VERSION = "2.4.50"
"""The pymavlink release whose behaviour mavwire has; what ``pymavlink.__version__`` says."""

_ALIAS = "pymavlink"
_REAL = "mavwire"
_lock = RLock()


class AliasError(ImportError):
    """The alias cannot be installed, because the real pymavlink is in use already."""


def install_as_pymavlink() -> None:
    """Make ``import pymavlink`` and ``import pymavlink.x`` give mavwire, in this process, from now
    on, wherever another pymavlink is.

    Calling it again does nothing. Raises :class:`AliasError` where pymavlink was imported before:
    its classes and mavwire's would live side by side in one program.
    """
    with _lock:
        foreign = [name for name in _loaded() if not _is_ours(name)]
        if foreign:
            module = sys.modules[foreign[0]]
            where = getattr(module, "__file__", None) or "unknown place"
            raise AliasError(
                f"{foreign[0]} is already imported (from {where}); call "
                "mavwire.install_as_pymavlink() before the first import of pymavlink, "
                "or start the program with: mavwire run",
                name=foreign[0],
            )
        _finder.gives_way = False
        if _finder not in sys.meta_path:
            sys.meta_path.insert(0, _finder)


def install_for_environment() -> None:
    """Install the alias for an environment. A pymavlink that comes before the installed packages on
    ``sys.path`` is imported nevertheless: a source tree that brings its own needs that one.
    """
    install_as_pymavlink()
    _finder.gives_way = True


def uninstall_as_pymavlink() -> None:
    """Undo :func:`install_as_pymavlink`; what a program has imported already stays as it is."""
    with _lock:
        if _finder in sys.meta_path:
            sys.meta_path.remove(_finder)
        for name in _loaded():
            if _is_ours(name):
                del sys.modules[name]


def is_installed() -> bool:
    """Whether ``import pymavlink`` gives mavwire."""
    return _finder in sys.meta_path


def _loaded() -> list[str]:
    return [name for name in list(sys.modules) if name.partition(".")[0] == _ALIAS]


def _is_ours(name: str) -> bool:
    module = sys.modules[name]
    if name == _ALIAS:
        return isinstance(getattr(module, "__loader__", None), _PackageLoader)
    return module is sys.modules.get(_real_name(name))


def _real_name(name: str) -> str:
    return _REAL + name[len(_ALIAS) :]


def _another_comes_first() -> bool:
    """Whether a pymavlink is on ``sys.path`` in front of the installed packages."""
    import os
    import site
    from importlib.machinery import PathFinder

    folders = [*site.getsitepackages(), site.getusersitepackages()]
    installed = {os.path.normcase(os.path.abspath(folder)) for folder in folders}
    front = []
    for entry in sys.path:
        if os.path.normcase(os.path.abspath(entry)) in installed:
            break
        front.append(entry)
    spec = PathFinder.find_spec(_ALIAS, front)
    return spec is not None and spec.origin is not None  # a folder without __init__.py has none


class _Finder:
    """Answers ``pymavlink`` and below; other imports cost one comparison."""

    gives_way = False

    def find_spec(
        self, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if name == _ALIAS:
            return None if self._must_give_way() else _package_spec()
        if name.startswith(_ALIAS + ".") and (_ALIAS not in sys.modules or _is_ours(_ALIAS)):
            return _module_spec(name)
        return None

    def _must_give_way(self) -> bool:
        return self.gives_way and _another_comes_first()

    def find_distributions(
        self, context: DistributionFinder.Context | None = None
    ) -> Iterator[Distribution]:
        """The answer to ``importlib.metadata.version("pymavlink")``; listings of all distributions stay
        as they are.
        """
        name = getattr(context, "name", None)
        if isinstance(name, str) and name.lower() == _ALIAS and not self._must_give_way():
            from mavwire._alias_metadata import AliasDistribution

            yield AliasDistribution(COMPATIBLE_VERSION)


def _package_spec() -> ModuleSpec:
    from importlib.machinery import ModuleSpec

    import mavwire

    loader: Any = _PackageLoader()
    spec = ModuleSpec(_ALIAS, loader, origin=mavwire.__file__, is_package=True)
    spec.submodule_search_locations = list(mavwire.__path__)
    spec.has_location = True
    return spec


def _module_spec(name: str) -> ModuleSpec:
    from importlib.machinery import ModuleSpec

    real = _find_real(name)
    loader: Any = _ModuleLoader(real)
    spec = ModuleSpec(name, loader, origin=real.origin if real else None)
    if real is not None:
        spec.submodule_search_locations = real.submodule_search_locations
        spec.has_location = real.has_location
        spec.cached = real.cached
    return spec


def _find_real(name: str) -> ModuleSpec | None:
    """The spec of mavwire's module; None for a module made at run time, which has none."""
    from importlib.util import find_spec

    real_name = _real_name(name)
    if real_name in sys.modules:
        return sys.modules[real_name].__spec__
    try:
        spec = find_spec(real_name)
    except ModuleNotFoundError as error:
        if error.name is None or not real_name.startswith(error.name):
            raise
        spec = None
    if spec is None:
        raise ModuleNotFoundError(
            f"No module named {name!r}: {_ALIAS} is provided by {_REAL}, which has no "
            f"module {real_name!r}",
            name=name,
        )
    return spec


class _PackageLoader:
    """Fills the package ``pymavlink``."""

    def create_module(self, spec: ModuleSpec) -> None:
        return None

    def exec_module(self, module: ModuleType) -> None:
        module.__doc__ = f"{_ALIAS} {COMPATIBLE_VERSION} as provided by {_REAL}"
        module.__dict__["__version__"] = COMPATIBLE_VERSION

    def is_package(self, name: str) -> bool:
        return True

    def get_code(self, name: str) -> CodeType | None:
        return None

    def get_source(self, name: str) -> str | None:
        return None

    def get_resource_reader(self, name: str) -> Any:
        import mavwire

        loader: Any = mavwire.__loader__
        return loader.get_resource_reader(_REAL)


class _ModuleLoader:
    """Hands out mavwire's module under its other name."""

    def __init__(self, real: ModuleSpec | None) -> None:
        self._real = real

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        from importlib import import_module

        module = import_module(_real_name(spec.name))
        # The import system writes the alias's spec into the module; exec_module takes it out again.
        self._own_spec = module.__spec__
        return module

    def exec_module(self, module: ModuleType) -> None:
        module.__spec__ = self._own_spec

    def is_package(self, name: str) -> bool:
        return self._real is not None and self._real.submodule_search_locations is not None

    def get_code(self, name: str) -> Any:
        return self._ask("get_code", name)

    def get_source(self, name: str) -> Any:
        return self._ask("get_source", name)

    def get_filename(self, name: str) -> Any:
        return self._ask("get_filename", name)

    def _ask(self, method: str, name: str) -> Any:
        loader = self._real.loader if self._real else None
        if not hasattr(loader, method):
            raise ImportError(f"the loader of {_real_name(name)!r} has no {method}", name=name)
        return getattr(loader, method)(_real_name(name))


_finder = _Finder()
