"""tools/import_definitions.py keeps every fact, no prose, and notices a stale tree."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
TOOL = ROOT / "tools" / "import_definitions.py"

UPSTREAM = """<?xml version='1.0'?>
<!-- prose in a comment -->
<mavlink xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xsi:noNamespaceSchemaLocation="x">
    <include> common.xml </include>
  <version>3</version>
  <enums><enum bitmask="true" name="E"><description>prose</description>
    <entry name="A" value="1"><deprecated replaced_by="B" since="2020-01">prose</deprecated>
      <param label="L &amp; &quot;M&quot;" index="1" zebra="z">prose</param></entry></enum></enums>
  <messages><message name="Q" id="1"><wip/><description>prose</description>
    <field name="a" type="uint8_t" units="m">prose</field><extensions/>
    <field name="b" type="char" description="prose">prose</field></message></messages>
</mavlink>
"""

FACTS = """<mavlink>
  <include>common.xml</include>
  <version>3</version>
  <enums>
    <enum name="E" bitmask="true">
      <entry value="1" name="A">
        <deprecated since="2020-01" replaced_by="B"/>
        <param index="1" label='L &amp; "M"' zebra="z"/>
      </entry>
    </enum>
  </enums>
  <messages>
    <message id="1" name="Q">
      <wip/>
      <description/>
      <field type="uint8_t" name="a" units="m"/>
      <extensions/>
      <field type="char" name="b"/>
    </message>
  </messages>
</mavlink>
"""


def run(source: Path, output: Path, *options: str) -> subprocess.CompletedProcess[str]:
    """Run the tool with the interpreter of the tests."""
    command = [sys.executable, str(TOOL), str(source), "--output", str(output), *options]
    return subprocess.run(command, check=False, capture_output=True, text=True)


@pytest.fixture
def folders(tmp_path: Path) -> tuple[Path, Path]:
    """An upstream directory with one file, and where to write."""
    source = tmp_path / "upstream"
    source.mkdir()
    (source / "my.xml").write_text(UPSTREAM, encoding="utf-8")
    return source, tmp_path / "out"


def test_facts_are_kept_and_prose_is_dropped(folders: tuple[Path, Path]) -> None:
    source, output = folders
    result = run(source, output)
    assert (result.returncode, result.stderr) == (0, "")
    text = (output / "my.xml").read_text(encoding="utf-8")
    assert text.endswith(FACTS)
    assert "prose" not in text


def test_importing_the_result_changes_nothing(folders: tuple[Path, Path]) -> None:
    source, output = folders
    run(source, output)
    assert run(output, output, "--check").returncode == 0


def test_check_reports_differences_and_writes_nothing(folders: tuple[Path, Path]) -> None:
    source, output = folders
    result = run(source, output, "--check")
    assert result.returncode == 1
    assert "my.xml: missing" in result.stdout
    assert not output.exists()
    run(source, output)
    target = output / "my.xml"
    target.write_text(target.read_text(encoding="utf-8").replace('"m"', '"km"'), encoding="utf-8")
    result = run(source, output, "--check")
    assert result.returncode == 1
    assert "my.xml: 1 lines to add, 1 to remove" in result.stdout
    assert 'units="km"' in target.read_text(encoding="utf-8")


def test_files_of_other_sources_are_left_alone(folders: tuple[Path, Path]) -> None:
    source, output = folders
    output.mkdir()
    other = output / "other.xml"
    other.write_text("mine", encoding="utf-8")
    assert run(source, output).returncode == 0
    assert run(source, output, "--check").returncode == 0
    assert other.read_text(encoding="utf-8") == "mine"


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (
            "<mavlink><messages><extension/></messages></mavlink>",
            "<extension> is not expected here",
        ),
        ("<html/>", "the root element is <html>"),
        ("<mavlink>", "no element found"),
    ],
)
def test_what_is_no_definition_is_refused(
    folders: tuple[Path, Path], text: str, reason: str
) -> None:
    source, output = folders
    (source / "bad.xml").write_text(text, encoding="utf-8")
    result = run(source, output)
    assert result.returncode == 2
    assert "bad.xml" in result.stderr
    assert reason in result.stderr
    assert not output.exists()


def test_an_empty_directory_is_refused(tmp_path: Path) -> None:
    result = run(tmp_path, tmp_path / "out")
    assert result.returncode == 2
    assert "no *.xml files" in result.stderr


def test_the_tree_is_what_the_reference_package_states() -> None:
    spec = importlib.util.find_spec("pymavlink")
    if spec is None or not spec.submodule_search_locations:
        pytest.skip("pymavlink is not installed")
    source = Path(spec.submodule_search_locations[0]) / "dialects" / "v20"
    result = run(source, ROOT / "message_definitions" / "v1.0", "--check")
    assert result.returncode == 0, result.stdout
