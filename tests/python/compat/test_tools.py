"""The tools print what pymavlink's scripts print and write the same files, on generated logs."""

from __future__ import annotations

import struct
from pathlib import Path
from random import Random

import dataflash_writer
import pytest
import tool_runs
from mavwire.dialects.v20 import ardupilotmega as mavlink
from mavwire.mavftp_op import (
    FTP_OP,
    OP_Ack,
    OP_BurstReadFile,
    OP_OpenFileRO,
    OP_TerminateSession,
)
from tool_runs import (
    Log,
    attitude,
    compare,
    damaged_log,
    flight_log,
    gps,
    heartbeat,
    in_folder,
    program,
    random_log,
    run,
)

Y2009 = 1_230_768_000
SENSORS = "SYS_STATUS.onboard_control_sensors_health"
# Subcommand -> script, and the options that it is run with.
CASES = {
    "parms": ("mavparms", ["", "--changes", "--qgc", "-c --qgc"]),
    "flightmodes": ("mavflightmodes", [""]),
    "flighttime": ("mavflighttime", ["", "--groundspeed 0.5", "--condition HEARTBEAT.type==2"]),
    "loss": ("mavloss", ["", "--stats", "--sysid 1 --stats", "--sysid 1 --compid 1",
                         "--sysid 99", "--condition HEARTBEAT.type==2", "--dialect common"]),
    "summarize": ("mavsummarize", ["", "--condition GPS_RAW_INT.fix_type==3"]),
    "mission": ("mavmission", ["", "--output other.txt"]),
    "togpx": ("mavtogpx", ["", "--nofixcheck", "--condition HEARTBEAT.custom_mode==5",
                           "LOG --type GPS_RAW_INT"]),
    "search": ("mavsearch", ["", "--types HEARTBEAT", "--types ATTITUDE,HEARTBEAT --stop",
                             "--condition HEARTBEAT.custom_mode==5",
                             "--condition HEARTBEAT.custom_mode==0 --types ATTITUDE",
                             "--condition HEARTBEAT.custom_mode==5 --stopcondition",
                             "--types NO_SUCH_TYPE"]),
    "extract": ("mavextract", ["", "--mode guided", "--mode STABILIZE", "--mode loiter --link 1",
                               "--mode stabilize --link 2", "--mode no_such_mode",
                               "--mode loiter,stabilize", "--mode ,guided",
                               "--mode loiter --condition HEARTBEAT.base_mode!=89"]),
    "tomfile": ("mavtomfile", ["", "--types ATTITUDE,STATUSTEXT",
                               "--condition HEARTBEAT.custom_mode==0"]),
    "gpslock": ("mavgpslock", [""]),
    "sigloss": ("mavsigloss", ["--deltat 0.9", "--types HEARTBEAT --deltat 2"]),
    "bitmask_change": ("mavbitmask_change", [f"LOG {SENSORS}", f"LOG HEARTBEAT.base_mode {SENSORS}",
                                             "LOG HEARTBEAT.type EKF_STATUS_REPORT.flags"]),
    "sensor_status_change": ("mavsensor_status_change", [""]),
    "gps_CEP": ("mavgps_CEP", [""]),
    "split_sysid": ("mavsplit_sysid", ["", "--types ATTITUDE,STATUSTEXT"]),
}  # fmt: skip


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("logs")
    return {
        "flight": flight_log(folder / "flight.tlog"),
        "random": random_log(folder / "random.tlog", 1),
        "other": random_log(folder / "other.tlog", 2),
        "damaged": damaged_log(folder / "damaged.tlog"),
    }


# mavtomfile.py fails on messages of unknown types.
DAMAGED = [verb for verb in CASES if verb not in ("tomfile", "bitmask_change", "mission")]


@pytest.mark.parametrize(
    ("verb", "options"), [(verb, one) for verb, (_, all_) in CASES.items() for one in all_]
)
def test_options(
    verb: str, options: str, logs: dict[str, Path], tmp_path: Path, oracle: str
) -> None:
    compare(CASES[verb][0], verb, options, tmp_path, logs["random"])


@pytest.mark.parametrize("verb", CASES)
def test_a_flight(verb: str, logs: dict[str, Path], tmp_path: Path, oracle: str) -> None:
    options = CASES[verb][1][-1 if verb in ("bitmask_change", "extract") else 0]
    compare(CASES[verb][0], verb, options, tmp_path, logs["flight"])


@pytest.mark.parametrize("verb", DAMAGED)
def test_a_damaged_log(verb: str, logs: dict[str, Path], tmp_path: Path, oracle: str) -> None:
    options = "--stats" if verb == "loss" else ""
    compare(CASES[verb][0], verb, options, tmp_path, logs["damaged"])


@pytest.mark.parametrize(
    ("verb", "options"),
    [
        ("parms", ""),
        ("parms", "--changes"),
        ("flightmodes", ""),
        ("flighttime", ""),
        ("loss", "--stats"),
        ("summarize", ""),
        ("mission", ""),
        ("togpx", ""),
        ("search", "--types HEARTBEAT --stop"),
        ("gpslock", ""),
        ("gps_CEP", ""),
        ("split_sysid", ""),
    ],
)
def test_several_logs(
    verb: str, options: str, logs: dict[str, Path], tmp_path: Path, oracle: str
) -> None:
    lines = compare(
        CASES[verb][0], verb, options, tmp_path, logs["flight"], logs["other"], logs["random"]
    )
    assert len(lines) > 2


@pytest.mark.parametrize(
    "arguments",
    [
        "HEARTBEAT base_mode 81",
        f"{SENSORS.replace('.', ' ')} 12345",
        "heartbeat base_mode 1000",
        "EKF_STATUS_REPORT flags 0",
        "HEARTBEAT base_mode -- -1",
    ],
)
def test_bits(arguments: str, tmp_path: Path, oracle: str) -> None:
    compare("mavlink_bitmask_decoder", "bitmask_decoder", arguments, tmp_path)


@pytest.mark.parametrize(
    ("script", "verb", "options"),
    [
        ("mavlogdump", "dump", ""),
        ("mavlogdump", "dump", "--show-types"),
        ("mavlogdump", "dump", "--quiet"),
        ("mavlogdump", "dump", "--nottypes X --condition 'CSV.A>2'"),
        ("mavsearch", "search", "--condition 'CSV.A>2'"),
        ("mavsigloss", "sigloss", ""),
        ("mavparms", "parms", ""),
    ],
)
def test_csv_logs(script: str, verb: str, options: str, tmp_path: Path, oracle: str) -> None:
    path = tmp_path / "table.csv"
    path.write_text("T;A;B\n1000;1.5;foo\n2000;2.5;bar\n")
    compare(script, verb, f"{options} csv:LOG", tmp_path, path)


@pytest.mark.parametrize("options", ["", "-t", "--full-diff", "-t --hide-only1 --hide-only2"])
def test_parameter_files(options: str, tmp_path: Path, oracle: str) -> None:
    one, other = tmp_path / "one.parm", tmp_path / "other.parm"
    one.write_text("A 1\nB 2.5\nC 3\nMIS_TOTAL 5\nA_NAME_THAT_IS_LONG 3\nSAME 1\n")
    other.write_text("A 1.0\nB 2.6\nD,4\nMIS_TOTAL 6\nE=7\nF 0x10\n# c\nG 1 # x\nSAME\t1\n")
    lines = compare("mavparmdiff", "parmdiff", options, tmp_path, one, other)
    assert len(lines) > 5


def test_parameter_files_with_what_values_mean(tmp_path: Path, oracle: str) -> None:
    """pymavlink's script has the definitions read by MAVProxy."""
    pytest.importorskip("MAVProxy.modules.lib.param_help")
    one, other = tmp_path / "one.parm", tmp_path / "other.parm"
    docs = tmp_path / "docs.xml"
    docs.write_text(PARAMETER_DOCS)
    names = "VALUE MASK NEW BOTH RANGE LIB VALUE_2 NONE".split()
    for number, (first, second) in enumerate([(1, 2), (-1, 99), (2.5, 3), (0, 6), (1.7, -5)]):
        one.write_text("".join(f"{name} {first}\n" for name in names) + "ONE 1\n")
        other.write_text("".join(f"{name} {second}\n" for name in names) + "MASK_2 1\n")
        folder = tmp_path / str(number)
        folder.mkdir()
        options = "--param-docs --param-xml"
        compare("mavparmdiff", "parmdiff", options, folder, docs, one, other)


PARAMETER_DOCS = """<?xml version="1.0" encoding="utf-8"?>
<paramfile><vehicles><parameters name="ArduCopter">
  <param humanName="A" name="ArduCopter:VALUE" documentation="a"><values>
    <value code="1">One</value><value code="-1">Less</value><value code="2.5"> x </value></values></param>
  <param humanName="A" name="ArduCopter:VALUE_2" documentation="a"><values>
    <value code="1">One</value><value code="-5">Five less</value></values></param>
  <param humanName="M" name="ArduCopter:MASK" documentation="a">
    <field name="Bitmask">0:All,1:Barometer, 5 : Spaced </field></param>
  <param humanName="M" name="ArduCopter:MASK_2" documentation="a"><field name="Bitmask">0:All</field></param>
  <param humanName="N" name="ArduCopter:NEW" documentation="a">
    <bitmask><bit code="0">Zero</bit><bit code="3">Three</bit></bitmask></param>
  <param humanName="B" name="ArduCopter:BOTH" documentation="a"><values><value code="1">One</value></values>
    <field name="Bitmask">0:All,1:Two</field></param>
  <param humanName="R" name="ArduCopter:RANGE" documentation="a"><field name="Range">0 1</field></param>
</parameters></vehicles><libraries><parameters name="L_">
  <param humanName="L" name="LIB" documentation="a"><values><value code="1">of a library</value></values></param>
  <param humanName="V" name="VALUE" documentation="a"><values><value code="2">Two</value></values></param>
</parameters></libraries></paramfile>"""


def test_parameters_that_are_not_at_their_defaults(tmp_path: Path, oracle: str) -> None:
    defaults, flown = tmp_path / "defaults.parm", tmp_path / "flown.parm"
    defaults.write_text("A 1\nB 2\nC 3\nMIS_TOTAL 5\nA_NAME_THAT_IS_LONG 3\nSAME 1\nD 0\nE 0\n")
    flown.write_text("B 1e15\nA 0.1\nC 1e17\nMIS_TOTAL 6\nA_NAME_THAT_IS_LONG 3.25\nSAME 1.0\n"
                     "D -2\nE 123456789.123456789\nONLY_HERE 1\n")  # fmt: skip
    lines = compare("extract_parms", "extract_parms", "", tmp_path, defaults, flown)
    assert len(lines) > 6


def test_positions_of_receivers(tmp_path: Path, oracle: str) -> None:
    random = Random(7)
    paths = []
    for fix in (3, 6):
        log = Log(tmp_path / f"fix{fix}.tlog")
        for number in range(120):
            lat, lon = 10 + random.gauss(0, 1e-5), 20 + random.gauss(0, 1e-5)
            log.add(number, gps(number, lat, 0.0, fix, lon))
            log.add(number, gps(number, lat + 1, 0.0, 3, lon), source=(9, 1))
            other = mavlink.MAVLink_gps2_raw_message(
                0, 3, int(lat * 1e7), int(lon * 1e7), number * 10, 9, 9, 0, 0, 9, 0, 0
            )
            log.add(number, other)
        paths.append(log.done())
    assert len(compare("mavgps_CEP", "gps_CEP", "", tmp_path, *paths)) == 7
    flight = dataflash_writer.Log()
    flight.define("PARM", "QNf", "TimeUS,Name,Value")
    flight.define("GPS", "QBBIHLLf", "TimeUS,I,Status,GMS,GWk,Lat,Lng,Alt")
    flight.add("PARM", 0, "SYSID_THISMAV", 7.0)
    for number in range(660):
        place = 100_000_000 + random.randrange(500), 200_000_000 + random.randrange(500)
        time = number * 1000, number % 2, 1 + number % 6, number, 2200
        flight.add("GPS", *time, *place, random.random())
    (tmp_path / "dataflash").mkdir()
    path = Path(flight.write(tmp_path / "still.bin"))
    assert len(compare("mavgps_CEP", "gps_CEP", "", tmp_path / "dataflash", path)) == 5


def fast_samples(path: Path) -> Path:
    """Batches of two accelerometers and two gyroscopes, one batch without its first part."""
    log = dataflash_writer.Log()
    log.define("ATT", "Qf", "TimeUS,Roll")
    log.define("ISBH", "QHBBHHQf", "TimeUS,N,type,instance,mul,smp_cnt,SampleUS,smp_rate")
    log.define("ISBD", "QHHaaa", "TimeUS,N,seqno,x,y,z")
    for number in range(8):
        kind, instance = number % 2, number // 4
        log.add("ATT", number, 2.0)
        log.add("ISBH", number, number, kind, instance, 16 + number, 64, number * 70_000, 1234.5)
        for part in range(number == 3, 2):
            rows = [
                struct.pack("<32h", *(axis * (32 * part + one) for one in range(32)))
                for axis in (1, -2, 500)
            ]
            log.add("ISBD", number, number, part, *rows)
    return Path(log.write(path))


def test_fast_samples_as_a_log(tmp_path: Path, oracle: str) -> None:
    path = fast_samples(tmp_path / "fast.bin")
    compare("extract_batch_imu", "extract_batch_imu", "LOG out.bin", tmp_path, path)
    assert (tmp_path / "ours" / "out.bin").stat().st_size > 10_000


def test_fast_samples_as_tables(tmp_path: Path, oracle: str) -> None:
    """isb_extract.py tells its speed, and leaves out the last batch."""
    path = fast_samples(tmp_path / "fast.bin")
    folders = [in_folder(tmp_path / name, (path,)) for name in ("theirs", "ours")]
    theirs, _ = run([*program("isb_extract"), path.name], folders[0])
    ours, _ = run(["-m", "mavwire", "isb_extract", path.name], folders[1])
    assert ours == [line for line in theirs if "messages/second" not in line]
    assert "ISBH(3) has holes in it" in ours
    for name in ("Accel0.csv", "Accel1.csv", "Gyro0.csv", "Gyro1.csv"):
        ours_text, theirs_text = ((folder / name).read_text() for folder in reversed(folders))
        assert ours_text.startswith(theirs_text), name
        assert (ours_text == theirs_text) == (name != "Gyro1.csv"), name


def test_files_sent_by_ftp(tmp_path: Path, oracle: str) -> None:
    """Of other files than parameters the script tells the last one alone. The first request is to
    all systems, as that of a station that knows none yet.
    """
    log = Log(tmp_path / "ftp.tlog")
    name = b"@PARAM/param.pck"
    values = b"\x04\x00RC1_" + struct.pack("<f", 1.5) + b"\x02\x14MIN" + struct.pack("<h", -7)
    content = struct.pack("<HHH", 0x671B, 2, 2) + b"\x04\x30RC1_" + values[6:10]
    content += b"\x02\x34TRIM"[:2] + b"TRIM" + struct.pack("<h", -7)

    def send(seconds: float, answer: bool, packet: FTP_OP, system: int = 1) -> None:
        payload = bytes(packet.pack()).ljust(251, b"\0")
        source, target = ((1, 1), 255) if answer else ((255, 190), system)
        msg = mavlink.MAVLink_file_transfer_protocol_message(0, target, 1, payload)
        log.add(seconds, msg, source)

    size = struct.pack("<I", len(content))
    for start, system, session in ((0, 0, 1), (5, 1, 2)):
        opening = FTP_OP(1, session, OP_OpenFileRO, len(name), 0, 0, 0, name)
        send(start, False, opening, system)
        send(start + 1, True, FTP_OP(2, session, OP_Ack, 4, OP_OpenFileRO, 0, 0, size))
        send(start + 2, False, FTP_OP(3, session, OP_BurstReadFile, 80, 0, 0, 0, None))
        burst = FTP_OP(4, session, OP_Ack, len(content), OP_BurstReadFile, 1, 0, content)
        send(start + 3, True, burst)
        send(start + 4, False, FTP_OP(5, session, OP_TerminateSession, 0, 0, 0, 0, None))
    lines = compare("mavftpdecode", "ftpdecode", "", tmp_path, log.done())
    assert lines == [*["# @PARAM/param.pck", "RC1_ 1.5", "RC1_TRIM -7"] * 2, ""]


def test_sizes_where_no_zeros_are_cut_off(tmp_path: Path, oracle: str) -> None:
    """mavmsgstats.py takes all messages of a type to be as long as the first one, so that only
    MAVLink 1 is counted alike.
    """
    log = Log(tmp_path / "version_1.tlog")
    for number in range(30):
        log.add(number, attitude(number), version_1=True)
        if number % 3 == 0:
            log.add(number + 0.2, heartbeat(), version_1=True)
    compare("mavmsgstats", "msgstats", "", tmp_path, log.done())


def test_types_of_a_dataflash_log_that_are_as_large(tmp_path: Path, oracle: str) -> None:
    """They are in the order of their descriptions."""
    log = dataflash_writer.Log()
    names = ("BAT", "ATT", "XKF1", "CTUN")
    for name in names:
        log.define(name, "Qf", "TimeUS,X")
    for number, name in enumerate(reversed(names)):
        log.add(name, number, 1.0)
    lines = compare("mavmsgstats", "msgstats", "", tmp_path, Path(log.write(tmp_path / "a.bin")))
    assert [line.split()[0] for line in lines[2:6]] == list(names)


def test_a_log_with_positions_at_zero(tmp_path: Path, oracle: str) -> None:
    log = Log(tmp_path / "zero.tlog")
    for number, (lat, lon, fix) in enumerate(
        [(0, 2, 3), (0, 3, 3), (1, 0, 3), (3, 3, 3), (3, 4, 2), (3, 5, 4), (3, 6, 6), (3, 6, 1)]
    ):
        log.add(number, gps(number, lat, 5.0, fix, lon))
    path = log.done()
    for verb in ("flighttime", "summarize", "togpx", "gpslock"):
        (tmp_path / verb).mkdir()
        compare(CASES[verb][0], verb, "", tmp_path / verb, path)


@pytest.mark.parametrize("options", ["", "--nofixcheck"])
def test_positions_that_do_not_tell_a_speed(options: str, tmp_path: Path, oracle: str) -> None:
    log = dataflash_writer.Log().define("POS", "QLLf", "TimeUS,Lat,Lng,Alt")
    for name in ("GPS", "GPS2"):
        log.define(name, "QBIHLLfff", "TimeUS,Status,GMS,GWk,Lat,Lng,Alt,Spd,GCrs")
    places = [("GPS", 3, 9), ("GPS2", 3, 9), ("GPS", 1, 9), ("GPS", 3, 0), ("GPS", 4, 9)]
    for number, (name, status, lat) in enumerate(places, 1):
        place = lat * 10_000_000, 200_000_000, 58.0
        log.add(name, number * 1000, status, number, 2280, *place, number * 1.5, number * 10.0)
        log.add("POS", number * 1000 + 500, 90_000_000, 200_000_000, 59.0)
    path = Path(log.write(tmp_path / "flight.bin"))
    compare("mavtogpx", "togpx", options, tmp_path, path)


@pytest.mark.parametrize(
    "times",
    [(0, 5, 9), (5, 0), (Y2009 - 2, Y2009 - 1), (0, Y2009 - 1, Y2009, Y2009 + 5), (Y2009 + 9, 0)],
)
@pytest.mark.parametrize("since", [0, 20 * 60, 21 * 60, Y2009 - 1, Y2009 + 99])
def test_times_that_are_of_no_clock(
    times: tuple[int, ...],
    since: int,
    tmp_path: Path,
    oracle: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of the log's, and of GPS's."""
    monkeypatch.setattr(tool_runs, "START", 0)
    log = Log(tmp_path / "started.tlog")
    for seconds in times:
        log.add(seconds, heartbeat())
        log.add(seconds, gps(since, 10.0, 5.0))
    compare("mavsummarize", "summarize", "", tmp_path, log.done())


def test_a_log_without_what_is_looked_for(tmp_path: Path, oracle: str) -> None:
    log = Log(tmp_path / "nothing.tlog")
    log.add(0, attitude(0))
    path = log.done()
    for verb in ("parms", "flightmodes", "flighttime", "summarize", "mission", "togpx", "loss"):
        (tmp_path / verb).mkdir()
        compare(CASES[verb][0], verb, "", tmp_path / verb, path)


@pytest.mark.parametrize("options", ["", "-s GPS --aoff 10.5 -e", "-o other.kml"])
def test_ways_as_kml(options: str, tmp_path: Path, oracle: str) -> None:
    pytest.importorskip("simplekml", reason="mavkml.py needs simplekml")
    log = dataflash_writer.Log()
    log.define("GPOS", "QLLf", "TimeUS,Lat,Lon,Alt")
    log.define("GPS", "QBIHLLf", "TimeUS,Status,GMS,GWk,Lat,Lon,Alt")
    log.define("STAT", "QB", "TimeUS,MainState")
    for number in range(60):
        if number % 12 == 11:
            log.add("STAT", number * 100_000, number // 12 * 3 % 10)
        place = 100_000_000 + number, -200_000_000 + number * number
        log.add("GPOS", number * 100_000, *place, 1.5 * number)
        log.add("GPS", number * 100_000, 3, number * 100, 2200, *place, 2.5 * number)
    compare("mavkml", "kml", options, tmp_path, Path(log.write(tmp_path / "way.bin")))


def test_a_log_without_a_way_as_kml(tmp_path: Path, oracle: str) -> None:
    pytest.importorskip("simplekml", reason="mavkml.py needs simplekml")
    log = Log(tmp_path / "flight.tlog")
    log.add(0, attitude(0))
    compare("mavkml", "kml", "", tmp_path, log.done())
