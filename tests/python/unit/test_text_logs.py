"""Text dataflash logs: lines without times, types without fields."""

from __future__ import annotations

import mavwire
from dataflash_writer import Log
from mavwire.DFReader import DFReader_binary, DFReader_text

HEAD = """FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns
FMT, 1, 20, ATT, Iff, TimeMS,Roll,Pitch
FMT, 3, 6, MODE, Mhh, Mode,ThrCrs,Rsn
FMT, 10, 3, STRT, , 
FMT, 4, 4, EV, B, Id
"""  # noqa: W291
LINES = """MODE, STABILIZE, 1, 2
ATT, 1000, 1.0, 2.0
STRT
STRT, 
ATT, 5000, 1.5, 2.0
MODE, LOITER, 1, 2
ATT, 9000, 1.5, 2.0
EV, 11
"""  # noqa: W291


def test_the_last_mode_lasts_until_the_last_time(tmp_path):
    (tmp_path / "x.log").write_text(HEAD + LINES)
    with DFReader_text(str(tmp_path / "x.log")) as log:
        assert log.last_timestamp() == 9.0
        assert log.flightmode_list() == [("STABILIZE", 0, 0), ("LOITER", 0, 9.0)]
    (tmp_path / "x.log").write_text(HEAD + LINES + "ATT, 9500")  # cut off: no record
    with DFReader_text(str(tmp_path / "x.log")) as log:
        assert log.last_timestamp() == 9.0


def test_no_time_of_a_binary_log_is_an_integer_as_in_its_messages(tmp_path):
    log = Log().define("ATT", "If", "TimeMS,Roll", 1).define("MODE", "Mh", "Mode,ThrCrs", 2)
    log.add("MODE", 0, 1).add("ATT", 1000, 1).add("MODE", 0, 2)
    with DFReader_binary(log.write(tmp_path / "x.BIN")) as reader:
        modes = reader.flightmode_list()
    assert modes == [("STABILIZE", 0, 0)]
    assert [type(time) for time in modes[0][1:]] == [int, int]


def test_a_type_without_fields_is_there(tmp_path):
    path = tmp_path / "x.log"
    path.write_text(HEAD + LINES)
    with DFReader_text(str(path)) as log:
        assert list(log.formats) == ["FMT", "ATT", "MODE", "STRT", "EV"]
        assert log.name_to_id["STRT"] == 10 and log.counts["STRT"] == 2
        found = [str(msg) for msg in iter(log.recv_msg, None)]
    assert found[3] == "FMT {Type : 10, Length : 3, Name : STRT, Format : , Columns : }"
    assert found.count("STRT {}") == 2
    tables = mavwire.read(path)
    assert len(tables["STRT"]) == 2 and len(tables["FMT"]) == 5
    assert tables["STRT"].columns == ["timestamp"]
    assert mavwire.open_log(path).info().bad_bytes == 0
