"""tools/definitions_check.py: what came in newer checkouts of the upstreams, and whether a release may wait for it."""

from __future__ import annotations

import json
from datetime import date
from pathlib import Path

import definition_sources
import definitions_check
import import_definitions
import pytest
from mavwire.cli.dev import _definition_facts

UNION_FILE = definitions_check.UNION
FIELD = '<field type="uint8_t" name="{}"/>'
UNION = """<mavlink><enums><enum name="E">
<entry name="E_A" value="0x01"/><entry name="E_B" value="2**1"/></enum></enums>
<messages><message id="1" name="ONE">{a}<extensions/>{x}</message>
<message id="2" name="TWO">{a}</message></messages></mavlink>"""


def fields(*names: str) -> str:
    return "".join(map(FIELD.format, names))


def messages(*rows: tuple[int, str, str]) -> str:
    texts = (f'<message id="{id_}" name="{name}">{inner}</message>' for id_, name, inner in rows)
    return f"<mavlink><messages>{''.join(texts)}</messages></mavlink>"


def enum(*entries: tuple[str, int]) -> str:
    texts = (f'<entry name="{name}" value="{value}"/>' for name, value in entries)
    return f'<mavlink><enums><enum name="E">{"".join(texts)}</enum></enums></mavlink>'


@pytest.fixture(autouse=True)
def pinned(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, definition_sources.Source]:
    """A pinned union of two messages."""
    union = tmp_path / "upstream.xml"
    union.write_text(UNION.format(a=fields("a"), x=fields("x")))
    monkeypatch.setattr(definitions_check, "UNION", union)
    sources = {
        "mavlink/mavlink": definition_sources.Source("mavlink/mavlink", "1", date(2026, 7, 1))
    }
    monkeypatch.setattr(definition_sources, "load", lambda: sources)
    return sources


def checkout(tmp_path: Path, **files: str) -> Path:
    tmp_path = tmp_path / next(iter(files))
    folder = tmp_path / "checkout" / "message_definitions" / "v1.0"
    folder.mkdir(parents=True)
    for name, text in files.items():
        (folder / f"{name}.xml").write_text(text)
    return tmp_path / "checkout"


@pytest.mark.parametrize(
    ("text", "verdict"),
    [
        (messages((1, "ONE", fields("a"))), ""),
        (messages((3, "NEW", fields("a"))), "additive: message NEW (3)"),
        (
            messages((1, "ONE", fields("a") + "<extensions/>" + fields("x", "y"))),
            "additive: field y of ONE (1)",
        ),
        (enum(("E_C", 4)), "additive: entry E_C"),
        (enum(("E_A", 1), ("E_B", 2)), ""),
        (enum(("E_C", 4)).replace('"E"', '"F"'), "additive: enum F"),
        (messages((2, "OTHER", fields("a"))), "id clash: 2 is TWO and OTHER"),
        (messages((3, "TWO", fields("a"))), "id clash: TWO is 2 and 3"),
        (messages((2, "TWO", fields("a", "b"))), "changed CRC_EXTRA: TWO (2) "),
        (
            messages((1, "ONE", fields("a") + "<extensions/>" + fields("y", "x"))),
            "changed extension fields: ONE (1)",
        ),
        (enum(("E_A", 8)), "enum values changed: E_A 1 -> 8"),
        (enum(("E_RENAMED", 2)), "enum values changed: 2 is E_B and E_RENAMED"),
    ],
)
def test_verdicts(
    text: str, verdict: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = checkout(tmp_path, common=text)
    code = definitions_check.main([str(folder)])
    printed = capsys.readouterr().out
    assert code == int(not verdict.startswith("additive") and bool(verdict))
    expected = f"common.xml: {verdict}" if verdict else "1 files, none of them changed"
    assert expected in printed


def test_ids_that_files_of_one_checkout_share_are_no_clash(tmp_path: Path) -> None:
    folder = checkout(
        tmp_path,
        all="<mavlink><include>one.xml</include></mavlink>",
        aa=messages((1, "ANOTHER", fields("b"))),
        one=messages((1, "ONE", fields("a"))),
    )
    assert definitions_check.main([str(folder)]) == 0


def test_checkouts_that_contradict_each_other_clash(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    one = checkout(tmp_path, one=messages((3, "NEW", fields("a"))))
    two = checkout(tmp_path, two=messages((3, "OTHER", fields("a"))))
    assert definitions_check.main([str(one), str(one)]) == 0
    assert definitions_check.main([str(one), str(two)]) == 1
    assert "two.xml: id clash: 3 is NEW and OTHER" in capsys.readouterr().out


def test_the_dialects_of_pymavlink_are_in_the_union(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Names of enum entries that upstream gave up are no news."""
    monkeypatch.setattr(definitions_check, "UNION", UNION_FILE)
    assert definitions_check.main([str(import_definitions.OUTPUT)]) == 0
    assert "none of them changed" in capsys.readouterr().out


def test_a_release_does_not_wait_for_what_the_last_import_held_back(
    tmp_path: Path, pinned: dict[str, definition_sources.Source]
) -> None:
    folder = checkout(tmp_path, common=messages((2, "OTHER", fields("a"))))
    release = ["--max-age", "30", str(folder)]
    assert definitions_check.main(release, date(2027, 1, 1)) == 1
    pinned["mavlink/mavlink"].sha256 = definition_sources.digests(folder)
    assert definitions_check.main(release, date(2027, 1, 1)) == 0
    assert definitions_check.main([str(folder)]) == 1


@pytest.mark.parametrize(
    "text",
    [
        messages((2, "TWO", fields("a", "b"))),
        messages((2, "OTHER", fields("a"))),
        messages((3, "TWO", fields("a"))),
        enum(("E_A", 8)),
        enum(("E_RENAMED", 2)),
    ],
)
def test_a_change_is_accepted_with_the_lines_that_are_printed(
    text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = checkout(tmp_path, common=text)
    assert definitions_check.main([str(folder)]) == 1
    printed = capsys.readouterr().out
    (tmp_path / "sources.toml").write_text(printed[printed.index("[[accepted]]") :])
    accepted = definition_sources.accepted(tmp_path / "sources.toml")
    assert len(accepted) == 1
    monkeypatch.setattr(definition_sources, "accepted", lambda: accepted)
    assert definitions_check.main([str(folder)]) == 0
    # The other upstream still has the definition before.
    before = checkout(tmp_path, before=definitions_check.UNION.read_text())
    assert definitions_check.main([str(folder), str(before)]) == 0
    # A later change needs a decision of its own.
    later = text.replace("uint8_t", "uint16_t").replace('"8"', '"9"')
    if later != text and accepted[0].new is not None:
        assert definitions_check.main([str(checkout(tmp_path, later=later))]) == 1


@pytest.mark.parametrize(
    ("text", "today", "code"),
    [
        (messages((3, "NEW", fields("a"))), date(2026, 7, 31), 0),
        (messages((3, "NEW", fields("a"))), date(2026, 8, 1), 1),
        (messages((2, "OTHER", fields("a"))), date(2026, 7, 31), 0),
        (messages((1, "ONE", fields("a"))), date(2027, 1, 1), 0),
    ],
)
def test_a_release_waits_for_changes_that_are_older_than_a_month(
    text: str, today: date, code: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = checkout(tmp_path, common=text)
    assert definitions_check.main(["--max-age", "30", str(folder)], today) == code
    printed = capsys.readouterr().out
    assert ("are 31 days old" in printed) == bool(code)
    assert ("NEW (3)" in printed) == ("NEW" in text)


@pytest.mark.parametrize("text", ["<mavlink>", "<html/>"])
def test_a_file_that_is_no_definition_is_an_error(
    text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert definitions_check.main([str(checkout(tmp_path, common=text))]) == 2
    assert "common.xml" in capsys.readouterr().err


def test_differences_as_text_and_json() -> None:
    old = _definition_facts.parsed(parse(UNION.format(a=fields("a"), x="")))
    new = _definition_facts.parsed(
        parse(messages((1, "UNO", fields("b")), (3, "NEW", fields("a")), (2, "TWO", fields("a"))))
    )
    difference = _definition_facts.changes(old, new)
    assert _definition_facts.as_text(difference).splitlines() == [
        "+ message NEW (3)",
        f"~ message UNO (1, before ONE) CRC_EXTRA {old.messages[1].crc_extra} -> {new.messages[1].crc_extra}",
        "  + field b: uint8_t",
        "  - field a: uint8_t",
        "- enum E",
    ]
    assert json.loads(json.dumps(difference))["messages"]["added"] == {"3": "NEW"}
    assert not _definition_facts.as_text(_definition_facts.changes(old, old))


def parse(text: str) -> str:
    from mavwire._native import DefinitionFile

    return DefinitionFile("a.xml", text).parse()
