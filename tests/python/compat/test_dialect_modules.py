"""Every dialect module against pymavlink's: each class attribute, enum, constant, signature and name."""

from __future__ import annotations

import importlib
import inspect
from types import ModuleType
from typing import Any

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


def _signature(function: Any) -> list[tuple[str, Any, Any]]:
    return [(p.name, p.default, p.kind) for p in inspect.signature(function).parameters.values()]


def test_signatures(modules: tuple[ModuleType, ModuleType]) -> None:
    ours, theirs = modules
    for msgid, their_class in theirs.mavlink_map.items():
        our_class = ours.mavlink_map[msgid]
        assert _signature(our_class) == _signature(their_class), our_class.__name__
        lower = our_class.msgname.lower()
        for method in (f"{lower}_encode", f"{lower}_send"):
            assert _signature(getattr(ours.MAVLink, method)) == _signature(
                getattr(theirs.MAVLink, method)
            ), method


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
