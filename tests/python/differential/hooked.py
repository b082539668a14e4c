"""Which names of a package's modules are called by what, in ordinary use, when a program has replaced them.

`python -m differential.hooked PACKAGE FOLDER` replaces each public function, class, table and module that
pymavlink's modules have by one that notes its use, and prints `MODULE NAME OUTCOME` for each: called,
never, warns or raises. What goes in its place behaves as before.
"""

from __future__ import annotations

import contextlib
import importlib
import inspect
import io
import sys
import types
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

from differential import workload

# Module -> what uses it.
MODULES: dict[str, tuple[Callable[[workload.Package], None], ...]] = {
    "mavutil": (workload.telemetry_logs, workload.links),
    "DFReader": (workload.dataflash_logs,),
    "CSVReader": (workload.csv_log,),
    "mavwp": (workload.missions,),
    "mavparm": (workload.parameters,),
    "mavextra": (workload.expressions,),
    "mavexpression": (workload.expressions,),
    "quaternion": (workload.rotations,),
    "rotmat": (workload.rotations,),
    "fgFDM": (workload.flightgear,),
    "dialects.v20.all": (workload.messages,),
}
LOOK_UPS = ("__getitem__", "get", "__contains__", "items", "keys", "values", "__iter__")


def watched(value: Any, calls: list[str]) -> Any:
    """A replacement that behaves as `value` and notes its uses; None if that is not possible."""
    if isinstance(value, types.ModuleType) or type(value).__module__.startswith("mavwire"):
        return WatchedModule(value, calls)
    if inspect.isclass(value):
        return watched_class(value, calls)
    if isinstance(value, dict):
        return watched_table(value, calls)

    def function(*args: Any, **kwargs: Any) -> Any:
        calls.append("called")
        return value(*args, **kwargs)

    return function


class WatchedModule(types.ModuleType):
    def __init__(self, module: Any, calls: list[str]) -> None:
        super().__init__("watched")
        self.__dict__["_watched"] = (module, calls)

    def __getattr__(self, name: str) -> Any:
        module, calls = self.__dict__["_watched"]
        if not name.startswith("__"):
            calls.append(name)
        return getattr(module, name)


def watched_class(cls: Any, calls: list[str]) -> Any:
    def __call__(self: Any, *args: Any, **kwargs: Any) -> Any:
        calls.append("made")
        return super(meta, self).__call__(*args, **kwargs)

    meta: Any = type("Meta", (type(cls),), {"__call__": __call__})
    try:
        return meta(cls.__name__, (cls,), {"__module__": cls.__module__})
    except TypeError:
        return None


def watched_table(table: dict[Any, Any], calls: list[str]) -> Any:
    def noting(name: str) -> Any:
        original = getattr(dict, name)

        def look_up(self: Any, *args: Any) -> Any:
            calls.append(name)
            return original(self, *args)

        return look_up

    cls = type("Table", (dict,), {name: noting(name) for name in LOOK_UPS})
    return cls(table)


def names_in(reference: types.ModuleType) -> list[str]:
    """Names of what a program may replace in a module of pymavlink."""
    names = []
    for name, value in sorted(vars(reference).items()):
        is_hook = callable(value) or isinstance(value, (dict, types.ModuleType))
        if not is_hook or name.startswith("_") or name in ("sys", "mavlink"):
            continue
        if ".dialects." in getattr(value, "__name__", "") and inspect.ismodule(value):
            continue
        if getattr(value, "__module__", "") in ("typing", "builtins") or isinstance(
            value, types.GenericAlias
        ):
            continue
        # Of several hundred messages that are made alike.
        if name.endswith("_message") and name not in workload.MESSAGE_CLASSES:
            continue
        names.append(name)
    return names


class Replaced:
    """Names of one module, replaced for a while."""

    def __init__(self, module: types.ModuleType, reference: types.ModuleType) -> None:
        self.module, self.reference = module, reference
        self.outcomes: dict[str, str] = {}
        self._undo: dict[str, tuple[Any, bool, list[str]]] = {}

    def replace(self, name: str) -> None:
        is_there = hasattr(self.module, name)
        value = getattr(self.module if is_there else self.reference, name)
        calls: list[str] = []
        by = watched(value, calls)
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            try:
                setattr(self.module, name, object() if by is None else by)
            except Exception:
                self.outcomes[name] = "raises"
                return
        if any("does not call it" in str(one.message) for one in said):
            self.outcomes[name] = "warns"
        elif by is None:
            self.outcomes[name] = "unknown"
        else:
            self._undo[name] = (value, is_there, calls)
            return
        self._put_back(name, value, is_there)

    def _put_back(self, name: str, value: Any, is_there: bool) -> None:
        if is_there:
            setattr(self.module, name, value)
        else:
            delattr(self.module, name)

    def restore(self) -> None:
        for name, (value, is_there, calls) in self._undo.items():
            self._put_back(name, value, is_there)
            self.outcomes[name] = "called" if calls else "never"


def report(name: str, folder: Path) -> None:
    package = workload.Package(name, folder)
    for module_name, parts in MODULES.items():
        module = package.module(module_name)
        reference = importlib.import_module(f"pymavlink.{module_name}")
        outcomes: dict[str, str] = {}
        names = names_in(reference)
        classes = [one for one in names if inspect.isclass(getattr(reference, one))]
        # A class in the place of another confuses pymavlink's other classes: one at a time.
        for group in ([one for one in names if one not in classes], *([one] for one in classes)):
            replaced = Replaced(module, reference)
            for one in group:
                replaced.replace(one)
                if one in classes and replaced.outcomes.get(one):
                    break
            else:
                package.use(parts)
            replaced.restore()
            outcomes |= replaced.outcomes
        for one in sorted(outcomes):
            print(module_name, one, outcomes[one])


def main(arguments: list[str]) -> None:
    """Print the report on a package, which uses the files that it makes in a folder."""
    printed = io.StringIO()
    with contextlib.redirect_stderr(io.StringIO()):
        stdout, sys.stdout = sys.stdout, printed
        try:
            report(arguments[0], Path(arguments[1]))
        finally:
            sys.stdout = stdout
    for line in printed.getvalue().splitlines():
        if line.count(" ") == 2 and line.split()[0] in MODULES:
            print(line)


if __name__ == "__main__":
    main(sys.argv[1:])
