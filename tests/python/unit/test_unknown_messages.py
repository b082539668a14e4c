"""Messages that the dialect does not define are counted and named; earlier layouts of an id are messages."""

from __future__ import annotations

import json
import pickle
import re
import warnings
from pathlib import Path

import mavwire
import pyarrow.parquet as pq
import pytest
from mavwire import cli, dialects
from mavwire.dialects.v20 import all as mavlink
from mavwire.dialects.v20 import common, upstream
from mavwire.logs import UnknownMessageWarning
from mavwire.logs.conversion import convert
from mavwire.logs.manifest import MANIFEST
from mavwire.logs.unknown import NO_TABLE, counts_of, kinds_of, unknown_text

T0 = 1_700_000_000_000_000
KINDS = [{"id": 180, "crc_extra": 5, "messages": 17}]
OTHER = (
    "17 messages of id 180 have another definition (CRC_EXTRA 5) than CAMERA_FEEDBACK of upstream: "
    "name the XML file of that one too: "
)


def frame(msgid: int, crc_extra: int, payload: bytes, seq: int, system: int = 1) -> bytes:
    """A frame of version 1."""
    body = bytes([len(payload), seq, system, 1, msgid]) + payload
    return b"\xfe" + body + mavlink.x25crc(body + bytes([crc_extra])).crc.to_bytes(2, "little")


def write(path: Path, *frames: bytes) -> Path:
    path.write_bytes(b"".join((T0 + at).to_bytes(8, "big") + one for at, one in enumerate(frames)))
    return path


@pytest.fixture
def vendor(tmp_path: Path) -> Path:
    """Heartbeats, each with a message of id 180 as a vendor defined it."""
    mav = mavlink.MAVLink(None, srcSystem=1)
    heartbeat = mavlink.MAVLink_heartbeat_message(2, 3, 0, 0, 4, 3)
    frames = [
        one
        for seq in range(20)
        for one in (heartbeat.pack(mav), frame(180, 5, bytes([seq, 0, 60]), seq))
    ]
    return write(tmp_path / "vendor.tlog", *frames)


def test_convert_counts_them(
    vendor: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert cli.main(["convert", str(vendor), "-o", str(out)]) == 0
    told = capsys.readouterr().err
    assert f"left out: {OTHER}`--dialect FILE.xml --dialect upstream`\n" in told
    (row,) = json.loads((out / MANIFEST).read_text())["logs"]
    assert row["unknown"] == KINDS


def test_types_that_are_chosen_leave_nothing_out(vendor: Path, tmp_path: Path) -> None:
    (row,) = convert([vendor], tmp_path / "out", types=["HEARTBEAT"])
    assert row.unknown == []
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert len(mavwire.read(vendor, "HEARTBEAT")["HEARTBEAT"]) == 20


def test_other_systems_and_times_leave_nothing_out(tmp_path: Path) -> None:
    path = write(
        tmp_path / "two.tlog",
        *(frame(180, 5, bytes([n, 0, 60]), n, system=1 + n % 2) for n in range(40)),
    )
    with pytest.warns(UnknownMessageWarning, match="17 messages of id 180 have another definition"):
        mavwire.read(path, systems=[1])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        mavwire.read(path, systems=[3])
        mavwire.read(path, start=(T0 + 40) * 1e-6)


def test_info_merges_the_kinds_of_an_id(tmp_path: Path) -> None:
    frames = [frame(180, 5 + n % 2, bytes([n, 0, 60]), n, system=1 + n % 2) for n in range(40)]
    info = mavwire.open_log(write(tmp_path / "two.tlog", *frames)).info()
    assert info.unknown == {(180, 5): 17, (180, 6): 17}
    count = info.types["UNKNOWN_180"]
    assert count.messages == 34
    assert (count.first, count.last) == ((T0 + 6) * 1e-6, (T0 + 39) * 1e-6)
    assert count.seconds == pytest.approx(33e-6)


def test_read_and_scan_warn(vendor: Path) -> None:
    with pytest.warns(
        UnknownMessageWarning, match=re.escape(OTHER + '`dialect=["FILE.xml", "upstream"]`')
    ):
        assert mavwire.read(vendor).keys() == {"HEARTBEAT"}
    with pytest.warns(UnknownMessageWarning, match="vendor.tlog"):
        assert [table.name for table in mavwire.scan(vendor)] == ["HEARTBEAT"]


def test_info_says_which(vendor: Path, capsys: pytest.CaptureFixture[str]) -> None:
    info = mavwire.open_log(vendor).info()
    assert info.unknown == {(180, 5): 17}
    assert info.types["UNKNOWN_180"].messages == 17
    assert cli.main(["info", str(vendor)]) == 0
    assert f"{OTHER}`--dialect FILE.xml --dialect upstream`\n" in capsys.readouterr().out
    cli.main(["info", "--json", str(vendor)])
    assert json.loads(capsys.readouterr().out)["unknown"] == KINDS


def test_messages_and_counts_are_the_same(vendor: Path) -> None:
    log = mavwire.open_log(vendor)
    unknown = [msg.get_type() for msg in log.messages("UNKNOWN")]
    assert unknown == ["UNKNOWN_180"] * 17
    assert len(list(log)) == log.info().count.messages == 37


def test_a_text_names_the_most_frequent_kinds() -> None:
    counts = {(1_000_000 + one, 7): 10 - one for one in range(10)}
    text = unknown_text(counts, upstream)
    assert text.startswith("10 messages of id 1000000, 9 messages of id 1000001, ")
    assert text.endswith(
        ", 3 messages of other kinds are not in the dialect upstream:"
        " name a dialect or an XML file that has it"
    )
    counts = {(5, 6): 1, None: 3}
    assert [kind["messages"] for kind in kinds_of(counts)] == [3, 1]
    assert counts_of(kinds_of(counts)) == counts


def test_a_text_advises_by_kind(tmp_path: Path) -> None:
    dialect = tmp_path / "vendor.xml"
    dialect.write_text(VENDOR)
    vendor = dialects.load(dialect)
    both = dialects.merged([vendor, upstream])
    event = "4,000 messages of id 410 are not in the dialect"
    try_upstream = "try `--dialect upstream`"
    for counts, module, text in [
        ({(410, 160): 4000}, common, f"{event} common: {try_upstream}"),
        ({(410, None): 4000}, common, f"{event} common: {try_upstream}"),
        (
            {(410, 160): 4000},
            vendor,
            f"{event} vendor: try `--dialect vendor.xml --dialect upstream`",
        ),
        ({(410, 3): 4000}, common, f"{event} common: name a dialect or an XML file that has it"),
        (
            {(149, 15): 1},
            common,
            "1 message of id 149 have another definition (CRC_EXTRA 15) than LANDING_TARGET of common: "
            + try_upstream,
        ),
        (
            {(0, 1): 1},
            both,
            "1 message of id 0 have another definition (CRC_EXTRA 1) than HEARTBEAT of vendor+upstream: "
            "name the XML file of that one too: `--dialect FILE.xml --dialect vendor.xml --dialect upstream`",
        ),
    ]:
        assert unknown_text(counts, module) == text
    kinds: dict[tuple[int, int | None] | None, int] = {(410, 160): 4000}
    assert unknown_text(kinds, common, "argument").endswith('try `dialect="upstream"`')
    assert "id 180 have another" in unknown_text({(180, 5): 2, **kinds}, mavlink)


def test_an_earlier_layout_is_a_message(tmp_path: Path) -> None:
    """Id 149 was SETPOINT_6DOF until 2014, with CRC_EXTRA 15. It is LANDING_TARGET now. The second frame proves it."""
    names = {name for name, msgid in upstream.MAVLink(None)._dialect.messages() if msgid == 149}
    assert names == {"LANDING_TARGET"}
    payload = bytes(range(25))
    path = write(tmp_path / "old.tlog", *(frame(149, 15, payload, seq) for seq in range(5)))
    ((name, table),) = mavwire.read(path).items()
    assert (name, len(table)) == ("SETPOINT_6DOF", 4)
    assert table["target_system"].tolist() == [24] * 4
    messages = list(mavwire.open_log(path))
    assert [msg.get_type() for msg in messages] == ["SETPOINT_6DOF"] * 4
    assert messages[0].target_system == 24


def test_a_layout_whose_name_is_taken_has_another_name(tmp_path: Path) -> None:
    path = write(tmp_path / "old.tlog", *(frame(36, 242, bytes(21), seq) for seq in range(3)))
    assert [*mavwire.read(path)] == ["SERVO_OUTPUT_RAW_CRC242"]


VENDOR = """<mavlink><messages><message id="180" name="VENDOR_STATE">
<field type="uint8_t" name="number"/><field type="uint8_t" name="mode"/><field type="uint8_t" name="level"/>
</message></messages></mavlink>"""


def test_a_table_of_unknown_messages_has_their_payloads(vendor: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        tables = mavwire.read(vendor, unknown="table")
        assert mavwire.read(vendor, unknown="ignore").keys() == {"HEARTBEAT"}
        only = mavwire.read(vendor, "HEARTBEAT", systems=1, unknown="table")
    assert only.keys() == tables.keys() == {"HEARTBEAT", "mavwire.unknown"}
    table = tables["mavwire.unknown"].to_arrow()
    assert table.column_names == [
        "timestamp", "sysid", "compid", "seq", "version", "msgid", "crc_extra", "payload"
    ]  # fmt: skip
    assert table["payload"].to_pylist() == [bytes([seq, 0, 60]) for seq in range(3, 20)]
    assert table["version"].to_pylist() == [1] * 17
    first = table["timestamp"][0].value
    assert first == T0 + 7
    (batch,) = (one for one in mavwire.scan(vendor, unknown="table") if one.name != "HEARTBEAT")
    assert (batch.name, len(batch)) == ("mavwire.unknown", 17)
    with pytest.raises(ValueError, match="unknown must be None, 'table' or 'ignore', not 'all'"):
        mavwire.read(vendor, unknown="all")


@pytest.mark.parametrize("format", ["parquet", "arrow"])
def test_a_later_dialect_decodes_the_table(
    tmp_path: Path, format: str, capsys: pytest.CaptureFixture[str]
) -> None:
    dialect, out, later = tmp_path / "vendor.xml", tmp_path / "out", tmp_path / "later"
    dialect.write_text(VENDOR)
    module = dialects.load(dialect)
    mav = module.MAVLink(None, 7, 8)
    frames = [module.MAVLink_vendor_state_message(seq, 1, 60) for seq in range(20)]
    packed = [frame.pack(mav, force_mavlink1=seq % 2 == 0) for seq, frame in enumerate(frames)]
    log = write(tmp_path / "flight.tlog", *packed)
    arguments = ["convert", str(log), "-o", str(out), "--unknown", "table", "--format", format]
    assert cli.main(arguments) == 0
    assert capsys.readouterr().err == ""
    saved = out / "mavwire.unknown" / f"flight.{format}"
    again = ["convert", "--from-unknown", str(saved), "-o", str(later)]
    assert cli.main(again) == 0
    told = capsys.readouterr().err
    assert "messages of id 180 have another definition" in told and "no telemetry" not in told
    assert cli.main([*again, "--dialect", str(dialect)]) == 0
    (row,) = json.loads((later / MANIFEST).read_text())["logs"]
    assert row["files"] == {"VENDOR_STATE/flight.parquet": 17}
    table_path = later / "VENDOR_STATE" / "flight.parquet"
    table = pq.read_table(table_path).to_pylist()
    assert [row["number"] for row in table] == [*range(3, 20)]
    assert {(row["sysid"], row["compid"]) for row in table} == {(7, 8)}
    assert table[0]["timestamp"].microsecond == 3
    assert cli.main(["convert", "--from-unknown", str(log), "-o", str(later)]) == 1
    assert f"{log}: {NO_TABLE}\n" in capsys.readouterr().err
    assert cli.main(["convert", "--from-unknown", str(table_path), "-o", str(later)]) == 1
    assert f"{table_path}: {NO_TABLE}\n" in capsys.readouterr().err


def test_an_mcap_file_has_their_payloads(vendor: Path, tmp_path: Path) -> None:
    from unit.mcap_tools import messages

    convert([vendor], tmp_path / "out", format="mcap", unknown="table")
    found = messages(tmp_path / "out" / "vendor.mcap")
    (rows,) = (rows for topic, rows in found.items() if topic.endswith("mavwire.unknown"))
    rows = [content for *_, content in rows]
    assert [row["payload"] for row in rows] == [f"{seq:02x}003c" for seq in range(3, 20)]
    assert {(row["msgid"], row["crc_extra"]) for row in rows} == {(180, 5)}


def test_a_users_definitions_go_beside_upstream(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Id 180 is CAMERA_FEEDBACK upstream, and another message in the user's definitions."""
    dialect = tmp_path / "vendor.xml"
    dialect.write_text(VENDOR)
    mav, vendor = upstream.MAVLink(None, 1), dialects.load(dialect)
    frames = []
    for mav.seq in range(6):
        theirs = vendor.MAVLink_vendor_state_message(mav.seq, 1, 60)
        ours = upstream.MAVLink_camera_feedback_message(mav.seq, *range(12))
        frames.append((ours, theirs)[mav.seq % 2].pack(mav))
    log = write(tmp_path / "flight.tlog", *frames)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        tables = mavwire.read(log, dialect=("upstream", dialect))
    assert {name: len(table) for name, table in tables.items()} == {
        "VENDOR_STATE": 3, "CAMERA_FEEDBACK": 3
    }  # fmt: skip
    argv = ["convert", str(log), "-o", str(tmp_path / "out"), "--dialect", "upstream"]
    assert cli.main([*argv, "--dialect", str(dialect)]) == 0
    assert capsys.readouterr().err == ""
    assert (tmp_path / "out" / "VENDOR_STATE" / "flight.parquet").exists()
    copy = pickle.loads(pickle.dumps(mavwire.open_log(log, dialect=["upstream", dialect])))
    assert len(list(copy)) == copy.info().count.messages == 6


def test_commands_and_links_take_several_dialects(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    vendor = tmp_path / "vendor.xml"
    vendor.write_text(VENDOR.replace('id="180"', 'id="54321"'))
    theirs = dialects.load(vendor).MAVLink_vendor_state_message(7, 1, 60)
    mav = upstream.MAVLink(None, 1)
    log = write(
        tmp_path / "flight.tlog",
        theirs.pack(mav),
        upstream.MAVLink_event_message(*[1] * 6, [1] * 40).pack(mav),
    )
    options = ["--dialect", "upstream", "--dialect", str(vendor)]
    for command, *more in ("info",), ("dump", "--format", "json"):
        assert cli.main([command, *more, *options, str(log)]) == 0
        out = capsys.readouterr()
        assert "VENDOR_STATE" in out.out and "EVENT" in out.out and out.err == ""
    assert cli.main(["info", *options, "--dialect", "ardupilotmga", str(log)]) == 1
    assert "no dialect" in capsys.readouterr().err


def test_a_layout_is_chosen_by_its_own_name(tmp_path: Path) -> None:
    old = [frame(36, 242, bytes([1, seq] * 10 + [3]), seq) for seq in range(4)]
    mav = upstream.MAVLink(None, 1)
    new = [upstream.MAVLink_servo_output_raw_message(1, *[seq] * 9).pack(mav) for seq in range(3)]
    path = write(tmp_path / "both.tlog", *new, *old)
    name = "SERVO_OUTPUT_RAW"
    assert set(mavwire.read(path, name)) == {name, f"{name}_CRC242"}
    assert set(mavwire.read(path, f"{name}_CRC242")) == {f"{name}_CRC242"}
    log = mavwire.open_log(path)
    assert len(log[f"{name}_CRC242"]) == 3
    assert len(list(log.messages(f"{name}_CRC242"))) == 3
    assert f"{name}_CRC242" in log and f"{name}_CRC1" not in log


@pytest.fixture
def events(tmp_path: Path) -> Path:
    """A log of EVENT messages, which ardupilotmega does not define."""
    mav = upstream.MAVLink(None, 1)
    frames = [
        upstream.MAVLink_event_message(0, 0, n, n, n, 0, [0] * 40).pack(mav) for n in range(9)
    ]
    return write(tmp_path / "events.tlog", *frames)


@pytest.mark.parametrize(
    "options", [[], ["--verbose"], ["--format", "json"], ["--types", "UNKNOWN_*"]]
)
def test_dump_says_which_messages_are_not_defined(
    events: Path, options: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["dump", str(events), *options]) == 0
    assert capsys.readouterr().err == (
        "mavwire dump: 9 messages of id 410 are not in the dialect ardupilotmega: "
        f"try `--dialect upstream`: {str(events)!r}\n"
    )
    assert cli.main(["dump", str(events), *options, "--source-system", "7"]) == 0
    assert "UNKNOWN" not in capsys.readouterr().out
    assert cli.main(["dump", str(events), "--dialect", "upstream"]) == 0
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("suffix", ["tlog", "bin"])
def test_a_log_of_other_definitions_is_not_damaged(
    suffix: str, tmp_path: Path, events: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / f"other.{suffix}"
    frames = [frame(180, 5, bytes([seq, 0, 60]), seq) for seq in range(20)]
    if suffix == "tlog":
        write(path, *frames)
    else:
        path.write_bytes(b"".join(frames))
    for command in ("dump", "loss"):
        assert cli.main([command, str(path)]) == 0
        assert "messages of id 180 have another definition (CRC_EXTRA 5)" in capsys.readouterr().err
    assert cli.main(["info", str(path)]) == 0
    assert capsys.readouterr().err == ""
    assert cli.main(["parms", str(events)]) == 0
    assert "9 messages of id 410 are not in the dialect" in capsys.readouterr().err


def test_a_message_that_has_to_be_renamed_is_told(tmp_path: Path) -> None:
    dialect = tmp_path / "vendor.xml"
    dialect.write_text(
        VENDOR.replace('id="180" name="VENDOR_STATE"', 'id="54000" name="HEARTBEAT"')
    )
    vendor = dialects.load(dialect)
    text = (
        r"HEARTBEAT of id 0 is HEARTBEAT_CRC50 in the dialect vendor\+upstream: another id has that"
    )
    with pytest.warns(UserWarning, match=text):
        both = dialects.merged([vendor, upstream])
    assert both.mavlink_map[0].msgname == "HEARTBEAT_CRC50"
    with pytest.warns(UserWarning, match="HEARTBEAT of id 54000 is HEARTBEAT_CRC"):
        dialects.merged([upstream, vendor])
