"""`mavwire definitions update`: newer definitions of a user, in front of those that come with mavwire."""

from __future__ import annotations

import io
import json
import lzma
import sys
import tarfile
import tomllib
import warnings
import zipfile
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from urllib import request

import pytest
from mavwire import cli, dialects
from mavwire._native import Dialect, definition_sources
from mavwire.cli._errors import CommandError
from mavwire.cli.dev import _definition_fetch
from mavwire.dialects import _installed

GREENHOUSE = """<mavlink><messages><message id="54000" name="GREENHOUSE">
<description>A house.</description>
<field type="float" name="moisture">How wet.</field></message></messages></mavlink>"""
BELOW = "mavlink-master/message_definitions/v1.0"


@pytest.fixture
def data_home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    monkeypatch.setattr(_installed, "_warned", False)
    return tmp_path / "data"


def checkout(tmp_path: Path, text: str = GREENHOUSE) -> Path:
    folder = tmp_path / BELOW
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "greenhouse.xml").write_text(text)
    return tmp_path / "mavlink-master"


def upstream(version: str = "v20") -> ModuleType:
    """A new module of the dialect."""
    module = ModuleType(f"mavwire.dialects.{version}.upstream")
    dialects.populate_builtin(module.__dict__)
    return module


def has_greenhouse() -> bool:
    return hasattr(upstream(), "MAVLINK_MSG_ID_GREENHOUSE")


def test_a_newer_set_is_the_dialect_upstream(
    data_home: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = len(upstream().mavlink_map)
    assert cli.main(["definitions", "update", str(checkout(tmp_path))]) == 0
    assert (
        f"upstream has {before + 1} messages now\n+ message GREENHOUSE (54000)\n"
        in capsys.readouterr().out
    )
    module = upstream()
    assert len(module.mavlink_map) == before + 1 and module.MAVLINK_MSG_ID_GREENHOUSE == 54000
    assert "A house." in (module.MAVLink_greenhouse_message.__doc__ or "")
    assert not hasattr(upstream("v10"), "MAVLINK_MSG_ID_GREENHOUSE")
    assert len(Dialect.builtin("upstream", "2.0").messages()) == before
    assert cli.main(["definitions"]) == 0
    printed = capsys.readouterr().out
    assert f"upstream: built in and {tmp_path / 'mavlink-master'}, installed 20" in printed
    pin = tomllib.loads(definition_sources())["mavlink/mavlink"]
    assert f"mavlink/mavlink {pin['revision'][:12]} ({pin['date']})" in printed


def test_what_an_update_replaces_is_printed_and_still_known(
    data_home: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    text = GREENHOUSE.replace('54000" name="GREENHOUSE', '60123" name="EVENT')
    changed = '<message id="44" name="MISSION_COUNT"><field type="float" name="count"/></message>'
    text = text.replace("</messages>", f"{changed}</messages>")
    before = upstream().mavlink_map
    assert cli.main(["definitions", "update", str(checkout(tmp_path, text))]) == 0
    printed = capsys.readouterr().out
    assert "+ message EVENT (60123)\n" in printed
    assert "~ message MISSION_COUNT (44) CRC_EXTRA 221 -> " in printed
    assert "~ message EVENT_CRC160 (410, before EVENT)\n" in printed
    module = upstream()
    assert module.MAVLINK_MSG_ID_EVENT == 60123
    moved = module.mavlink_map[410]
    assert (moved.msgname, moved.crc_extra) == ("EVENT_CRC160", 160)
    assert moved.fieldnames == before[410].fieldnames
    monkeypatch.setitem(sys.modules, module.__name__, module)  # a test before may have loaded it
    assert cli.main(["definitions", "show", "44"]) == 0
    assert (
        "\nOther layouts of id 44: MISSION_COUNT_CRC221 (CRC_EXTRA 221)\n"
        in capsys.readouterr().out
    )


def test_logs_are_read_with_the_newer_set(data_home: Path, tmp_path: Path) -> None:
    import subprocess

    cli.main(["definitions", "update", str(checkout(tmp_path))])
    module = dialects.load(GREENHOUSE)
    frame = module.MAVLink_greenhouse_message(1.5).pack(module.MAVLink(None))
    log = tmp_path / "a.tlog"
    log.write_bytes((1_700_000_000_000_000).to_bytes(8, "big") + frame)
    command = "import sys, mavwire; print(mavwire.open_log(sys.argv[1])['GREENHOUSE']['moisture'].tolist())"
    run = [sys.executable, "-c", command, str(log)]
    assert subprocess.run(run, check=True, capture_output=True, text=True).stdout == "[1.5]\n"


def test_reverting_goes_back_step_by_step(
    data_home: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    cli.main(["definitions", "update", str(checkout(tmp_path))])
    cli.main(
        ["definitions", "update", str(checkout(tmp_path, GREENHOUSE.replace("54000", "54001")))]
    )
    assert upstream().MAVLINK_MSG_ID_GREENHOUSE == 54001
    assert cli.main(["definitions", "update", "--revert"]) == 0
    assert upstream().MAVLINK_MSG_ID_GREENHOUSE == 54000
    assert cli.main(["definitions", "update", "--revert"]) == 0
    assert not has_greenhouse()
    assert "upstream: built in" in capsys.readouterr().out
    assert cli.main(["definitions", "update", "--revert"]) == 1
    assert "no definitions are installed" in capsys.readouterr().err


def test_a_wrong_set_replaces_nothing(
    data_home: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    cli.main(["definitions", "update", str(checkout(tmp_path))])
    installed = Path(_installed.archive()).read_bytes()
    wrong = GREENHOUSE.replace("float", "floaty")
    assert cli.main(["definitions", "update", str(checkout(tmp_path, wrong))]) == 1
    error = capsys.readouterr().err
    assert "nothing installed: greenhouse.xml:3" in error
    assert Path(_installed.archive()).read_bytes() == installed
    assert sorted(path.name for path in (data_home / "mavwire").iterdir()) == ["upstream.zip"]


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04 no archive", None, b"facts"])
def test_a_broken_set_is_one_warning_and_the_built_in_set(
    content: bytes | None, data_home: Path
) -> None:
    path = Path(_installed.archive())
    path.parent.mkdir(parents=True)
    if content == b"facts":
        content = _installed.packed([{"a": "<mavlink>"}], {})
    path.mkdir() if content is None else path.write_bytes(content)
    with pytest.warns(UserWarning, match=r"upstream\.zip: .*: definitions not used"):
        assert not has_greenhouse()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert len(upstream("v10").mavlink_map) == len(
            Dialect.builtin("upstream", "1.0").messages()
        )


def zipped(files: dict[str, str]) -> bytes:
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w") as archive:
        for name, text in files.items():
            archive.writestr(name, text)
    return data.getvalue()


def tarred(files: dict[str, str]) -> bytes:
    data = io.BytesIO()
    with tarfile.open(fileobj=data, mode="w:gz") as archive:
        for name, text in files.items():
            info = tarfile.TarInfo(name)
            info.size, info.mtime = len(text), 1_750_000_000
            archive.addfile(info, io.BytesIO(text.encode()))
        link = tarfile.TarInfo(f"{BELOW}/link.xml")
        link.type, link.linkname = tarfile.SYMTYPE, "/etc/passwd"
        archive.addfile(link)
    return data.getvalue()


FILES = {
    f"{BELOW}/greenhouse.xml": GREENHOUSE,
    "mavlink-master/pom.xml": "<project/>",
    "../outside.xml": "<mavlink/>",
}


@pytest.mark.parametrize("pack", [zipped, tarred])
def test_archives(pack: Callable[[dict[str, str]], bytes], tmp_path: Path) -> None:
    path = tmp_path / "archive"
    path.write_bytes(pack(FILES))
    texts, newest = _definition_fetch.fetch(str(path))
    assert texts == {"greenhouse": GREENHOUSE} and newest is not None
    path.write_bytes(pack({"a/x.xml": GREENHOUSE, "b/x.xml": GREENHOUSE}))
    with pytest.raises(CommandError, match=r"no folder message_definitions/v1\.0"):
        _definition_fetch.fetch(str(path))


@pytest.mark.parametrize(
    "data",
    [b"", b"PK\x03\x04", tarred(FILES)[:-40], lzma.compress(bytes(9000))[:-40], zipped(FILES)[60:]],
    ids=["empty", "zip", "gzip", "xz", "cut"],
)
def test_a_file_that_is_no_archive_is_refused(data: bytes, tmp_path: Path) -> None:
    (tmp_path / "a.zip").write_bytes(data)
    with pytest.raises(CommandError, match=r"not a zip or tar archive|no folder"):
        _definition_fetch.fetch(str(tmp_path / "a.zip"))


@pytest.mark.parametrize(
    ("name", "limit", "text"),
    [
        ("MAX_UNPACKED", 10, "unpacks to more than 10 bytes"),
        ("MAX_DOWNLOAD", 10, "larger than 10 bytes"),
    ],
)
def test_sizes_are_bounded(
    name: str, limit: int, text: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    served(monkeypatch, {"https://x.example/a.zip": zipped(FILES)})
    monkeypatch.setattr(_definition_fetch, name, limit)
    with pytest.raises(CommandError, match=text):
        _definition_fetch.fetch("https://x.example/a.zip")


def served(monkeypatch: pytest.MonkeyPatch, pages: dict[str, bytes]) -> None:
    """What addresses give."""

    class Opener:
        def open(self, address: str, timeout: float) -> io.BytesIO:
            if address not in pages:
                raise OSError("HTTP Error 404: Not Found")
            return io.BytesIO(pages[address])

    monkeypatch.setattr(request, "build_opener", lambda *_: Opener())


def test_an_address_of_xml_gives_the_files_that_it_includes(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    whole = b"<mavlink><include>greenhouse.xml</include><include>all.xml</include></mavlink>"
    pages = {
        "https://x.example/v1.0/all.xml": whole,
        "https://x.example/v1.0/greenhouse.xml": GREENHOUSE.encode(),
    }
    served(monkeypatch, pages)
    texts, newest = _definition_fetch.fetch("https://x.example/v1.0/")
    assert sorted(texts) == ["all", "greenhouse"] and newest is None
    del pages["https://x.example/v1.0/greenhouse.xml"]
    with pytest.raises(CommandError, match=r"greenhouse\.xml: HTTP Error 404"):
        _definition_fetch.fetch("https://x.example/v1.0/")


@pytest.mark.parametrize("address", ["http://x.example/a.zip", "file:///etc/passwd", "ftp://x/a"])
def test_only_https_is_used(address: str) -> None:
    with pytest.raises(CommandError, match="https alone"):
        _definition_fetch.fetch(address)
    handler = _definition_fetch._OnlyHttps()
    with pytest.raises(CommandError, match="https alone"):
        handler.redirect_request(request.Request("https://x"), None, 302, "", {}, address)


def test_differences_of_dialects(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert cli.main(["definitions", "diff", "common", "common"]) == 0
    assert capsys.readouterr().out == "no difference\n"
    assert cli.main(["definitions", "diff", "all", "upstream"]) == 0
    printed = capsys.readouterr().out
    assert "+ message EVENT (410)\n" in printed
    assert "~ message MISSION_ACK (47)\n  + field opaque_id: uint32_t extension\n" in printed
    assert cli.main(["definitions", "diff", "--json", "minimal", str(checkout(tmp_path))]) == 0
    difference = json.loads(capsys.readouterr().out)
    assert difference["messages"]["added"] == {"54000": "GREENHOUSE"}
    assert difference["messages"]["removed"]["0"] == "HEARTBEAT"


@pytest.mark.parametrize("name", ["nosuch", "nosuch.xml"])
def test_a_set_that_is_missing_is_named(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["definitions", "diff", "common", name]) == 1
    assert name in capsys.readouterr().err
