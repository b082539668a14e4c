"""Every snippet of docs/cookbook.md runs, one behind the other, in a folder with two logs."""

from __future__ import annotations

import contextlib
import io
import re
import shlex
from pathlib import Path
from typing import Any

import pytest
from mavwire import cli, traffic

COOKBOOK = Path(__file__).parents[3] / "docs" / "cookbook.md"
SNIPPET = re.compile(r"^```(python|sh)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
SECTIONS = re.split(r"^## ", COOKBOOK.read_text(), flags=re.MULTILINE)[1:]
NEEDS = {
    "pandas": ["pandas"],
    "polars": ["polars"],
    "DuckDB": ["duckdb", "pyarrow"],
    "pyarrow, and what knows the Arrow PyCapsule interface": ["pyarrow"],
    "Logs larger than memory": [],
    "PlotJuggler": [],
    "Foxglove": ["mcap_protobuf"],
}


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("cookbook")
    traffic.generate(folder / "flight.tlog", 3_000)
    traffic.generate(folder / "other.tlog", 1_000, seed=2)
    return folder


@pytest.mark.parametrize("section", SECTIONS, ids=[one.split("\n")[0] for one in SECTIONS])
def test_the_snippets_of_a_section_run(section, logs, monkeypatch):
    for module in NEEDS[section.split("\n")[0]]:
        pytest.importorskip(module)
    monkeypatch.chdir(logs)
    snippets = SNIPPET.findall(section)
    assert len(snippets) == section.count("```") // 2
    scope: dict[str, Any] = {}
    printed = io.StringIO()
    for language, text in snippets:
        with contextlib.redirect_stdout(printed):
            if language == "python":
                exec(compile(text, str(COOKBOOK), "exec"), scope)
                continue
            for line in text.splitlines():
                program, *argv = shlex.split(line, comments=True)
                assert (program, cli.main(argv)) == ("mavwire", 0), line
    if "print(" in section:
        assert len(printed.getvalue().splitlines()) > 1


def test_all_sections_are_known():
    assert [one.split("\n")[0] for one in SECTIONS] == list(NEEDS)
