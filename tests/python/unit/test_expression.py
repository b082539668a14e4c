"""What expressions give: the values, the cases that give None and the errors that are raised."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from mavwire import mavexpression, mavextra
from mavwire.expression import (
    ExpressionError,
    evaluate_condition,
    evaluate_expression,
    load_user_functions,
    names,
    register,
)


class Message:
    """A message as expressions see it: fields, instances and getters."""

    def __init__(self, **fields: Any) -> None:
        self.__dict__.update(fields)

    def get_type(self) -> str:
        return "MESSAGE"

    def __getitem__(self, instance: Any) -> Any:
        try:
            return self.instances[instance]
        except KeyError:
            raise IndexError from None


MESSAGES: dict[str, Any] = {
    "a": 2,
    "c": 0,
    "ATT": Message(Roll=1.5, Pitch=-2.5, text="foo", _timestamp=12.5),
    "MAV": Message(flightmode="AUTO"),
    "BATTERY_STATUS": Message(
        voltages=[3, 4, 65535],
        instances={1: Message(voltages=[5, 6, 7]), "foo": Message(value=9)},
    ),
    "degrees": 7,
    "d": {"k": 1},
}

VALUES = {
    "ATT.Roll": 1.5,
    "ATT.Roll>0.5": True,
    "ATT.Roll > -1 and not a == 3": True,
    "c or ATT.text": "foo",
    "c and nope": 0,
    "1 < a < 3 <= 3": True,
    "1 < a < 2 < nope": False,
    "a if c else 5": 5,
    "-a ** 2 + 7 // 2 % 2 - 3 / 2": -4.5,
    "a << 3 | 1 ^ 2 & 3": 19,
    "~a >> 1": -2,
    "BATTERY_STATUS.voltages[-1]": 65535,
    "BATTERY_STATUS.voltages[1:]": [4, 65535],
    "BATTERY_STATUS[1].voltages[0]": 5,
    "BATTERY_STATUS['foo'].value+1": 10,
    "max(*BATTERY_STATUS.voltages, key_less)": None,
    "max(BATTERY_STATUS.voltages, default=0)": 65535,
    "min(x for x in BATTERY_STATUS.voltages if x < 60000)": 3,
    "[x * a for x in [1, 2]]": [2, 4],
    "({k: v for k, v in zip('ab', [1, 2])})": {"a": 1, "b": 2},
    "({x % 2 for x in range(9)})": {0, 1},
    "[x + y for x in [1, 2] for y in [10, 20] if x + y != 11]": [21, 12, 22],
    "(1, 'b', None, True)": (1, "b", None, True),
    "[*BATTERY_STATUS.voltages, 1]": [3, 4, 65535, 1],
    "{'x': a}['x']": 2,
    "MAV.flightmode=='AUTO'": True,
    "ATT.text.startswith('f') and ATT.text.upper() == 'FOO'": True,
    "ATT.get_type()": "MESSAGE",
    "ATT._timestamp": 12.5,
    "d.get('z', 4)": 4,
    "a in [1, 2] and a not in (3,) and a is not None": True,
    "'%.2f' % ATT.Roll": "1.50",
    "sqrt(a * 8)": 4.0,
    "degrees": 7,
    "e": math.e,
    "pow(2, 3)": 8.0,
    "round(1.555, 2)": 1.55,
    "2 * Vector3(1, 2, 3).length()": 2 * math.sqrt(14),
    "wrap_180(angle=270)": -90.0,
    "distance_lat_lon(-35, 149, -35, 149)": 0.0,
    "hasattr(ATT, 'Roll') and getattr(ATT, 'nope', 3)": 3,
    " \ta": 2,
    "(a\n+1)": 3,
    "a # why": 2,
}


@pytest.mark.parametrize("text", VALUES)
def test_value(text: str) -> None:
    assert evaluate_expression(text, MESSAGES) == VALUES[text]


@pytest.mark.parametrize(
    "text",
    [
        *("NOPE", "NOPE.x>1", "NOPE(1)", "NOPE[0]", "math.pi", "1/0", "1 % 0", "ATT.Roll/c"),
        *("BATTERY_STATUS[5].x", "BATTERY_STATUS.voltages[9]", "os", "os.path", "sys.modules"),
    ],
)
def test_no_value_now(text: str) -> None:
    assert evaluate_expression(text, MESSAGES) is None


@pytest.mark.parametrize(
    ("text", "error"),
    [
        *(("ATT.nope", AttributeError), ("d['z']", KeyError), ("'a' + 1", TypeError)),
        *(
            ("a +", SyntaxError),
            ("   ", SyntaxError),
            ("a b", SyntaxError),
            ("a := 3", SyntaxError),
        ),
        *(
            ("", IndexError),
            ("sqrt(-1)", ValueError),
            ("sqrt('a')", TypeError),
            ("a[0]", TypeError),
        ),
        *(("degrees(pi)", TypeError), ("int('z')", ValueError), ("2.0 ** 9999", OverflowError)),
        *(("import os", SyntaxError), ("a; b", SyntaxError), ("a\0b", SyntaxError)),
    ],
)
def test_errors_are_the_callers(text: str, error: type[Exception]) -> None:
    with pytest.raises(error) as raised:
        evaluate_expression(text, MESSAGES)
    assert not isinstance(raised.value, ExpressionError)


@pytest.mark.parametrize(
    ("text", "value", "without_condition"),
    [
        *(("a{a>3}", None, 2), ("a{a>1}", 2, 2), ("a {a>1}", 2, 2), ("a{1}", 2, 2)),
        *(("a{nope}", None, None), ("a{ATT.nope}", None, None), ("a{1/0}", None, None)),
        *(("a{a>}", None, None), ("a{}", None, None), ("a}", None, None), ("}", None, None)),
        *(("{'x': 1}", None, None), ("nope{a}", None, None), ("a{ATT.Roll>1}", 2, 2)),
    ],
)
def test_condition_in_braces(text: str, value: Any, without_condition: Any) -> None:
    assert evaluate_expression(text, MESSAGES) == value
    assert evaluate_expression(text, MESSAGES, nocondition=True) == without_condition


def test_syntax_error_shows_once_the_condition_holds() -> None:
    assert evaluate_expression("a +{a>3}", MESSAGES) is None
    with pytest.raises(SyntaxError):
        evaluate_expression("a +{a>1}", MESSAGES)
    with pytest.raises(SyntaxError):
        evaluate_expression("a +{a>3}", MESSAGES, True)


def test_conditions() -> None:
    assert evaluate_condition(None, {}) is True
    assert evaluate_condition("a>1", MESSAGES) is True
    assert evaluate_condition("nope", MESSAGES) is False
    assert evaluate_condition("a{a>3}", MESSAGES) is False
    assert evaluate_condition("a", MESSAGES) == 2
    with pytest.raises(AttributeError):
        evaluate_condition("ATT.nope", MESSAGES)


def test_any_mapping_will_do() -> None:
    class Lazy(Mapping[str, int]):
        """A mapping that makes its values when asked."""

        def __getitem__(self, name: str) -> int:
            return {"x": 5}[name]

        def __iter__(self) -> Any:
            return iter(["x"])

        def __len__(self) -> int:
            return 1

    assert evaluate_expression("x + sqrt(4)", Lazy()) == 7
    assert evaluate_expression("y + 1", Lazy()) is None
    assert evaluate_expression("pi", None) == math.pi  # type: ignore[arg-type]


def test_messages_hide_functions_and_are_seen_anew() -> None:
    assert evaluate_expression("mode", {"mode": 3}) == 3
    assert evaluate_expression("mode", {}) is mavextra.mode
    for value in (1, 2):
        assert evaluate_expression("x", {"x": value}) == value


def test_register() -> None:
    assert evaluate_expression("twice_over(4)", {}) is None
    register("twice_over", lambda value: 2 * value)
    try:
        assert evaluate_expression("twice_over(4)", {}) == 8
    finally:
        del names.known_names()["twice_over"]
    with pytest.raises(ValueError, match="not a name"):
        register("no name", len)
    with pytest.raises(ExpressionError, match="__class__"):
        register("__class__", len)


def test_user_functions_are_loaded_on_request_only(tmp_path: Path) -> None:
    path = tmp_path / "mavextra.py"
    path.write_text(
        "from math import sin as _sin\nLIMIT = 3\ndef thrice_over(v):\n    return 3 * v\n"
    )
    assert evaluate_expression("thrice_over(2)", {}) is None
    assert load_user_functions(path) == ["thrice_over"]
    try:
        assert evaluate_expression("thrice_over(2)", {}) == 6
    finally:
        del names.known_names()["thrice_over"]
    with pytest.raises(FileNotFoundError):
        load_user_functions(tmp_path / "none.py")


def test_the_file_in_the_home_directory_is_not_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import importlib

    (tmp_path / ".pymavlink").mkdir()
    (tmp_path / ".pymavlink" / "mavextra.py").write_text("raise SystemExit('this file was run')\n")
    monkeypatch.setenv("HOME", str(tmp_path))
    module = importlib.reload(mavexpression)
    assert module.extra == str(tmp_path / ".pymavlink" / "mavextra.py")
    assert module.evaluate_expression("1 + 1", {}) == 2


def test_every_mavextra_function_is_known() -> None:
    for name in ("mag_heading", "distance_two", "sum", "declination_table", "radius_of_earth"):
        assert evaluate_expression(name, {}) is getattr(mavextra, name)
