"""The template language of the generators."""

from __future__ import annotations

import io
from types import SimpleNamespace

import pytest
from mavwire.generator.mavparse import MAVParseError
from mavwire.generator.mavtemplate import MAVTemplate

ITEMS = [SimpleNamespace(n=1, inner=[{"k": "a"}, {"k": "b"}]), SimpleNamespace(n=2, inner=[])]


@pytest.mark.parametrize(
    ("text", "result"),
    [
        ("plain $x {x} }", "plain $x {x} }"),
        ("\n\nkeeps one", "\nkeeps one"),
        ("a ${x} b", "a 1 b"),
        ("${text}", "1!"),
        ("${{items:${n} ${x}, }}end", "1 1, 2 1, end"),
        ("${{items:\nitem ${n}\n}}end", "item 1\n\nitem 2end"),
        ("${{items:<${{inner:${k}}}>}}", "<ab><>"),
        ("${{items:${n}}}", "12"),
        ("none\n${{nothing:x}}", "none"),
        ("${{words:${upper}}}", None),
    ],
)
def test_substitute(text: str, result: str | None) -> None:
    values = {"x": 1, "text": "${x}!", "items": ITEMS, "nothing": [], "words": ["a"]}
    if result is None:
        assert "built-in method" in MAVTemplate().substitute(text, values)
    else:
        assert MAVTemplate().substitute(text, values) == result


def test_objects_and_other_tokens() -> None:
    assert MAVTemplate().substitute("${n}", ITEMS[1]) == "2"
    template = MAVTemplate("<", ">", "[[", "]]", trim_leading_lf=False)
    assert template.substitute("\n<n>[[inner:<k>]]", ITEMS[0]) == "\n1ab"


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("a ${y}", r"unknown variable in '\$\{y\}'"),
        ("a ${unfinished business", "missing end of variable: "),
        ("${{nope:x}}", "unable to find field nope"),
        ("${{items:x", "token nesting error"),
        ("${{items}}", "no ':' after the name"),
        ("${loop}", "holds itself"),
    ],
)
def test_mistakes_are_errors(text: str, reason: str) -> None:
    with pytest.raises(MAVParseError, match=reason):
        MAVTemplate().substitute(text, {"items": ITEMS, "loop": "${loop}"})


def test_unknown_variables_may_stay() -> None:
    assert MAVTemplate().substitute("${y} ${x}", {"x": 1}, checkmissing=False) == "${y} 1"
    assert MAVTemplate(checkmissing=False).substitute("${y}") == "${y}"


def test_write() -> None:
    file = io.StringIO()
    MAVTemplate().write(file, "\nn=${n}\n", {"n": 3})
    MAVTemplate().write(file, "\n${n}", {"n": 4}, trim_leading_lf=False)
    assert file.getvalue() == "n=3\n\n4"


def test_long_texts_take_linear_time() -> None:
    text = "${x}" * 200_000 + "${{items:${n}}}" * 20_000
    assert len(MAVTemplate().substitute(text, {"x": 1, "items": ITEMS})) == 240_000
