"""The functions that each message has: its constructor, ``<name>_encode`` and ``<name>_send``.

They are real Python functions with real signatures, so that ``help``, ``inspect`` and the texts of ``TypeError`` are what
callers expect; each is compiled from one template when it is first used.
"""

from __future__ import annotations

import keyword

from mavwire._native import MessageInfo, build, send_values

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from typing import Any

_INIT = "def __init__(self{parameters}):\n    _build(self, {arguments})\n"
_ENCODE = "def {lower}_encode(self{parameters}):\n    return _class({arguments})\n"
_SEND = (
    "def {lower}_send(self{parameters}, force_mavlink1: bool = False) -> None:\n"
    "    _send(self, _info, force_mavlink1, {arguments})\n"
)


def _annotation(field_type: str, array_length: int) -> str:
    if field_type == "char":
        return "bytes"
    number = "float" if field_type in ("float", "double") else "int"
    return f"Sequence[{number}]" if array_length else number


def _default(field_type: str, array_length: int) -> bytes | tuple[int, ...] | int:
    if field_type == "char":
        return b""
    return (0,) * array_length if array_length else 0


def rest_of(info: MessageInfo, count: int) -> list[Any] | None:
    """The default values behind the first `count` fields; None where there are none, or not so many fields."""
    missing = info.parameters[count:]
    if count > len(info.parameters) or not all(
        is_extension for _, _, _, is_extension, _ in missing
    ):
        return None
    return [_default(field_type, length) for _, field_type, length, _, _ in missing]


def _parameters(info: MessageInfo, version_default: bool) -> str:
    parts = []
    for name, field_type, array_length, is_extension, version in info.parameters:
        text = f"{name}: {_annotation(field_type, array_length)}"
        if is_extension:
            text += f" = {_default(field_type, array_length)!r}"
        elif version is not None and version_default:
            text += f" = {version}"
        parts.append(text)
    return "".join(f", {part}" for part in parts)


def _checked(names: Iterable[str]) -> list[str]:
    """Field names that may stand in a template: identifiers and nothing else."""
    result = list(names)
    for name in result:
        if not name.isidentifier() or keyword.iskeyword(name):
            raise ValueError(f"field name {name!r} is not usable as a Python parameter name")
    return result


def _compile(
    template: str, name: str, info: MessageInfo, scope: dict[str, Any], version_default: bool
) -> Callable[..., Any]:
    names = _checked(info.fieldnames)
    source = template.format(
        lower=info.name.lower(),
        parameters=_parameters(info, version_default),
        arguments=", ".join(names),
    )
    # Annotations stay text: nothing is imported for them.
    code = "from __future__ import annotations\n" + source
    exec(compile(code, f"<mavwire {info.name}>", "exec"), scope)
    function: Callable[..., Any] = scope[name]
    return function


def make_init(info: MessageInfo, module: str, qualname: str) -> Callable[..., None]:
    """The constructor of a message class."""
    scope: dict[str, Any] = {"_build": build, "__name__": module}
    function = _compile(_INIT, "__init__", info, scope, version_default=False)
    function.__qualname__ = f"{qualname}.__init__"
    return function


def make_encode(
    info: MessageInfo, cls: type, module: str, doc: Callable[[], str]
) -> Callable[..., Any]:
    """``MAVLink.<name>_encode``."""
    name = f"{info.name.lower()}_encode"
    return _make_method(_ENCODE, name, info, cls, module, doc)


def make_send(
    info: MessageInfo, cls: type, module: str, doc: Callable[[], str]
) -> Callable[..., Any]:
    """``MAVLink.<name>_send``."""
    name = f"{info.name.lower()}_send"
    return _make_method(_SEND, name, info, cls, module, doc)


def _make_method(
    template: str, name: str, info: MessageInfo, cls: type, module: str, doc: Callable[[], str]
) -> Callable[..., Any]:
    scope: dict[str, Any] = {"_class": cls, "_info": info, "_send": send_values, "__name__": module}
    function = _compile(template, name, info, scope, version_default=True)
    function.__qualname__ = f"MAVLink.{name}"
    function.__doc__ = doc()
    return function
