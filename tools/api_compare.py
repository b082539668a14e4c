"""Two packages compared name by name, by what their modules show at run time.

Modules, functions, classes and their members, constants. Nothing of the packages' sources is read:
modules are imported, signatures come from `inspect`.
"""

from __future__ import annotations

import contextlib
import importlib
import inspect
import io
import math
import pkgutil
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from types import BuiltinFunctionType, FunctionType, MethodDescriptorType, ModuleType
from typing import Any

# Members that every class has, or that only tell how Python made it.
INNER = frozenset(
    "__new__ __init__ __getattr__ __getattribute__ __setattr__ __delattr__ __hash__".split()
)
# Texts of the definitions: attributes that are not compared.
TEXTS = frozenset(["description", "param"])
METHODS = (FunctionType, BuiltinFunctionType, MethodDescriptorType, staticmethod, classmethod)
DEPTH = 6
ABSENT = object()


@dataclass(frozen=True)
class Row:
    """The comparison of one public name. `problem` is empty where both packages agree."""

    module: str
    name: str
    kind: str
    problem: str = ""

    @property
    def missing(self) -> bool:
        """Whether ours lacks the name."""
        return self.problem == "missing"


def modules(package: str, left_out: frozenset[str] = frozenset()) -> list[str]:
    """Names of all modules below `package`, relative to it, but for those below `left_out`."""
    found: list[str] = []
    pending = [""]
    while pending:
        inside = pending.pop()
        parent = load(package, inside)
        for info in pkgutil.iter_modules(getattr(parent, "__path__", [])):
            name = f"{inside}.{info.name}".lstrip(".")
            if name in left_out or info.name.startswith("_"):
                continue
            found.append(name)
            if info.ispkg:
                pending.append(name)
    return sorted(found)


def load(package: str, name: str) -> ModuleType:
    """The module `package.name`; what it prints while it is imported is dropped."""
    silent = io.StringIO()
    with contextlib.redirect_stdout(silent), contextlib.redirect_stderr(silent):
        return importlib.import_module(f"{package}.{name}".rstrip("."))


def compare_modules(name: str, ours: str, theirs: str) -> Iterator[Row]:
    """Rows of the module `name` of both packages, the one of the module itself first."""
    their_module = load(theirs, name)
    try:
        our_module = load(ours, name)
    except ModuleNotFoundError:
        yield Row(name, "", "module", "missing")
        return
    yield Row(name, "", "module")
    package = f"{theirs}."
    for attribute, value in sorted(vars(their_module).items()):
        if not attribute.startswith("_") and _is_own(value, package):
            yield from _compare(name, attribute, getattr(our_module, attribute, ABSENT), value)


def _is_own(value: Any, package: str) -> bool:
    """Whether a value belongs to the package, and not to what a module imported from elsewhere."""
    if isinstance(value, ModuleType):
        return False
    if isinstance(value, type) or callable(value):
        return (getattr(value, "__module__", None) or "").startswith(package)
    return type(value).__module__ != "__future__"


def _compare(module: str, name: str, our: Any, their: Any) -> Iterator[Row]:
    kind = _kind(their)
    if our is ABSENT:
        yield Row(module, name, kind, "missing")
    elif kind == "class":
        yield from _compare_classes(module, name, our, their)
    else:
        yield Row(module, name, kind, _problem(kind, our, their))


def _kind(value: Any) -> str:
    if isinstance(value, ModuleType):
        return "module"
    if isinstance(value, type):
        return "class"
    return "function" if callable(value) else "constant"


def _problem(kind: str, our: Any, their: Any) -> str:
    if kind == "module":
        return "" if isinstance(our, ModuleType) else "no module"
    if kind == "function":
        return _call_problem(our, their)
    return _value_problem(our, their)


def _compare_classes(module: str, name: str, our: Any, their: type) -> Iterator[Row]:
    if not isinstance(our, type):
        yield Row(module, name, "class", "no class")
        return
    yield Row(module, name, "class", _base_problem(our, their) or _call_problem(our, their))
    if their.__module__.rpartition(".")[2] != module.rpartition(".")[2]:
        return  # its members are those of the module that it comes from
    for member, value in sorted(vars(their).items()):
        is_operator = member.startswith("__") and callable(value)
        if member in INNER or (member.startswith("_") and not is_operator):
            continue
        kind = "operator" if is_operator else "method" if _is_method(value) else "attribute"
        mine = inspect.getattr_static(our, member, ABSENT)
        yield Row(module, f"{name}.{member}", kind, _member_problem(our, member, mine, value))


def _is_method(value: Any) -> bool:
    return isinstance(value, METHODS)


def _member_problem(our: type, member: str, mine: Any, their: Any) -> str:
    if mine is ABSENT:
        return "missing"
    if member.startswith("__"):
        return "" if callable(mine) else "cannot be called"
    if _is_method(their):
        mine = getattr(our, member)
        if isinstance(their, (staticmethod, classmethod)):
            their = their.__func__
            mine = getattr(mine, "__func__", mine)
        return _call_problem(mine, their)
    if hasattr(their, "__get__") or inspect.isdatadescriptor(mine):
        return ""
    return _value_problem(getattr(our, member), their)


def _base_problem(our: type, their: type) -> str:
    """Whoever catches the exceptions that theirs is must catch ours."""
    wanted = {one for one in their.__mro__ if one.__module__ == "builtins"}
    lacking = sorted(one.__name__ for one in wanted - set(our.__mro__))
    return f"is no {', '.join(lacking)}" if lacking else ""


def _call_problem(our: Any, their: Any) -> str:
    if not callable(our):
        return "cannot be called"
    theirs, mine = _parameters(their), _parameters(our)
    if theirs is None:
        return ""
    if mine is None:
        return "no signature"
    if _agree(mine, theirs):
        return ""
    return f"`{inspect.Signature(mine)}` for `{inspect.Signature(theirs)}`"


def _parameters(function: Any) -> list[inspect.Parameter] | None:
    """Parameters that a caller can give, without types. None if they cannot be known."""
    try:
        signature = inspect.signature(function)
    except (ValueError, TypeError):
        return None
    found = [p.replace(annotation=p.empty) for p in signature.parameters.values()]
    return found[1:] if found and found[0].name == "self" else found


def _agree(mine: list[inspect.Parameter], theirs: list[inspect.Parameter]) -> bool:
    return len(mine) == len(theirs) and all(
        (our.name, our.kind, _default(our.default)) == (one.name, one.kind, _default(one.default))
        for our, one in zip(mine, theirs, strict=True)
    )


def _default(value: Any) -> Any:
    """Nobody can tell a tuple from a list that is not changed."""
    return _canonical(list(value) if isinstance(value, tuple) else value)


def _value_problem(our: Any, their: Any) -> str:
    if _canonical(our) == _canonical(their):
        return ""
    plain = (bool, int, float)
    if isinstance(our, plain) and isinstance(their, plain):
        return f"`{our!r}` for `{their!r}`"
    if type(our).__name__ != type(their).__name__:
        return f"a {type(our).__name__} for a {type(their).__name__}"
    return f"another {type(their).__name__}"


def _canonical(value: Any, depth: int = DEPTH) -> Any:
    """A value as something that can be compared between packages: by content, not by class."""
    if isinstance(value, float) and math.isnan(value):
        return ("float", "nan")
    if value is None or isinstance(value, (bool, int, float, str, bytes)):
        return (type(value).__name__, repr(value))
    if depth == 0:
        return (type(value).__name__, "")
    if isinstance(value, (list, tuple)):
        return (type(value).__name__, [_canonical(one, depth - 1) for one in value])
    if isinstance(value, (set, frozenset)):
        return (type(value).__name__, sorted(str(_canonical(one, depth - 1)) for one in value))
    if isinstance(value, dict):
        pairs = [(_canonical(k), _canonical(v, depth - 1)) for k, v in value.items()]
        # `mavlink_map` is a dict that tells when it changes.
        return ("dict", sorted(pairs, key=lambda pair: str(pair[0])))
    if isinstance(value, type) or callable(value):
        return ("callable", getattr(value, "__name__", type(value).__name__))
    if hasattr(value, "tolist"):
        return _canonical(value.tolist(), depth)
    if type(value).__module__.partition(".")[0] in sys.stdlib_module_names:
        return (type(value).__name__, "")  # a lock, a logger, a compiled structure
    public = {k: v for k, v in vars(value).items() if not k.startswith("_") and k not in TEXTS}
    return ("object", _canonical(public, depth - 1))
