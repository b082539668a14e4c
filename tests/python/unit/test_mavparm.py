"""What mavparm does otherwise than pymavlink, on purpose, and a vehicle that takes parameters."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

import pytest
from mavwire import cli, mavparm, mavutil


class Link:
    """A vehicle that takes every parameter."""

    def __init__(self) -> None:
        self.values: dict[str, float] = {}
        self.asked: list[str] = []

    def param_set_send(self, name: str, value: float, parm_type: int | None = None) -> None:
        self.values[name] = value
        self.asked.append(name)

    def recv_match(self, **options: Any) -> Any:
        name = self.asked.pop(0)
        make = mavutil.mavlink.MAVLink_param_value_message
        return make(name.encode(), self.values[name], 9, 1, 0)


def file(folder: Path, text: bytes | str) -> str:
    path = folder / "a.parm"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return str(path)


@pytest.mark.parametrize("value", ["abc", "0x", "0xzz", "-0x10", "1.5;", "0x" + "f" * 400])
def test_a_value_that_is_no_number_names_its_place(value: str, tmp_path: Path) -> None:
    name = file(tmp_path, f"A 1\n# comment\nB {value}\n")
    parameters = mavparm.MAVParmDict(("A", 0.0), ("B", 0.0))
    with pytest.raises(mavparm.MAVParmFileError) as caught:
        parameters.load(name)
    assert str(caught.value) == f"{name}:3: the value of B is no number: {value[:80]}"
    assert isinstance(caught.value, ValueError)


def test_nothing_is_set_from_a_file_with_a_mistake(tmp_path: Path) -> None:
    link, parameters = Link(), mavparm.MAVParmDict(("A", 0.0), ("B", 0.0))
    with pytest.raises(mavparm.MAVParmFileError):
        parameters.load(file(tmp_path, "A 1\nB x\n"), mav=link)
    assert (link.values, dict(parameters)) == ({}, {"A": 0.0, "B": 0.0})


def test_values_are_set_on_the_vehicle(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    link, parameters = Link(), mavparm.MAVParmDict(("A", 0.0), ("B", 2.0))
    assert parameters.load(file(tmp_path, "A 1\nB 2\nC 3\n"), mav=link)
    assert link.values == {"A": 1.0}
    assert "Unknown parameter C" in capsys.readouterr().out


@pytest.mark.parametrize("package", ["mavwire", "pymavlink"])
def test_loading_sets_items_as_a_program_does(package: str, tmp_path: Path) -> None:
    class Noting(importlib.import_module(f"{package}.mavparm").MAVParmDict):  # type: ignore[misc]
        def __setitem__(self, name: str, value: Any) -> None:
            super().__setitem__(name, -value)

    path = tmp_path / "a.parm"
    path.write_text("A_ONE 1\nB_TWO 2.5\n")
    parameters = Noting()
    assert parameters.load(str(path))
    assert parameters == {"A_ONE": -1, "B_TWO": -2.5}


def test_comments_may_hold_any_bytes(tmp_path: Path) -> None:
    """pymavlink raises UnicodeDecodeError, and takes a byte order mark for a letter."""
    parameters = mavparm.MAVParmDict()
    assert parameters.load(file(tmp_path, b"\xef\xbb\xbfA 1 # 20\xb0C\r\nB 2\r\n"))
    assert dict(parameters) == {"A": 1.0, "B": 2.0}


@pytest.mark.parametrize("name", ["a\0b", None, 5.5, "", b"none"])
def test_what_is_no_file(name: Any, capsys: pytest.CaptureFixture[str]) -> None:
    parameters = mavparm.MAVParmDict(("A", 1.0))
    assert parameters.load(name) is False
    assert parameters.diff(name) is None  # type: ignore[func-returns-value]
    assert capsys.readouterr().out.count(f"Failed to open file '{name}': ") == 2


def test_mappings_make_a_dictionary() -> None:
    assert dict(mavparm.MAVParmDict({"AB": 1.0}, ("C", 2.0))) == {"AB": 1.0, "C": 2.0}


def test_integers_are_given_as_users_write_them() -> None:
    link, parameters = Link(), mavparm.MAVParmDict()
    assert parameters.mavset(link, "A", "0x10", parm_type=mavutil.mavlink.MAV_PARAM_TYPE_INT32)
    assert link.values["A"] == pytest.approx(2.2420775429197073e-44)
    with pytest.raises(ValueError, match="A: 300 does not fit type 1"):
        parameters.mavset(link, "A", 300, parm_type=mavutil.mavlink.MAV_PARAM_TYPE_UINT8)


def test_texts_are_shown(capsys: pytest.CaptureFixture[str]) -> None:
    mavparm.MAVParmDict(("A", "text")).show()
    assert capsys.readouterr().out == "A                text\n"


def test_values_that_cannot_be_written_leave_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "vehicle.parm"
    parameters = mavparm.MAVParmDict({"A": 1.0})
    parameters.save(str(path))
    before = path.read_bytes()
    parameters["B\ud800"] = 2.0
    with pytest.raises(UnicodeEncodeError):
        parameters.save(str(path))
    assert path.read_bytes() == before


QGC = """# Onboard parameters for Vehicle 1
#
# Stack: ArduPilot
# Vehicle-Id Component-Id Name Value Type
1\t1\tATC_RAT_YAW_FLTT\t20.000000000000000000\t9
1\t1\tAUTO_OPTIONS\t3\t6
1\t1\tFORMAT_VERSION\t13\t4
1\t154\tAUTO_OPTIONS\t7\t6
"""


def test_files_of_qgroundcontrol_load_by_their_contents(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Parameters of the first component are loaded; lines of another one are shown."""
    parameters = mavparm.MAVParmDict()
    assert parameters.load(file(tmp_path, QGC))
    assert parameters == {"ATC_RAT_YAW_FLTT": 20.0, "AUTO_OPTIONS": 3.0}
    said = capsys.readouterr()
    assert "Invalid line: 1\t154\tAUTO_OPTIONS\t7\t6" in said.out and "Loaded 2 param" in said.out
    link = Link()
    assert parameters.load(file(tmp_path, "1,1,AUTO_OPTIONS,5,6\n"), mav=link)
    assert link.values == {"AUTO_OPTIONS": 5.0}
    with pytest.raises(mavparm.MAVParmFileError, match=":1: the value of A is no number: x"):
        parameters.load(file(tmp_path, "1 1 A x 9\n"))


@pytest.mark.parametrize("text", ["", "# comment\n", "no parameters in here\n", "1 1 A 2\n"])
def test_a_file_without_a_parameter_is_called_so(
    text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    name = file(tmp_path, text)
    assert mavparm.MAVParmDict().load(name)
    said = capsys.readouterr()
    assert "Loaded 0 parameters from" in said.out and f"{name}: no parameters found" in said.err
    good = tmp_path / "good.parm"
    good.write_text("A 1\n")
    for names in ([name, str(good)], [str(good), name]):
        for command in ("parmdiff", "extract_parms"):
            assert cli.main([command, *names]) == 1
            assert f"{name}: no parameters found" in capsys.readouterr().err
    assert mavparm.MAVParmDict().load(str(good), wildcard="B*")
    assert "no parameter" not in capsys.readouterr().err
