"""`mavwire definitions`: storing XML whose descriptions then appear."""

from __future__ import annotations

import ast
import errno
import os
from pathlib import Path

import pytest
from mavwire import cli, dialects
from mavwire.cli.dev import definitions
from mavwire.dialects import _sources
from mavwire.dialects._descriptions import Texts, installed_folder

XML = """<mavlink>
  <messages>
    <message id="{id}" name="SAMPLE">
      <description>What a sample is.</description>
      <field type="uint8_t" name="level" units="%">How full it is.</field>
    </message>
  </messages>
</mavlink>
"""


@pytest.fixture
def data_home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    monkeypatch.delenv("MDEF", raising=False)
    return tmp_path / "data"


def _folder(tmp_path: Path, name: str, text: str) -> Path:
    folder = tmp_path / "xml"
    folder.mkdir(exist_ok=True)
    (folder / f"{name}.xml").write_text(text)
    return folder


def test_stored_descriptions_are_found(data_home: Path, tmp_path: Path) -> None:
    folder = _folder(tmp_path, "sample", XML.format(id=1))
    assert cli.main(["definitions", "sync", str(folder)]) == 0
    text, fields = Texts("sample").message("SAMPLE")
    assert text == "What a sample is."
    assert fields == {"level": "How full it is."}


def test_the_union_has_the_descriptions_of_all_stored_files(
    data_home: Path, tmp_path: Path
) -> None:
    folder = _folder(tmp_path, "sample", XML.format(id=1))
    (folder / "other.xml").write_text(XML.format(id=2).replace("SAMPLE", "OTHER"))
    assert cli.main(["definitions", "sync", str(folder)]) == 0
    for name in ("SAMPLE", "OTHER"):
        assert Texts("upstream").message(name)[0] == "What a sample is."


def test_several_folders_are_stored_and_the_first_one_counts(
    data_home: Path, tmp_path: Path
) -> None:
    texts = [
        XML.format(id=1).replace("SAMPLE", name).replace("a sample", f"{name} in {where}")
        for where, name in (("one", "FIRST"), ("one", "BOTH"), ("two", "BOTH"), ("two", "SECOND"))
    ]
    folders = [tmp_path / "one", tmp_path / "two"]
    for folder, files in zip(folders, (texts[:2], texts[2:]), strict=True):
        folder.mkdir()
        for number, text in enumerate(files):
            (folder / f"file{number}.xml").write_text(text)
    assert cli.main(["definitions", "sync", *map(str, folders)]) == 0
    for name, place in (("FIRST", "one"), ("BOTH", "one"), ("SECOND", "two")):
        assert Texts("upstream").message(name)[0] == f"What {name} in {place} is."


def test_descriptions_of_an_installed_pymavlink_are_stored(
    data_home: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = installed_folder()
    if folder is not None:
        assert cli.main(["definitions", "sync"]) == 0
        assert (data_home / "mavwire" / "definitions" / "000" / "common.xml").is_file()
    monkeypatch.setattr(definitions, "installed_folder", lambda: None)
    assert cli.main(["definitions", "sync"]) == 1
    assert "pymavlink is not installed" in capsys.readouterr().err


def test_one_wrong_file_stores_nothing(
    data_home: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    _folder(tmp_path, "good", XML.format(id=1))
    folder = _folder(tmp_path, "wrong", XML.format(id=2**24))
    assert cli.main(["definitions", "sync", str(folder)]) == 1
    error = capsys.readouterr().err
    assert "wrong" in error
    assert "nothing stored" in error
    assert not data_home.exists() or not list(data_home.rglob("*.xml"))


def test_status_and_clear(
    data_home: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["definitions", "status"]) == 0
    assert "nothing stored" in capsys.readouterr().out
    cli.main(["definitions", "sync", str(_folder(tmp_path, "sample", XML.format(id=1)))])
    cli.main(["definitions", "status"])
    assert "1 definition files" in capsys.readouterr().out
    cli.main(["definitions", "clear"])
    assert not list(data_home.rglob("*.xml"))


def test_what_cannot_be_stored_leaves_nothing_beside(
    data_home: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def refuse(*_: object) -> None:
        raise OSError(errno.EIO, "Input/output error")

    monkeypatch.setattr("os.replace", refuse)
    folder = _folder(tmp_path, "sample", XML.format(id=1))
    assert cli.main(["definitions", "sync", str(folder)]) == 1
    assert capsys.readouterr().err.endswith("definitions: Input/output error\n")
    assert not list(data_home.rglob("*.xml")) and not list(data_home.rglob("definitions-*"))


def test_what_cannot_be_removed_is_told(
    data_home: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    cli.main(["definitions", "sync", str(_folder(tmp_path, "sample", XML.format(id=1)))])
    for name in ("os.unlink", "os.rmdir"):
        monkeypatch.setattr(name, lambda *_, **__: os.stat("/none"))
    capsys.readouterr()
    assert cli.main(["definitions", "clear"]) == 1
    printed = capsys.readouterr()
    assert printed.out == "" and printed.err.startswith("mavwire definitions: error: ")
    assert list(data_home.rglob("*.xml"))


@pytest.mark.parametrize("target", ["real", "nowhere"])
def test_a_link_in_place_of_the_folder_is_removed_alone(
    target: str, data_home: Path, tmp_path: Path
) -> None:
    real = _folder(tmp_path, "real", XML.format(id=1))
    link = data_home / "mavwire" / "definitions"
    link.parent.mkdir(parents=True)
    link.symlink_to(real if target == "real" else tmp_path / target, target_is_directory=True)
    assert cli.main(["definitions", "clear"]) == 0
    assert not link.is_symlink() and list(real.iterdir())


@pytest.mark.parametrize("folder", ["missing", "."])
def test_a_folder_without_definitions_is_refused(
    folder: str, data_home: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["definitions", "sync", str(tmp_path / folder)]) == 1
    assert "xml" in capsys.readouterr().err


def test_includes_are_found_however_they_are_spaced(tmp_path: Path) -> None:
    folder = _folder(tmp_path, "part", XML.format(id=150))
    (folder / "none.xml").write_text("<mavlink/>")
    (folder / "main.xml").write_text(
        "<mavlink><include >\n  part.xml\t</include ><include> </include>"
        "<!-- <include>none.xml</include> --></mavlink>"
    )
    main, sources = _sources.collect(folder / "main.xml", None)
    assert (main, sorted(sources)) == ("main", ["main", "part"])


def test_an_include_of_spaces_takes_linear_time(tmp_path: Path) -> None:
    folder = _folder(tmp_path, "main", f"<mavlink><include>x{' ' * 1_000_000}<y/></include>")
    with pytest.raises(ValueError, match=r"main\.xml:1:"):
        dialects.load(folder / "main.xml")


def test_stored_definitions_that_cannot_be_read_are_passed_over(
    data_home: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = data_home / "mavwire" / "definitions" / "000"
    folder.mkdir(parents=True)
    (folder / "sample.xml").write_text(XML.format(id=150))
    monkeypatch.setattr(_sources, "MAX_BYTES", 10)
    assert Texts("sample").message("SAMPLE") == ("", {})


def test_stubs_have_stored_descriptions(
    data_home: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = XML.format(id=30).replace("SAMPLE", "ATTITUDE").replace("level", "roll")
    cli.main(
        ["definitions", "sync", str(_folder(tmp_path, "common", text.replace("full", '"full"')))]
    )
    assert cli.main(["definitions", "stubs", str(tmp_path)]) == 0
    package = tmp_path / "mavwire-stubs"
    assert f"described messages in {package}" in capsys.readouterr().out
    assert (package / "py.typed").read_text() == "partial\n"
    stub = package / "dialects" / "v20" / "_own" / "common.pyi"
    (found,) = (
        node
        for node in ast.parse(stub.read_text()).body
        if isinstance(node, ast.ClassDef) and node.name == "MAVLink_attitude_message"
    )
    assert ast.get_docstring(found) == "What a sample is."
    assert '    roll: float  # rad\n    """How \\"full\\" it is."""\n' in stub.read_text()
    source = Path(dialects.__file__).parent
    names = {path.relative_to(source) for path in source.glob("v?0/**/*.pyi")}
    assert names == {path.relative_to(package / "dialects") for path in package.rglob("*.pyi")}
