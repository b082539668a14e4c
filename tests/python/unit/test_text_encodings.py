"""Text logs with a byte order mark are read as any other. Those in UTF-16 or with carriage returns alone are refused."""

from __future__ import annotations

import gzip
from pathlib import Path

import mavwire
import pytest
from mavwire import cli, mavutil
from mavwire.CSVReader import CSVReader
from mavwire.DFReader import DFReader_is_text_log, DFReader_text
from mavwire.logs.conversion import convert

TEXT = """FMT, 1, 20, ATT, Iff, TimeMS,Roll,Pitch
FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns
FMT, 4, 75, MSG, IZ, TimeMS,Message
ATT, 1000, 1.0, 2.0
ATT, 5000, 1.5, 2.0
MSG, 5500, Grüße \U0001f681
"""
MARK = "\ufeff"
WRITTEN = {
    "plain": TEXT.encode(),
    "mark": (MARK + TEXT).encode(),
    "windows": (MARK + TEXT).replace("\n", "\r\n").encode(),
}
REFUSED = {
    "little": (MARK + TEXT).replace("\n", "\r\n").encode("utf-16-le"),
    "big": (MARK + TEXT).encode("utf-16-be"),
    "returns": TEXT.replace("\n", "\r").encode(),
    "both": (MARK + TEXT).replace("\n", "\r").encode("utf-16-le"),
}


@pytest.fixture(params=sorted(WRITTEN))
def log(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    path = tmp_path / "flight.log"
    path.write_bytes(WRITTEN[request.param])
    return path


def test_messages(log):
    assert DFReader_is_text_log(str(log))
    assert (
        mavwire.links.recognise.log_kind(str(log), True) is mavwire._native.LogKind.DATAFLASH_TEXT
    )
    for opened in (DFReader_text(str(log)), mavutil.mavlink_connection(str(log))):
        with opened as reader:
            assert isinstance(reader, DFReader_text)
            for _ in range(2):
                found = [str(msg) for msg in iter(reader.recv_msg, None)]
                assert found[3:] == [
                    "ATT {TimeMS : 1000, Roll : 1.0, Pitch : 2.0}",
                    "ATT {TimeMS : 5000, Roll : 1.5, Pitch : 2.0}",
                    "MSG {TimeMS : 5500, Message : Grüße \U0001f681}",
                ]
                assert found[0].startswith("FMT {Type : 1, ")
                reader.rewind()
            assert reader.last_timestamp() == 5.5
            assert [len(found) for found in reader.offsets.values()] == [3, 2, 1]


@pytest.mark.parametrize("written", sorted(REFUSED))
@pytest.mark.parametrize("name", ["flight.log", "flight.txt"])
def test_other_encodings_are_refused_with_advice(tmp_path, capsys, written, name):
    """pymavlink finds no messages in them."""
    path = tmp_path / name
    path.write_bytes(REFUSED[written])
    for read in (DFReader_text, mavutil.mavlink_connection, mavwire.read):
        with pytest.raises(ValueError, match=r"carriage returns alone.*iconv -f UTF-16") as told:
            read(str(path))
        assert name in str(told.value)
    [row] = convert([path], tmp_path / "out")
    assert "iconv -f UTF-16" in row.error
    assert cli.main(["info", str(path)]) != 0
    assert "iconv -f UTF-16" in capsys.readouterr().err


def test_tables(log, tmp_path, capsys):
    tables = mavwire.read(log)
    assert tables["ATT"]["Roll"].tolist() == [1.0, 1.5]
    assert list(tables["MSG"]["Message"]) == ["Grüße \U0001f681"]
    opened = mavwire.open_log(log)
    assert len(list(opened.messages("ATT"))) == len(opened["ATT"]) == 2
    info = opened.info()
    assert {name: one.messages for name, one in info.types.items()} == {
        "FMT": 3,
        "ATT": 2,
        "MSG": 1,
    }
    assert info.bad_bytes == 0
    assert sum(map(len, mavwire.scan(log, "ATT"))) == 2
    [row] = convert([log], tmp_path / "out")
    assert row.error is None and row.rows == 6
    for command in (["info", str(log)], ["dump", "--types", "ATT", str(log)]):
        assert cli.main(command) == 0
        assert "ATT" in capsys.readouterr().out
    packed = tmp_path / "packed.log.gz"
    packed.write_bytes(gzip.compress(log.read_bytes()))
    assert mavwire.read(packed)["ATT"]["Roll"].tolist() == [1.0, 1.5]


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_rows(tmp_path, encoding, end):
    path = tmp_path / "x.csv"
    path.write_bytes(end.join(("time;name", "1;Grüße", "2;b", "")).encode(encoding))
    reader = CSVReader(str(path))
    assert reader.fmt.headings == ["time", "name"]
    for _ in range(2):
        found = [(msg.time, msg.name) for msg in iter(reader.recv_msg, None)]
        assert found == [(1.0, "Grüße"), (2.0, "b")]
        reader.rewind()
    reader.close()
    linked = mavutil.mavlink_connection(f"csv:{path}")
    assert linked.recv_msg().get_fieldnames() == ["time", "name"]


def test_other_bytes_stay_as_they_are(tmp_path):
    """A mark inside of a text is a character, and a frame may begin as a mark does."""
    path = tmp_path / "flight.log"
    path.write_text(TEXT + f"MSG, 6000, {MARK}x\r\n", encoding="utf-8")
    assert mavwire.read(path)["MSG"]["Message"][1] == f"{MARK}x"
    path = tmp_path / "x.log"
    path.write_bytes(b"\xff\xfe" + bytes(range(256)) * 40)
    with pytest.raises(mavwire.LogFormatError):
        mavwire.read(path)
