"""Dataflash logs that lack their first part, in which they say what their records are."""

from __future__ import annotations

import gzip
import random
import re
from pathlib import Path

import mavwire
import pytest
from dataflash_writer import FMT, HEAD, Log, flight, fmt
from mavwire import cli, fleet, mavutil
from mavwire.logs.conversion import convert
from mavwire.logs.format_error import LogFormatError
from mavwire.logs.rewriting import cut
from mavwire.logs.telemetry import TelemetryLog
from unit.link_tools import heartbeat, record
from unit.test_logs_in_logs import downloaded

LACKS = (
    "a dataflash log without its first part, which says what the records are (FMT);"
    " copy it again from its start"
)
HEAD_BYTES = 64 << 10
"""What readers look at to tell what a log is."""


def headerless(seconds: int = 600, *, lookalikes: int = 1) -> bytes:
    """A flight behind its descriptions, with some bytes that are a good record of telemetry."""
    log = flight(seconds)
    described = log.data.rindex(fmt(166, "IMU", "QBfff", "TimeUS,I,AccX,AccY,AccZ"))
    records = bytes(log.data[described + 300 :])
    text = record(heartbeat(3)).ljust(64, b"\0")
    message = HEAD + bytes([164]) + bytes(8) + text
    places = [len(records) * n // (lookalikes + 1) for n in range(1, lookalikes + 1)]
    pieces = [records[a:b] for a, b in zip([0, *places], [*places, None], strict=True)]
    return message.join(pieces)


@pytest.fixture
def lacking(tmp_path: Path) -> Path:
    path = tmp_path / "cut.BIN"
    path.write_bytes(headerless())
    return path


def test_it_holds_what_telemetry_would_be_taken_for(lacking: Path) -> None:
    with mavutil.mavmmaplog(str(lacking), resync="rescan") as log:
        assert any(msg.get_msgId() >= 0 for msg in iter(log.recv_msg, None))
    with pytest.raises(LogFormatError, match="a dataflash log, not a telemetry log"):
        TelemetryLog(lacking)


@pytest.mark.parametrize("name", ["cut.BIN", "cut.dat", "cut.tlog", "cut.BIN.gz"])
@pytest.mark.parametrize("wanted", [None, "HEARTBEAT", "ATT"])
def test_each_way_to_read_says_what_is_missing(
    tmp_path: Path, name: str, wanted: str | None, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / name
    path.write_bytes(gzip.compress(headerless()) if name.endswith(".gz") else headerless())
    ways = (
        lambda: mavwire.open_log(path),
        lambda: mavwire.read(path, wanted),
        lambda: list(mavwire.scan(path, wanted)),
        lambda: fleet.decode(path, types=wanted),
        lambda: cut(path, tmp_path / "out.tlog"),
    )
    for way in ways:
        with pytest.raises(LogFormatError, match=f"^{re.escape(LACKS)}: {str(path)!r}$"):
            way()
    assert cli.main(["info", str(path)]) == 1
    assert capsys.readouterr() == ("", f"mavwire info: {path}: {LACKS}\n")
    types = [] if wanted is None else ["--types", wanted]
    for fields in ([], ["--fields", "AccX"]):
        out = ["-o", str(tmp_path / "out")]
        assert cli.main(["convert", str(path), *out, *types, *fields]) == 1
        assert capsys.readouterr() == ("", f"mavwire convert: {path}: {LACKS}\n")


@pytest.mark.parametrize("name", ["cut.BIN", "cut.dat", "cut.tlog"])
@pytest.mark.parametrize("command", ["dump", "parms", "flightmodes", "summarize"])
def test_commands_that_read_messages_say_it_too(
    tmp_path: Path, name: str, command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / name
    path.write_bytes(headerless())
    assert cli.main([command, str(path)]) == 0
    assert capsys.readouterr().err == f"mavwire {command}: {LACKS}: {str(path)!r}\n"


def test_a_description_that_chance_made_is_none(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "cut.BIN"
    path.write_bytes(headerless() + HEAD + bytes(range(128, 128 + 87)) + headerless())
    assert cli.main(["dump", str(path)]) == 0
    assert capsys.readouterr().err == f"mavwire dump: {LACKS}: {str(path)!r}\n"
    assert cli.main(["info", str(path)]) == 1


@pytest.mark.parametrize("name", ["cut.BIN", "cut.dat", "cut.tlog"])
@pytest.mark.parametrize(
    "command", [["plot", "ATT.Roll"], ["plot", "HEARTBEAT.type"], ["map"]], ids=" ".join
)
def test_pictures_say_it_too(
    tmp_path: Path, name: str, command: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    path, out = tmp_path / name, tmp_path / "out.html"
    path.write_bytes(headerless())
    assert cli.main([command[0], str(path), *command[1:], "-o", str(out)]) == 1
    assert capsys.readouterr().err == f"mavwire {command[0]}: error: {LACKS}: {str(path)!r}\n"
    assert not out.exists()


def test_it_is_told_wherever_it_was_cut(tmp_path: Path) -> None:
    log, path = headerless(60, lookalikes=3), tmp_path / "cut.BIN"
    for at in (0, 1, 17, 1000, len(log) // 2, len(log) - 4000):
        for before in (b"", bytes(900), b"\xfd\xfe" * 300):
            path.write_bytes(before + log[at:])
            with pytest.raises(LogFormatError, match="without its first part"):
                mavwire.read(path)


def test_a_frame_of_it_says_so_before_it_is_collected(lacking: Path) -> None:
    pytest.importorskip("polars")
    with pytest.raises(LogFormatError, match="without its first part"):
        mavwire.scan_polars(lacking, "ATT")


def test_among_others_it_is_a_row_with_an_error(lacking: Path, tmp_path: Path) -> None:
    whole = flight().write(tmp_path / "whole.BIN")
    rows = convert([lacking, whole], tmp_path / "out", types=["ATT"])
    assert [row.error for row in rows] == [LACKS, None]
    assert rows[1].rows == 200


def test_what_is_described_further_on_is_read(tmp_path: Path) -> None:
    path = tmp_path / "cut.BIN"
    att = fmt(165, "ATT", "Qff", "TimeUS,Roll,Pitch")
    assert len(headerless()) > HEAD_BYTES
    path.write_bytes(headerless() + FMT + att + headerless(10))
    log = mavwire.open_log(path)
    assert list(log.types) == ["FMT", "ATT"]
    rows = len(log["ATT"])  # but for those that end where records of other types are cut off
    assert 6090 < rows <= path.read_bytes().count(HEAD + bytes([165]))
    assert rows == log.info().types["ATT"].messages == len(mavwire.read(path)["ATT"])


def test_damage_in_the_head_alone_is_none_of_it(tmp_path: Path) -> None:
    path = tmp_path / "damaged.BIN"
    path.write_bytes(bytes(40) + bytes(flight(60).data)[40:])
    assert len(mavwire.open_log(path)["ATT"]) == 600


def test_zeros_in_place_of_the_first_bytes_make_no_text_log(tmp_path: Path) -> None:
    path, out = tmp_path / "damaged.BIN", tmp_path / "out.html"
    path.write_bytes(bytes(200) + bytes(flight(60).data)[200:])
    assert cli.main(["plot", str(path), "ATT.Roll", "-o", str(out)]) == 0
    assert out.exists()


@pytest.mark.parametrize("framing", ["stamped", "raw"])
@pytest.mark.parametrize("kept", [0.3, 0.5, 0.9])
def test_a_damaged_log_of_a_download_stays_telemetry(
    tmp_path: Path, framing: str, kept: float
) -> None:
    chosen, path = random.Random(7), tmp_path / "log.tlog"
    frames = [one if framing == "raw" else record(one) for one in downloaded("LOG_DATA")]
    for place, one in enumerate(frames):
        if chosen.random() > kept:
            frames[place] = one[: chosen.randrange(len(one))] + bytes(3)
    path.write_bytes(b"".join(frames))
    whole = len(mavwire.read(path, "LOG_DATA")["LOG_DATA"])
    assert whole > kept * len(frames) * 0.7
    assert mavwire.open_log(path).info().types["LOG_DATA"].messages == whole


@pytest.mark.parametrize("messages", [1, 2, 3, 40])
def test_few_messages_in_noise_stay_telemetry(tmp_path: Path, messages: int) -> None:
    chosen, path = random.Random(messages), tmp_path / "stream.raw"
    pieces = [chosen.randbytes(20_000) + heartbeat(n) for n in range(messages)]
    path.write_bytes(heartbeat(200) + b"".join(pieces))
    assert len(mavwire.read(path, "HEARTBEAT")["HEARTBEAT"]) == messages + 1


class TestRanges:
    """Of `fleet.decode`."""

    @pytest.mark.parametrize("wanted", [None, "HEARTBEAT", "ATT"])
    @pytest.mark.parametrize("stamped", [(), (True,), (False,)])
    def test_one_without_descriptions_is_refused(
        self, tmp_path: Path, wanted: str | None, stamped: tuple[bool, ...]
    ) -> None:
        log = flight(60).raw(headerless(60)).write(tmp_path / "flight.BIN")
        size = Path(log).stat().st_size
        for first, end in (5000, size), (5000, 5100), (size - 50, size), (3000, 3000):
            with pytest.raises(LogFormatError, match="no range of a dataflash log"):
                fleet.decode(log, (first, end, *stamped), wanted)

    def test_one_from_the_start_is_a_log(self, tmp_path: Path) -> None:
        log = flight(60)
        path = log.write(tmp_path / "flight.BIN")
        assert len(fleet.decode(path, (0, len(log.data)), "ATT")["ATT"]) == 600
        assert 0 < len(fleet.decode(path, (0, 20_000), "ATT")["ATT"]) < 300
        assert fleet.decode(path, (0, 50)) == {}

    def test_one_with_descriptions_of_its_own_is_a_log(self, tmp_path: Path) -> None:
        both, second = Log().raw(headerless(10)), flight(60)
        start = len(both.data)
        path = both.raw(bytes(second.data)).write(tmp_path / "two.BIN")
        tables = fleet.decode(path, (start, start + len(second.data)))
        assert len(tables["ATT"]) == 600

    def test_one_of_a_text_log_is_refused(self, tmp_path: Path) -> None:
        path = tmp_path / "flight.log"
        path.write_text("FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n" * 30)
        with pytest.raises(LogFormatError, match="no range of a dataflash log"):
            fleet.decode(path, (61, 200))

    def test_one_of_a_compressed_log_is_refused(self, tmp_path: Path) -> None:
        path = tmp_path / "flight.tlog.gz"
        path.write_bytes(gzip.compress(record(heartbeat(1)) * 1000))
        with pytest.raises(LogFormatError, match="no range of a compressed log"):
            fleet.decode(path, (20, 60))
        assert "HEARTBEAT" in fleet.decode(path, (0, path.stat().st_size))

    def test_one_of_an_object_store_is_refused(self) -> None:
        fsspec = pytest.importorskip("fsspec")
        url = "memory://headerless/flight.BIN"
        with fsspec.open(url, "wb") as file:
            file.write(flight(60).data)
        with pytest.raises(LogFormatError, match="no range of a dataflash log"):
            fleet.decode(url, (5000, 9000))
        assert fleet.decode(url, (0, 20_000), "ATT")

    def test_one_of_telemetry_may_hold_nothing(self, tmp_path: Path) -> None:
        path = tmp_path / "flight.tlog"
        path.write_bytes(record(heartbeat(1)) * 1000)
        assert fleet.decode(path, (3, 9)) == {}
