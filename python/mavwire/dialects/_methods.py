"""The functions that each message has: its constructor, ``<name>_encode`` and ``<name>_send``.

They are Python functions with pymavlink's signatures and annotations, for ``help``, ``inspect`` and the texts of
``TypeError``. Each is compiled from one template when somebody first asks for it.
"""

from __future__ import annotations

import keyword

from mavwire._hooks import warn_not_called
from mavwire._native import FIELD_TYPES, Message, MessageInfo, build, send_values
from mavwire.dialects import _docs

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from types import FunctionType
    from typing import Any

_INIT = "def __init__(self{parameters}):\n    _build(self, {arguments})\n"
_ENCODE = "def {lower}_encode(self{parameters}) -> _class:\n    return _class({arguments})\n"
_SEND = (
    "def {lower}_send(self{parameters}, force_mavlink1: bool = False) -> None:\n"
    "    _send(self, _info, force_mavlink1, {arguments})\n"
)


def annotation(field_type: str, array_length: int) -> str:
    """The type annotation of a field's argument, as text."""
    if field_type == "char":
        return "bytes"
    number = "float" if FIELD_TYPES[field_type] else "int"
    return f"Sequence[{number}]" if array_length else number


def _default(field_type: str, array_length: int) -> bytes | tuple[int, ...] | int:
    if field_type == "char":
        return b""
    return (0,) * array_length if array_length else 0


def _parameters(info: MessageInfo, version_default: bool) -> str:
    parts = []
    for name, field_type, array_length, is_extension, version in info.parameters:
        text = f"{name}: {annotation(field_type, array_length)}"
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


def _file_name(message: str) -> str:
    """The file name in tracebacks of a message's functions."""
    return f"<mavwire {message}>"


def _compile(
    template: str, owner: type, message_class: Any, scope: dict[str, Any], version_default: bool
) -> FunctionType:
    info = message_class._info
    for name in ("_pack", "sign_packet"):
        if getattr(message_class, name) is not getattr(Message, name):
            warn_not_called(f"{message_class.__name__}.{name}", "replace pack, or MAVLink.send")
    parameters = _parameters(info, version_default)
    source = template.format(
        lower=info.name.lower(),
        parameters=parameters,
        arguments=", ".join(_checked(info.fieldnames)),
    )
    if "Sequence[" in parameters:
        from typing import Sequence  # noqa: UP035 - programs compare annotations with it

        scope["Sequence"] = Sequence
    scope["__name__"] = owner.__module__
    code = compile(source, _file_name(info.name), "exec", dont_inherit=True)
    exec(code, scope)
    function: FunctionType = scope[source[len("def ") : source.index("(")]]
    function.__qualname__ = f"{owner.__qualname__}.{function.__name__}"
    return function


def make_init(owner: type, message_class: Any) -> FunctionType:
    """The constructor of a message class, which is also ``owner``."""
    return _compile(_INIT, owner, message_class, {"_build": build}, version_default=False)


def make_encode(owner: Any, message_class: Any, made: Any = None) -> FunctionType:
    """``MAVLink.<name>_encode`` of the class ``owner``, which makes messages of the class ``made``."""
    return _make_method(_ENCODE, owner, message_class, _class=made or message_class)


def make_send(
    owner: Any, message_class: Any, send: Callable[..., None] | None = None
) -> FunctionType:
    """``MAVLink.<name>_send`` of the class ``owner``, which passes its values to ``send``."""
    if send is None:
        send = encode_and_send if _is_replaced(owner, message_class) else send_values
    return _make_method(_SEND, owner, message_class, _send=send)


def encode_and_send(mav: Any, info: MessageInfo, force_mavlink1: bool, *values: Any) -> None:
    """Send as pymavlink does, by ``<name>_encode`` and a message of the class."""
    encode = getattr(mav, f"{info.name.lower()}_encode")
    mav.send(encode(*values), force_mavlink1=force_mavlink1)


def _is_replaced(owner: Any, message_class: Any) -> bool:
    """Whether a program replaced in the classes what ``send_values`` skips."""
    name = message_class._info.name
    functions = (vars(owner).get(f"{name.lower()}_encode"), vars(message_class).get("__init__"))
    return message_class.pack is not Message.pack or not all(_is_ours(f, name) for f in functions)


def _is_ours(function: Any, message: str) -> bool:
    code = getattr(function, "__code__", None)
    return type(function) is LazyFunction or (
        code is not None and code.co_filename == _file_name(message)
    )


def _make_method(template: str, owner: Any, message_class: Any, **names: Any) -> FunctionType:
    info = message_class._info
    scope = {"_class": message_class, "_info": info, **names}
    function = _compile(template, owner, message_class, scope, version_default=True)
    function.__doc__ = _docs.method_doc(owner._dialect, info)
    return function


class LazyFunction:
    """``MAVLink.<name>_encode`` or ``_send``, or a message's ``__init__``, before its first use.

    To compile all of them would take a second. The first access to one compiles the function, which replaces this object.
    """

    __slots__ = ("_make", "_message", "_owner")

    def __init__(self, message: str, make: Callable[[Any, Any], FunctionType]) -> None:
        self._make = make
        self._message = message
        self._owner: Any = None

    def __set_name__(self, owner: type, name: str) -> None:
        # The dialect's own class, wherever else it is put.
        self._owner = self._owner or owner

    def __get__(self, obj: Any, cls: Any = None) -> Any:
        return self._function().__get__(obj, cls)

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """For who takes it out of the class's dictionary, as those do who wrap all methods of a class."""
        return self._function()(*args, **kwargs)

    def _function(self) -> FunctionType:
        owner = self._owner
        function = self._make(owner, owner._dialect.message_class(self._message))
        name = function.__name__
        if owner.__dict__.get(name) is self:  # nobody has put another in its place
            setattr(owner, name, function)
        return function
