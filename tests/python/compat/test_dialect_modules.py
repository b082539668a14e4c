"""Every dialect module against pymavlink's: each class attribute, enum, constant, signature and name."""

from __future__ import annotations

import importlib.util
import inspect
import sys
import typing
from collections.abc import Callable
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any
from xml.etree import ElementTree

import beside
import pytest

pytest.importorskip("pymavlink", reason="pymavlink 2.4.50 is not installed")

DIALECTS = (
    "ASLUAV AVSSUAS all ardupilotmega common csAirLink cubepilot development icarous loweheiser "
    "matrixpilot minimal paparazzi python_array_test standard storm32 test uAvionix ualberta"
).split()

CLASS_ATTRIBUTES = (
    "id msgname fieldnames ordered_fieldnames fieldtypes fielddisplays_by_name fieldenums_by_name "
    "fieldunits_by_name native_format orders lengths array_lengths crc_extra instance_field "
    "instance_offset"
).split()

# The C library behind pymavlink's checksum, and builtins its generated code happens to assign.
NOT_OURS = {"fastcrc", "object", "range", "annotations"}


@pytest.fixture(
    scope="module",
    params=[(version, name) for version in ("v10", "v20") for name in DIALECTS],
    ids=lambda param: ".".join(param),
)
def modules(request: pytest.FixtureRequest) -> tuple[ModuleType, ModuleType]:
    """mavwire's module and pymavlink's."""
    version, name = request.param
    path = f"dialects.{version}.{name}"
    return (
        importlib.import_module(f"mavwire.{path}"),
        importlib.import_module(f"pymavlink.{path}"),
    )


def test_messages_in_order(modules: tuple[ModuleType, ModuleType]) -> None:
    ours, theirs = modules
    assert [(i, c.__name__) for i, c in ours.mavlink_map.items()] == [
        (i, c.__name__) for i, c in theirs.mavlink_map.items()
    ]


def test_class_attributes(modules: tuple[ModuleType, ModuleType]) -> None:
    ours, theirs = modules
    for msgid, their_class in theirs.mavlink_map.items():
        our_class = ours.mavlink_map[msgid]
        for attribute in CLASS_ATTRIBUTES:
            ours_value, theirs_value = (
                getattr(our_class, attribute),
                getattr(their_class, attribute),
            )
            assert ours_value == theirs_value, (our_class.__name__, attribute)
            assert type(ours_value) is type(theirs_value), (our_class.__name__, attribute)
        assert our_class.unpacker.format == their_class.unpacker.format, our_class.__name__


# Each is asked of a class, or of a function, that nobody has used or looked at.
OF_FUNCTIONS = {
    "getfullargspec": inspect.getfullargspec,
    "signature": inspect.signature,
    "co_varnames": lambda function: function.__code__.co_varnames,
    "names": lambda function: (function.__qualname__, function.__name__, function.__module__),
    "defaults": lambda function: function.__defaults__,
    "annotations": lambda function: function.__annotations__,
    "get_type_hints": typing.get_type_hints,
}
OF_CLASSES = {
    **{name: lambda cls, ask=ask: ask(cls.__init__) for name, ask in OF_FUNCTIONS.items()},
    "signature of the class": inspect.signature,
    "getdoc": inspect.getdoc,
    "getdoc of the constructor": lambda cls: inspect.getdoc(cls.__init__),
    "hints of the class": lambda cls: list(typing.get_type_hints(cls)),
}


def _asked(questions: dict[str, Any], first: int, target: Any) -> dict[str, str]:
    """The answers, beginning with one question of the list: it meets what is fresh."""
    names = list(questions)
    names = names[first % len(names) :] + names[: first % len(names)]
    return {name: repr(questions[name](target)).replace("pymavlink", "mavwire") for name in names}


@pytest.fixture
def fresh(monkeypatch: pytest.MonkeyPatch) -> Callable[[ModuleType], ModuleType]:
    """Makes the same module again, with classes of its own."""

    def make(module: ModuleType) -> ModuleType:
        copy = importlib.util.module_from_spec(module.__spec__)
        module.__spec__.loader.exec_module(copy)
        monkeypatch.setitem(sys.modules, copy.__name__, copy)
        return copy

    return make


def test_introspection_of_fresh_classes(
    modules: tuple[ModuleType, ModuleType], fresh: Callable[[ModuleType], ModuleType]
) -> None:
    ours, theirs = fresh(modules[0]), modules[1]
    for first, their_class in enumerate(theirs.mavlink_map.values()):
        name = their_class.__name__
        assert _asked(OF_CLASSES, first, getattr(ours, name)) == _asked(
            OF_CLASSES, first, their_class
        )
        for suffix in ("encode", "send"):
            method = f"{their_class.msgname.lower()}_{suffix}"
            asked = [
                _asked(OF_FUNCTIONS, first, getattr(m.MAVLink, method)) for m in (ours, theirs)
            ]
            assert asked[0] == asked[1], method


# A type that needs no import of `typing` is in the place of `typing.Any`, and of `typing.Union`.
SPELLINGS = {"object": "Any", "bytes | bytearray": "Union[bytes, bytearray]"}


@pytest.mark.parametrize(
    "name",
    ["MAVLink_header", "MAVLink_message", "MAVLink_bad_data", "MAVLink_unknown", "MAVLink",
     "MAVError", "Enum", "EnumEntry"],
)  # fmt: skip
def test_introspection_of_the_other_classes(
    name: str, fresh: Callable[[ModuleType], ModuleType]
) -> None:
    path = "dialects.v20.common"
    ours = fresh(importlib.import_module(f"mavwire.{path}"))
    theirs = importlib.import_module(f"pymavlink.{path}")
    our_signature = str(inspect.signature(getattr(ours, name)))
    for spelling, typing_name in SPELLINGS.items():
        our_signature = our_signature.replace(spelling, typing_name)
    assert our_signature == str(inspect.signature(getattr(theirs, name)))
    our_init, their_init = (getattr(module, name).__init__ for module in (ours, theirs))
    assert our_init.__qualname__.endswith("__init__")
    if isinstance(our_init, FunctionType):
        assert our_init.__code__.co_varnames == their_init.__code__.co_varnames
        assert our_init.__qualname__ == their_init.__qualname__
        assert list(typing.get_type_hints(our_init)) == list(typing.get_type_hints(their_init))


@pytest.mark.parametrize(
    "question",
    [
        "inspect.getfullargspec(C.__init__).args",
        "inspect.signature(C)",
        "C.__init__.__code__.co_varnames",
        "C.__init__.__qualname__",
        "typing.get_type_hints(C.__init__)",
        "inspect.getdoc(C)",
        "inspect.signature(M.rc_channels_send)",
        "typing.get_type_hints(M.file_transfer_protocol_encode)",
    ],
)
def test_the_first_question_of_a_process(question: str, tmp_path: Path, oracle: str) -> None:
    program = f"""
import inspect, typing
C = load("dialects.v20.common").MAVLink_rc_channels_message
M = load("dialects.v20.common").MAVLink
show({question!r})
"""
    beside.assert_same(program, tmp_path, oracle)


def test_enums(modules: tuple[ModuleType, ModuleType]) -> None:
    ours, theirs = modules
    assert list(ours.enums) == list(theirs.enums)
    for name, their_enum in theirs.enums.items():
        our_enum = ours.enums[name]
        assert our_enum.bitmask == their_enum.bitmask, name
        assert [(v, e.name, e.has_location, e.label) for v, e in our_enum.items()] == [
            (v, e.name, e.has_location, e.label) for v, e in their_enum.items()
        ], name


def test_descriptions_come_from_installed_definitions(
    modules: tuple[ModuleType, ModuleType],
) -> None:
    """pymavlink is installed here, with XML that has prose: it is found and read."""
    ours, theirs = modules
    for name, their_enum in theirs.enums.items():
        for value, their_entry in their_enum.items():
            our_entry = ours.enums[name][value]
            assert our_entry.description == their_entry.description, (name, their_entry.name)
            assert our_entry.param == their_entry.param, (name, their_entry.name)


def test_constants(modules: tuple[ModuleType, ModuleType]) -> None:
    ours, theirs = modules
    constants = {n: v for n, v in vars(theirs).items() if isinstance(v, (int, str)) and n.isupper()}
    different = {n for n, v in constants.items() if getattr(ours, n, None) != v}
    assert not different


def test_every_name_is_there(modules: tuple[ModuleType, ModuleType]) -> None:
    ours, theirs = modules
    names = {name for name in vars(theirs) if not name.startswith("__")} - NOT_OURS
    assert names <= set(dir(ours))
    assert not {name for name in names if not hasattr(ours, name)}


@pytest.mark.parametrize("version", ["v10", "v20"])
def test_definitions_beside_the_modules(version: str) -> None:
    """pymavlink's files are there, with the same messages and enums."""
    ours, theirs = (
        Path(importlib.import_module(f"{name}.dialects.{version}").__path__[0])
        for name in ("mavwire", "pymavlink")
    )
    for path in theirs.glob("*.xml"):
        roots = [ElementTree.parse(folder / path.name).getroot() for folder in (ours, theirs)]
        for element in ("include", "enums/enum/entry", "messages/message/field"):
            found = [
                [(one.text if element == "include" else (one.get("name"), one.get("value"), one.get("type")))
                 for one in root.iterfind(element)]
                for root in roots
            ]  # fmt: skip
            assert found[0] == found[1], (path.name, element)
