"""What stands in front of a log, or damaged its first bytes, hides neither what kind of log it is nor a record."""

from __future__ import annotations

from pathlib import Path
from random import Random

import mavwire
import pytest
from dataflash_writer import sample
from mavwire import cli, fleet, mavutil
from mavwire.DFReader import DFReader_binary, DFReader_text
from mavwire.dialects.v20 import all as mavlink
from unit.link_tools import T0, drain, heartbeat, pack, record

COUNT = 200
FRONTS = {
    "a byte": b"\xff",
    "mark": b"\xef\xbb\xbf",
    "zeros": bytes(64 << 10),
    "erased": b"\xff" * 200_000,
    "noise": Random(3).randbytes(1000).translate(None, b"\xfd\xfe\xa3F"),
    "marks": b"\xfd" * 100,
    "noise with marks": Random(4).randbytes(40_000).translate(None, b"\xa3F"),
}


def lines() -> bytes:
    fmt = "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n"
    fmt += "FMT, 130, 15, GAP, QI, TimeUS,Number\n"
    return fmt.encode() + b"".join(b"GAP, %d, %d\n" % (n * 1000, n) for n in range(COUNT))


LOGS = {
    "flight.tlog": b"".join(record(heartbeat(n % 256), T0 + n) for n in range(COUNT)),
    "flight.raw": b"".join(heartbeat(n % 256) for n in range(COUNT)),
    "flight.BIN": sample().data,
    "flight.log": b"\n" + lines(),
}


def counted(path: Path) -> set[int]:
    """How many messages all ways find."""
    with mavwire.open_log(path) as log:
        found = {sum(1 for _ in log.messages()), log.info().messages}
    found.add(sum(map(len, mavwire.read(path).values())))
    found.add(sum(map(len, mavwire.scan(path))))
    found.add(sum(map(len, fleet.decode(str(path)).values())))
    return found


@pytest.mark.parametrize("front", FRONTS)
@pytest.mark.parametrize("name", LOGS)
def test_what_stands_in_front_of_a_log(tmp_path, name, front):
    path = tmp_path / name
    path.write_bytes(LOGS[name])
    (expected,) = counted(path)
    path.write_bytes(FRONTS[front] + LOGS[name])
    if name == "flight.log" and "noise" in front:  # as much noise as a text begins with hides it
        path.write_bytes(FRONTS[front][:100] + LOGS[name])
    assert counted(path) == {expected}
    assert cli.main(["convert", str(path), "-o", str(tmp_path / "out"), "--quiet"]) == 0
    (row,) = mavwire.logs.conversion.convert([path], tmp_path / "out")
    assert row.rows == expected


@pytest.mark.parametrize("at", range(0, 100, 7))
def test_a_byte_of_a_text_log_that_is_no_text(tmp_path, at):
    path = tmp_path / "flight.log"
    text = lines()
    path.write_bytes(text[:at] + b"\xf0" + text[at:])
    assert isinstance(mavwire.open_log(path), mavwire.logs.DataflashLog)


@pytest.mark.parametrize("lost", [1, 126, 128, 600])
def test_zeros_behind_the_first_description_of_a_text_log(tmp_path, lost):
    path = tmp_path / "flight.log"
    text = lines()
    end = text.index(b"GAP, 0,") + lost
    path.write_bytes(text[: end - lost] + bytes(lost) + text[end:])
    touched = text[:end].count(b"\n") - 2 + (not text[:end].endswith(b"\n"))
    assert counted(path) == {2 + COUNT - touched}


def test_readers_of_pymavlink_find_the_same(tmp_path):
    for name, reader in (("flight.BIN", DFReader_binary), ("flight.log", DFReader_text)):
        path = tmp_path / name
        path.write_bytes(FRONTS["a byte"] + LOGS[name])
        with reader(str(path)) as log:
            found = 0
            while log.recv_msg() is not None:
                found += 1
        assert {found} == counted(path), name


def test_a_type_of_a_text_log_may_have_a_long_name(tmp_path):
    path = tmp_path / "flight.log"
    path.write_bytes(lines().replace(b"GAP", b"LONGNAME"))
    with mavwire.open_log(path) as log:
        expected = log["LONGNAME"]["Number"].tolist()
    assert mavwire.read(path, "LONGNAME")["LONGNAME"]["Number"].tolist() == expected
    (batch,) = mavwire.scan(path, "LONGNAME")
    assert batch["Number"].tolist() == expected


def damaged(frames: list[bytes], seed: int) -> bytes:
    """Every frame by itself: the one behind it has lost its checksum."""
    random = Random(seed)
    return b"".join(
        frame if n % 2 else frame[:-2] + random.randbytes(2) for n, frame in enumerate(frames)
    )


@pytest.mark.parametrize("vehicle", [2, 6, 13])
@pytest.mark.parametrize("seed", range(20))
def test_frames_of_which_none_follows_another(tmp_path, seed, vehicle):
    """The end of a HEARTBEAT of some vehicles looks like a date."""
    path = tmp_path / "flight"
    message = mavlink.MAVLink_heartbeat_message(vehicle, 3, 81, 4, 4, 3)
    frames = [pack(message, seq) for seq in range(40)]
    path.write_bytes(damaged(frames, seed))
    assert not mavwire.open_log(path).info().stamped
    path.write_bytes(damaged([record(one, T0 + n) for n, one in enumerate(frames)], seed))
    assert mavwire.open_log(path).info().stamped


# -- times


def times(path: Path) -> list[int]:
    """The times of all records but the first, the same by all ways."""
    table = mavwire.read(path)["HEARTBEAT"].to_numpy()["timestamp"].astype("int64").tolist()
    with mavwire.open_log(path) as log:
        assert [round(msg._timestamp * 1e6) for msg in log][1:] == table[1:]
    with mavutil.mavlink_connection(str(path), resync="rescan") as link:
        found = [msg._timestamp for msg in drain(link) if msg.get_type() == "HEARTBEAT"]
    assert [round(time * 1e6) for time in found][1:] == table[1:]
    return table[1:]


@pytest.mark.parametrize("bit", [*range(64)])
def test_one_damaged_time_is_nobody_elses(tmp_path, bit):
    """Every second frame is damaged, so that no record follows a good one; the first time is wrong."""
    path = tmp_path / "flight.tlog"
    records = [bytearray(record(heartbeat(n), T0 + n * 1_000_000)) for n in range(40)]
    for broken in records[1::2]:
        broken[12] ^= 1
    records[0][bit // 8] ^= 0x80 >> bit % 8
    path.write_bytes(b"".join(records))
    expected = [T0 + n * 1_000_000 for n in range(2, 40, 2)]
    found = times(path)
    assert found[1:] == expected[1:], "two records speak against a wrong date"
    is_date = 946684800 <= int.from_bytes(records[0][:8], "big") * 1e-6 < 4102444800
    assert is_date or found == expected
