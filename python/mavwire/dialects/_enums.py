"""``enums`` of a dialect module: name -> Enum -> EnumEntry."""

from typing import Any, cast

from mavwire.dialects import _descriptions

RESERVED = "Reserved (default:{})"


class EnumEntry:
    """One entry of an enum. ``param`` and ``label`` map the parameter numbers 1 to 7 of a command to texts."""

    def __init__(self, name: str, description: str) -> None:
        self.name = name
        self.description = description
        self.param: dict[int, str] = {}
        self.label: dict[int, str] = {}
        self.has_location = False


_STORED = EnumEntry.__dict__["__dict__"]
"""The stored attributes of an entry."""


class _DefinedEntry(EnumEntry):
    """An entry whose texts are looked up when they are first read."""

    __slots__ = ("_enum", "_own_description", "_params", "_texts")

    def __init__(self, enum: str, row: tuple[Any, ...], texts: _descriptions.Texts) -> None:
        _, self.name, self._own_description, self.has_location, self._params = row
        self._enum = enum
        self._texts = texts
        self.label = {index: label for index, label, *_ in self._params if label}

    def __getattr__(self, name: str) -> Any:
        if name == "description":
            text = self._own_description or self._texts.entry(self._enum, self.name)
            self.description = _untabbed(text)
            return self.description
        if name == "param":
            self.param = self._command_params()
            return self.param
        raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")

    @property
    def __dict__(self) -> dict[str, Any]:  # type: ignore[override]
        """All attributes: programs write `vars(entry)` to JSON."""
        _ = self.description, self.param
        return cast("dict[str, Any]", _STORED.__get__(self))

    def __reduce__(self) -> tuple[Any, ...]:
        return _entry, (self.__dict__,)

    def _command_params(self) -> dict[int, str]:
        if "MAV_CMD" not in self._enum or self.name.endswith("_ENUM_END"):
            return {}
        external = self._texts.params(self._enum, self.name)
        params = {index: RESERVED.format(0) for index in range(1, 8)}
        for index, _label, description, reserved, default in self._params:
            text = description or external.get(index, "")
            if not text and reserved:
                text = RESERVED.format(default if default is not None else 0)
            params[index] = _untabbed(text)
        return params


_DefinedEntry.__name__ = _DefinedEntry.__qualname__ = EnumEntry.__name__


def _entry(attributes: dict[str, Any]) -> EnumEntry:
    """Make an entry again from its attributes, for copy and pickle."""
    entry = EnumEntry("", "")
    vars(entry).update(attributes)
    return entry


def _untabbed(text: str) -> str:
    return text.replace("\t", "    ")


class Enum(dict[int, EnumEntry]):
    """Entries by value, in ascending order; the last one is the ``_ENUM_END`` marker. ``bitmask`` says what values are."""

    def __init__(self) -> None:
        super().__init__()
        self.bitmask = False


def make_enums(rows: list[tuple[Any, ...]], texts: _descriptions.Texts) -> dict[str, Enum]:
    """``enums`` from the rows that the native dialect gives."""
    enums = {}
    for name, bitmask, _description, entries in rows:
        enum = Enum()
        enum.bitmask = bitmask
        for row in entries:
            enum[row[0]] = _DefinedEntry(name, row, texts)
        enums[name] = enum
    return enums
