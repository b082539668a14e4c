"""message_definitions/sources.toml names the origin of what is committed, and the tools write it."""

from __future__ import annotations

import json
import os
import re
import subprocess
from datetime import date
from importlib import metadata
from pathlib import Path

import definition_sources
import pytest
from mavwire._native import DefinitionFile
from mavwire.cli.dev._definition_facts import definition_files, messages_of

DEFINITIONS = definition_sources.DEFINITIONS
UPSTREAMS = {"ArduPilot/mavlink": "ardupilot", "mavlink/mavlink": "mavlink"}


def test_digests_are_those_of_the_files() -> None:
    written = {
        path.relative_to(DEFINITIONS).as_posix(): definition_sources.digest(path)
        for path in DEFINITIONS.glob("*/*.xml")
    }
    assert definition_sources.load()[definition_sources.WRITTEN].sha256 == written


def test_headers_name_the_tool_that_wrote_the_file() -> None:
    tools = {"v1.0": "import_definitions", "upstream": "union_definitions"}
    for path in DEFINITIONS.glob("*/*.xml"):
        head = path.read_text(encoding="utf-8").splitlines()[1]
        tool = tools[path.parent.name]
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
    text = definition_sources.HISTORY.read_text(encoding="utf-8")
    _, layouts = json.loads(DefinitionFile("history", text).parse())
    seeds = [int(seed) for seed in re.findall(r"<!-- CRC_EXTRA (\d+), ", text)]
    assert seeds == [layout["crc_extra"] for layout in layouts]


@pytest.mark.skipif(
    "MAVWIRE_UPSTREAM" not in os.environ, reason="needs both upstreams' definitions"
)
def test_every_layout_of_both_upstreams_is_known_with_its_fields() -> None:
    """Also those of messages whose id another file uses too."""
    folder = Path(os.environ["MAVWIRE_UPSTREAM"])
    today = layouts(*(folder / name for name in UPSTREAMS.values()))
    known = layouts(DEFINITIONS / "upstream")
    assert len(today) > 400
    for key, fields in today.items():
        assert known[key][: len(fields)] == fields


def layouts(*folders: Path) -> dict[tuple[int, str, int], list[tuple[str, str, bool]]]:
    """The fields of each layout by id, name and CRC_EXTRA."""
    files = (path for folder in folders for path in definition_files(folder))
    texts = (DefinitionFile(str(one), one.read_text("utf-8-sig")).parse() for one in files)
    rows = (row for text in texts for row in messages_of(*json.loads(text)))
    return {(id_, *message.key): message.wire for id_, message in rows}
