"""The pages of the documentation site, before MkDocs has them: links, and the reference of messages."""

from __future__ import annotations

import posixpath
import re
from pathlib import Path
from typing import Any

import docs_navigation
import docs_pages
import message_pages
import pytest
from mavwire.dialects.v20 import common as mavlink

ROOT = Path(__file__).parents[3]
DIALECTS = ("minimal", "standard", "common")  # with what they include


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder with all pages."""
    out = tmp_path_factory.mktemp("site")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(docs_pages, "OUT", out)
        assert docs_pages.main() == 0
    return out


def test_links_lead_to_pages(site: Path) -> None:
    checked = 0
    for page in site.rglob("*.md"):
        for target in re.findall(r"(?<!`)\]\(([^)\s#]+)[^)]*\)", page.read_text(encoding="utf-8")):
            if "://" not in target:
                checked += 1
                assert (page.parent / target).is_file(), f"{page.relative_to(site)}: {target}"
    assert checked > 300


def test_the_readme_is_the_first_page(site: Path) -> None:
    text = (site / "index.md").read_text()
    assert "](tutorial.md)" in text and "](examples/index.md)" in text
    assert "](docs/" not in text and "](tests/" not in text


def test_every_page_has_its_place_in_the_navigation(site: Path) -> None:
    navigation = (ROOT / "mkdocs.yml").read_text().partition("\nnav:")[2]
    named = set(re.findall(r"([\w/.-]+\.md)", navigation))
    pages = {path.relative_to(site).as_posix() for path in site.rglob("*.md")}
    assert not named - pages
    assert not {page for page in pages - named if "/" in page and not page.startswith("messages/")}


def test_pages_that_nobody_placed_come_last(tmp_path: Path) -> None:
    for name in ("known.md", "new.md"):
        (tmp_path / name).write_text("# A page\n")
    sections: list[dict[str, Any]] = [{"Start": ["index.md"]}, {"Guides": [{"Known": "known.md"}]}]
    docs_navigation.on_config({"nav": sections, "docs_dir": str(tmp_path)})
    assert sections[1]["Guides"] == [{"Known": "known.md"}, "new.md"]


def test_commands_are_listed(site: Path) -> None:
    text = (site / "commands.md").read_text()
    assert "## info\n" in text and "usage: mavwire info" in text


def test_a_link_that_leads_nowhere_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(docs_pages, "ROOT", tmp_path)
    page = tmp_path / "page.md"
    page.write_text("```sh\n[not](a/link.md)\n```\nsee [there](nowhere.md)\n")
    with pytest.raises(SystemExit, match=r"page\.md: the link to nowhere\.md leads nowhere"):
        docs_pages.relinked(page, "page.md", {})


def test_every_message_and_enum_is_there() -> None:
    pages = message_pages.pages()
    messages = set(
        re.findall(r"^## (\w+)$", "".join(pages[f"{d}.md"] for d in DIALECTS), re.MULTILINE)
    )
    enums = set(
        re.findall(r"^## (\w+)$", "".join(pages[f"{d}-enums.md"] for d in DIALECTS), re.MULTILINE)
    )
    assert messages == {cls.msgname for cls in mavlink.mavlink_map.values()}
    assert enums == set(mavlink.enums)


def test_a_message_on_its_page() -> None:
    text = message_pages.pages()["common.md"]
    section = text.partition("## BATTERY_STATUS\n")[2].partition("\n## ")[0]
    assert "| `id` | `uint8_t` |  |  | tells instances apart |" in section
    assert "| `voltages` | `uint16_t[10]` | mV |" in section
    assert "[MAV_BATTERY_TYPE](common-enums.md#mav_battery_type)" in section
    assert re.search(r"`fault_bitmask`.*extension", section)


def test_links_to_enums_lead_to_them() -> None:
    pages = message_pages.pages()
    for page, text in pages.items():
        for target, anchor in re.findall(r"\]\(([\w-]+\.md)#(\w+)\)", text):
            assert re.search(rf"^## {anchor}$", pages[posixpath.basename(target)], re.M | re.I), (
                page
            )


def test_messages_and_enums_link_to_the_reference_of_mavlink() -> None:
    pages = message_pages.pages()
    site = "[mavlink.io](https://mavlink.io/en/messages"
    assert f"Id 0. {site}/minimal.html#HEARTBEAT)" in pages["minimal.md"]
    assert f"{site}/common.html#MAV_CMD)" in pages["common-enums.md"]
    assert f"{site}/all.html#EVENT)" in pages["upstream.md"]
    for text in pages.values():
        for section in re.split("^## ", text, flags=re.MULTILINE)[1:]:
            assert f".html#{section.split()[0]})" in section


def test_stored_descriptions_are_on_the_pages(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    folder = tmp_path / "mavwire" / "definitions" / "000"
    folder.mkdir(parents=True)
    (folder / "minimal.xml").write_text(
        """<mavlink><enums><enum name="MAV_STATE"><entry value="1" name="MAV_STATE_BOOT">
        <description>It | starts.</description></entry></enum></enums>
        <messages><message id="0" name="HEARTBEAT"><description>I am *here*.</description>
        <field type="uint8_t" name="type">Kind of vehicle.</field></message></messages></mavlink>"""
    )
    pages = message_pages.pages()
    assert "\nI am \\*here\\*.\n" in pages["minimal.md"]
    assert re.search(r"\| `type` .* \| Kind of vehicle\. \|", pages["minimal.md"])
    assert re.search(r"`MAV_STATE_BOOT` \| It \\\| starts\. \|", pages["minimal-enums.md"])
