"""message_definitions/sources.toml names the origin of what is committed, and the tools write it."""

from __future__ import annotations

import json
import os
import re
import subprocess
from datetime import date
from importlib import metadata
from pathlib import Path
from typing import Any

import definition_sources
import import_history
import pytest
from mavwire._native import DefinitionFile, crc_extra

DEFINITIONS = definition_sources.DEFINITIONS
SEED = crc_extra("SAMPLE", [("float", "b", 4), ("uint8_t", "a", 0)])
UPSTREAMS = {"ArduPilot/mavlink": "ardupilot", "mavlink/mavlink": "mavlink"}


def test_digests_are_those_of_the_files() -> None:
    written = {
        path.relative_to(DEFINITIONS).as_posix(): definition_sources.digest(path)
        for path in DEFINITIONS.glob("*/*.xml")
    }
    assert definition_sources.load()[definition_sources.WRITTEN].sha256 == written


def test_headers_name_the_tool_that_wrote_the_file() -> None:
    tools = {"upstream.xml": "union_definitions", "history.xml": "import_history"}
    for path in DEFINITIONS.glob("*/*.xml"):
        head = path.read_text(encoding="utf-8").splitlines()[1]
        tool = tools.get(path.name, "import_definitions")
        assert head.endswith(f"Written by tools/{tool}.py. -->"), path


def test_sources_are_pinned() -> None:
    sources = definition_sources.load()
    assert {*sources} == {*UPSTREAMS, "pymavlink", definition_sources.WRITTEN}
    for name in UPSTREAMS:
        assert re.fullmatch("[0-9a-f]{40}", sources[name].revision)
    for name in (*UPSTREAMS, "pymavlink"):
        assert sources[name].date is not None and "common.xml" in sources[name].sha256


def test_pymavlink_is_the_version_that_was_imported() -> None:
    pinned = definition_sources.load()["pymavlink"]
    try:
        distribution = metadata.distribution("pymavlink")
    except metadata.PackageNotFoundError:
        pytest.skip("pymavlink is not installed")
    if distribution.version != pinned.revision:
        pytest.skip(f"pymavlink {distribution.version} is installed")
    folder = Path(str(distribution.locate_file("pymavlink/dialects/v20")))
    assert definition_sources.digests(folder) == pinned.sha256


@pytest.mark.skipif(
    "MAVWIRE_UPSTREAM" not in os.environ, reason="needs both upstreams' definitions"
)
@pytest.mark.parametrize("name", UPSTREAMS)
def test_both_upstreams_are_those_that_were_imported(name: str) -> None:
    folder = Path(os.environ["MAVWIRE_UPSTREAM"], UPSTREAMS[name])
    assert definition_sources.digests(folder) == definition_sources.load()[name].sha256


def test_a_checkout_tells_its_origin(tmp_path: Path) -> None:
    def git(*arguments: str) -> None:
        identity = ["-c", "user.name=a", "-c", "user.email=a@example.com"]
        subprocess.run(["git", "-C", str(tmp_path), *identity, *arguments], check=True)

    folder = tmp_path / "message_definitions" / "v1.0"
    folder.mkdir(parents=True)
    (folder / "a.xml").write_text("<mavlink/>")
    with pytest.raises(ValueError, match="--pin"):
        definition_sources.checkout(folder)
    git("init", "--quiet")
    git("remote", "add", "origin", "https://github.com/mavlink/mavlink.git")
    git("add", ".")
    git("commit", "--quiet", "-m", "Begin", "--date", "2026-01-02T00:00:00")
    source = definition_sources.checkout(folder)
    assert (source.name, len(source.revision), [*source.sha256]) == (
        "mavlink/mavlink",
        40,
        ["a.xml"],
    )


def test_a_source_is_replaced_and_others_stay(tmp_path: Path) -> None:
    path = tmp_path / "sources.toml"
    one = definition_sources.Source("a/one", "1", date(2026, 1, 2), {"x.xml": "00"})
    two = definition_sources.Source("b/two", "2", date(2026, 1, 3), {"y.xml": "11"})
    definition_sources.save(one, two, path=path)
    one.sha256 = {}
    definition_sources.save(one, path=path)
    assert definition_sources.load(path) == {"a/one": one, "b/two": two}


def test_seeds_in_comments_of_the_history_are_those_of_the_layouts() -> None:
    text = import_history.HISTORY.read_text(encoding="utf-8")
    _, layouts = json.loads(DefinitionFile("history", text).parse())
    seeds = [int(seed) for seed in re.findall(r"<!-- CRC_EXTRA (\d+), ", text)]
    assert seeds == [layout["crc_extra"] for layout in layouts]


def row(**changes: Any) -> dict[str, Any]:
    """A line of history.json that is kept."""
    return {
        "id": 300,
        "name": "SAMPLE",
        "crc_extra": 90,
        "first_commit": "2015-01-01",
        "last_commit": "2016-01-01",
        "files": ["common.xml"],
        "fields": [["a", "uint8_t"], ["b", "float", 4], ["c", "char", "ext"]],
    } | changes


@pytest.mark.parametrize(
    ("changes", "kept"),
    [
        ({}, True),
        ({"last_commit": "2011-08-31", "first_commit": "2011-01-01"}, False),
        ({"last_commit": "2017-06-21", "first_commit": "2011-01-01"}, False),
        ({"last_commit": "2015-01-14"}, False),
        ({"last_commit": "2015-01-15"}, True),
        ({"files": ["test.xml"]}, False),
        ({"files": ["test.xml", "common.xml"]}, True),
        ({"id": 301}, False),
        ({"fields": [["a", "double", 32]]}, False),
    ],
)
def test_layouts_that_logs_may_hold_are_kept(changes: dict[str, Any], kept: bool) -> None:
    assert import_history.is_kept(row(**changes), {300: 91, 301: 90}) == kept


def test_the_history_is_written_with_fields_and_times(tmp_path: Path) -> None:
    rows = [row(), row(id=299, crc_extra=90, last_commit="2015-01-02")]
    (tmp_path / "in.json").write_text(json.dumps(rows))
    output = tmp_path / "history.xml"
    arguments = [str(tmp_path / "in.json"), "--output", str(output)]
    assert import_history.main(arguments) == 1 and not output.exists()
    rows[0]["crc_extra"] = SEED
    (tmp_path / "in.json").write_text(json.dumps(rows))
    assert import_history.main(arguments) == 0
    lines = [line.strip() for line in output.read_text().splitlines()]
    assert lines[4:] == [
        f"<!-- CRC_EXTRA {SEED}, 2015-01-01 to 2016-01-01, common.xml -->",
        '<message id="300" name="SAMPLE">',
        "<description/>",
        '<field type="uint8_t" name="a"/>',
        '<field type="float[4]" name="b"/>',
        "<extensions/>",
        '<field type="char" name="c"/>',
        "</message>",
        "</messages>",
        "</mavlink>",
    ]


@pytest.mark.skipif(
    "MAVWIRE_UPSTREAM" not in os.environ, reason="needs both upstreams' definitions"
)
def test_every_layout_of_both_upstreams_is_known_with_its_fields() -> None:
    """Also those of messages whose id another file uses too."""
    folder = Path(os.environ["MAVWIRE_UPSTREAM"])
    today = import_history.layouts_of_today([folder / name for name in UPSTREAMS.values()])
    known = import_history.layouts_of_today([import_history.HISTORY.parent])
    assert len(today) > 400
    for key, layout in today.items():
        fields = layout["fields"]
        assert known[key] | {"fields": known[key]["fields"][: len(fields)]} == layout
