"""The stubs of the dialect modules are what `make stubs` writes now, each definition once."""

from __future__ import annotations

import ast
import re
from collections import Counter
from pathlib import Path

import generate_stubs
import pytest
from mavwire.dialects import UPSTREAM

MAX_TOTAL = 1_000_000


@pytest.fixture(scope="module")
def files() -> dict[Path, str]:
    return generate_stubs.render()


def test_stubs_are_up_to_date(files: dict[Path, str]) -> None:
    stale = [str(path.relative_to(generate_stubs.ROOT)) for path in generate_stubs.stale(files)]
    assert not stale, "run: make stubs"


def test_a_changed_missing_or_surplus_stub_is_noticed(files: dict[Path, str]) -> None:
    changed, missing = sorted(files)[:2]
    other = {path: text for path, text in files.items() if path != missing}
    other[changed] += "X: int\n"
    surplus = generate_stubs.DIALECTS / "v20" / "surplus.pyi"
    other[surplus] = ""
    assert generate_stubs.stale(other) == sorted([changed, missing, surplus])


def test_stubs_are_python_and_small(files: dict[Path, str]) -> None:
    for path, text in files.items():
        ast.parse(text, str(path))
    assert sum(map(len, files.values())) < MAX_TOTAL


@pytest.mark.parametrize("version", ["v10", "v20"])
def test_messages_are_written_once(files: dict[Path, str], version: str) -> None:
    classes: Counter[str] = Counter()
    for path, text in files.items():
        if path.parent == generate_stubs.DIALECTS / version / generate_stubs.OWN:
            classes.update(re.findall(r"^class MAVLink_.*(?:\n .*)*", text, re.M))
    assert len(classes) > 150
    assert not [text for text, count in classes.items() if count > 1]


def test_the_union_holds_new_and_changed_messages_alone(files: dict[Path, str]) -> None:
    folder = generate_stubs.DIALECTS / "v20" / generate_stubs.OWN
    changed, union = (
        re.findall(r"^class (MAVLink_\w+)", files[folder / f"{name}.pyi"], re.M)
        for name in ("common_replaced", UPSTREAM)
    )
    assert "MAVLink_mission_ack_message" in changed and set(changed) < set(union)
    assert "MAVLink_event_message" in union and "MAVLink_heartbeat_message" not in union


def test_a_redefined_message_is_refused() -> None:
    part = generate_stubs.Content("part", messages={"X": "class X: ..."})
    whole = generate_stubs.Content("whole", messages={"X": "class X: a: int"})
    with pytest.raises(ValueError, match="whole redefines X"):
        generate_stubs.own(whole, [part])


def test_link_bases_leave_out_what_others_bring() -> None:
    assert "common" in generate_stubs.ancestors("ardupilotmega")
    bases = generate_stubs.link_bases("ardupilotmega")
    assert "uAvionix" in bases and "common" not in bases
