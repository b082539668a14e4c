"""Maps show where the vehicle was and was to go; KML and GPX are what their readers expect."""

from __future__ import annotations

import gzip
import json
import os
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from dataflash_writer import Log
from lxml import etree
from mavwire import cli, plots, traffic
from mavwire.dialects.v20 import all as mavlink
from mavwire.plots import geo, maps
from mavwire.plots.modes import Span
from mavwire.plots.track import Place, Track, read_track
from unit.link_tools import T0, pack, record
from unit.test_plots import Page, numbers
from watchdog import watched

ROOT = Path(__file__).parents[3]
LOGS = Path(os.environ.get("MAVWIRE_LOGS", ROOT.parent / "shared" / "logs"))
KML = "{http://www.opengis.net/kml/2.2}"
GPX = "{http://www.topografix.com/GPX/1/1}"
HOME = [0, 0, 0, [0] * 4, 0, 0, 0]
HOSTILE = "]]><name>&\"'\x00\x1b\ud800\ufffe"


def write(path: Path, messages: list[tuple[object, int]]) -> Path:
    """A log of messages and their systems, a second apart."""
    path.write_bytes(
        b"".join(record(pack(m, n % 256, s), T0 + n * 10**6) for n, (m, s) in enumerate(messages))
    )
    return path


def position(lat: float, lon: float, alt: float = 100.0) -> object:
    degrees = int(lat * 1e7), int(lon * 1e7)
    return mavlink.MAVLink_global_position_int_message(
        0, *degrees, int(alt * 1e3), 0, 0, 0, 0, 0
    )  # fmt: skip


def beat(custom_mode: int = 0) -> object:
    return mavlink.MAVLink_heartbeat_message(2, 3, 81, custom_mode, 4, 3)


def item(seq: int, lat: float, lon: float, frame: int = 3, mission_type: int = 0) -> object:
    return mavlink.MAVLink_mission_item_int_message(
        1, 1, seq, frame, 16, 0, 1, 0, 0, 0, 0, int(lat * 1e7), int(lon * 1e7), 20, mission_type
    )


@pytest.fixture
def log(tmp_path: Path) -> Path:
    ground = 255
    return write(
        tmp_path / "flight.tlog",
        [
            (mavlink.MAVLink_mission_count_message(1, 1, 4), ground),
            *[(item(n, 10 + n / 100, 20), ground) for n in range(4)],
            (item(9, 50, 50, mission_type=1), ground),
            (item(3, 5, 5, frame=1), ground),
            (position(50, 50), 7),
            (beat(0), 1),
            *[(position(10 + n / 1000, 20), 1) for n in range(5)],
            (position(0, 0), 1),
            (beat(3), 1),
            *[(position(10, 20 + n / 1000, -50), 1) for n in range(5)],
            (mavlink.MAVLink_home_position_message(99_000_000, 200_000_000, 5_000, *HOME), 1),
        ],
    )


def test_a_track_is_the_vehicles(log):
    track = read_track(str(log))
    assert track.lat.tolist() == pytest.approx([10 + n / 1000 for n in range(5)] + [10.0] * 5)
    assert track.alt.tolist() == [100.0] * 5 + [-50.0] * 5
    assert track.times[0] == T0 / 1e6 + 9
    assert [mode for mode, _, _ in track.stretches()] == ["STABILIZE", "AUTO"]
    assert [(first, end) for _, first, end in track.stretches()] == [(0, 5), (5, 10)]
    assert track.home == Place("home", 9.9, 20.0, 5.0)
    names = [(place.name, place.lat) for place in track.waypoints]
    assert names == [("1", 10.01), ("2", 10.02)], "item 0 is home, 3 has no place on earth"
    assert read_track(str(log), system=7).lat.tolist() == [50.0]


def test_a_home_that_is_no_place_is_none(tmp_path):
    homes = [(10, 20), (0, 0), (99, 20), (10, 214.7483647)]
    messages = [(beat(), 1), (position(1, 1), 1)]
    for lat, lon in homes:
        degrees = round(lat * 1e7), round(lon * 1e7)
        messages.append((mavlink.MAVLink_home_position_message(*degrees, 5_000, *HOME), 1))
    path = str(write(tmp_path / "a.tlog", messages))
    assert read_track(path).home == Place("home", 10.0, 20.0, 5.0)
    assert read_track(str(write(tmp_path / "b.tlog", messages[:2] + messages[3:]))).home is None


def test_a_shorter_mission_replaces_a_longer_one(tmp_path):
    count = mavlink.MAVLink_mission_count_message(1, 1, 2)
    items = [(item(n, 10 + n, 20), 255) for n in range(5)]
    messages = [*items, (count, 255), (item(1, 30, 30), 255), (beat(), 1), (position(1, 1), 1)]
    track = read_track(str(write(tmp_path / "a.tlog", messages)))
    assert [(place.name, place.lat) for place in track.waypoints] == [("1", 30.0)]
    assert track.home == Place("home", 10.0, 20.0, 20.0)
    # Nothing tells the order of messages of several types in a raw stream.
    records, at = Path(tmp_path / "a.tlog").read_bytes(), 0
    frames = b""
    while at < len(records):
        length = 12 + records[at + 9]
        frames += records[at + 8 : at + 8 + length]
        at += 8 + length
    raw = tmp_path / "a.raw"
    raw.write_bytes(frames)
    track = read_track(str(raw))
    assert len(track.lat) and not track.waypoints


def test_many_counts_of_a_long_mission_take_no_longer_than_they_are(tmp_path):
    count = (mavlink.MAVLink_mission_count_message(1, 1, 65_535), 255)
    items = [(item(n, 10, 20), 255) for n in range(20_000)]
    path = write(tmp_path / "a.tlog", [*items, *[count] * 60_000, (beat(), 1), (position(1, 1), 1)])
    with watched():  # each count went through all items: two minutes
        assert len(read_track(str(path)).waypoints) == len(items) - 1


def test_positions_of_a_receiver_where_there_are_no_others(tmp_path):
    def gps(fix: int, lat: float) -> object:
        return mavlink.MAVLink_gps_raw_int_message(0, fix, int(lat * 1e7), 1, 0, 0, 0, 0, 0, 9)

    messages = [(beat(), 1), (gps(0, 3), 1), (gps(3, 4), 1), (gps(2, 5), 1)]
    assert read_track(str(write(tmp_path / "a.tlog", messages))).lat.tolist() == [4.0, 5.0]


def test_a_log_without_positions_is_named(tmp_path):
    path = write(tmp_path / "a.tlog", [(beat(), 1), (position(0, 0), 1), (position(91, 0), 1)])
    with pytest.raises(ValueError, match=r"no position in .*a\.tlog"):
        plots.draw_map(path, tmp_path / "a.html")
    assert not (tmp_path / "a.html").exists()


def test_a_page(log, tmp_path):
    plots.draw_map(log, tmp_path / "a.html")
    content = (tmp_path / "a.html").read_bytes()
    page = Page(content)
    assert page.links == [] and b"http" not in content.replace(b"http-equiv", b"")
    data = page.data()
    assert numbers(data["lat"])[:2].tolist() == pytest.approx([10.0, 10.001])
    assert [(one["mode"], one["first"], one["end"]) for one in data["stretches"]] == [
        ("STABILIZE", 0, 5),
        ("AUTO", 5, 10),
    ]
    assert data["home"] == {"name": "home", "lat": 9.9, "lon": 20.0, "alt": 5.0}
    assert [place["name"] for place in data["waypoints"]] == ["1", "2"]


@pytest.mark.skipif(shutil.which("node") is None, reason="needs node")
def test_the_names_of_start_and_end_do_not_meet(log, tmp_path):
    plots.draw_map(log, tmp_path / "a.html")
    function = re.search(
        r"^function leftwards.*?^}", (tmp_path / "a.html").read_text(), re.M | re.S
    )
    assert function
    ways = [(0, 0), (30, 0), (-30, 5), (59, -15), (-59, 15), (60, 0), (-60, 0), (0, 16)]
    script = (
        f"{function[0]} console.log(JSON.stringify({json.dumps(ways)}.map(w => leftwards(...w))))"
    )
    ran = subprocess.run(["node", "-e", script], capture_output=True, check=True)
    width = 32  # of the longer name
    for (right, down), left in zip(ways, json.loads(ran.stdout), strict=True):
        start = (-8 - width, -8) if left["start"] else (8, 8 + width)
        end = (right - 8 - width, right - 8) if left["end"] else (right + 8, right + 8 + width)
        apart = start[1] < end[0] or end[1] < start[0]
        assert apart or abs(down) >= 16, (right, down, left)


def test_a_way_over_the_date_line_goes_on(tmp_path):
    places = [(position(1, lon), 1) for lon in (179.9, -179.9, -179.8)]
    mission = [(item(1, 1, -179.85), 255)]
    log = write(tmp_path / "a.tlog", [(beat(), 1), *mission, *places])
    plots.draw_map(log, tmp_path / "a.html")
    data = Page((tmp_path / "a.html").read_bytes()).data()
    assert numbers(data["lon"]).tolist() == pytest.approx([179.9, 180.1, 180.2])
    assert data["waypoints"][0]["lon"] == pytest.approx(180.15)


def test_kml(log, tmp_path):
    plots.draw_map(log, tmp_path / "a.kml")
    root = etree.fromstring((tmp_path / "a.kml").read_bytes())
    assert root.tag == f"{KML}kml"
    marks = root.findall(f".//{KML}Placemark")
    names = [mark.findtext(f"{KML}name") for mark in marks]
    assert names == ["STABILIZE", "AUTO", "mission", "home", "1", "2"]
    styles = {style.get("id") for style in root.iter(f"{KML}Style")}
    assert {url.text.removeprefix("#") for url in root.iter(f"{KML}styleUrl")} <= styles
    ways = [way.text.split() for way in root.iter(f"{KML}coordinates")]
    assert ways[0][0] == "20.0000000,10.0000000,100.00"
    assert ways[0][-1] == ways[1][0], "no gap between two modes"
    assert (len(ways[0]), len(ways[1])) == (6, 5)
    span = marks[0].find(f"{KML}TimeSpan")
    assert span.findtext(f"{KML}begin") == "2020-09-13T12:26:49.000Z"


def test_gpx(log, tmp_path):
    plots.draw_map(log, tmp_path / "a.gpx")
    root = etree.fromstring((tmp_path / "a.gpx").read_bytes())
    order = ["metadata", "wpt", "rte", "trk"]
    assert [child.tag for child in root] == [f"{GPX}{name}" for name in order], "of the schema"
    points = list(root.iter(f"{GPX}trkpt"))
    assert [len(seg) for seg in root.iter(f"{GPX}trkseg")] == [5, 5]
    assert (points[1].get("lat"), points[1].get("lon")) == ("10.0010000", "20.0000000")
    assert [child.tag for child in points[0]] == [f"{GPX}ele", f"{GPX}time"]
    assert points[9].findtext(f"{GPX}ele") == "-50.000"
    assert [one.findtext(f"{GPX}name") for one in root.iter(f"{GPX}rtept")] == ["1", "2"]


@pytest.mark.parametrize("writer", [geo.kml, geo.gpx, maps.map_page])
def test_names_and_times_of_others_stay_texts(writer):
    columns = [np.array(column) for column in ([1e18, 2e18], [1.0, 2.0], [3.0, 4.0], [5.0, 6.0])]
    place = Place(HOSTILE, 1.0, 2.0, 3.0)
    modes = [Span(HOSTILE, 0.0, 1.0), Span("</script><script>", 2.0, 3.0)]
    track = Track(f"x{HOSTILE}", *columns, modes, place, [place, place])
    content = writer(track)
    if writer is maps.map_page:
        page = Page(content)
        assert page.tags.count("script") == 2
        assert page.data()["waypoints"][0]["name"] == HOSTILE
    else:
        pieces = list(content)
        assert max(map(len, pieces)) < 1_000, "written piece by piece, however long the flight"
        root = etree.fromstring("".join(pieces).encode())
        texts = [name.text for name in root.iter("{*}name")]
        assert any("]]><name>&\"'\ufffd\ufffd\ufffd\ufffd" in str(text) for text in texts)
        assert not list(root.iter("{*}time", "{*}TimeSpan")), "times that no calendar has"


def test_a_flight_of_the_traffic_maker(tmp_path):
    path = tmp_path / "flight.tlog"
    traffic.generate(path, 2_000)
    track = plots.draw_map(path, tmp_path / "a.gpx")
    assert len(track.times) > 100
    assert [one.mode for one in track.modes] == ["AUTO"]


@pytest.mark.skipif(not (LOGS / "dvd_old.BIN").is_file(), reason=f"no dvd_old.BIN in {LOGS}")
def test_dataflash_logs(tmp_path):
    log = LOGS / "dvd_old.BIN"
    track = plots.draw_map(log, tmp_path / "a.kml")
    assert len(track.times) == 249 and track.home is not None and track.modes
    done = plots.plot(log, ["ATT.Roll", "IMU[0].AccZ:2"], tmp_path / "a.html")
    both = plots.plot(log, "IMU.AccZ", tmp_path / "a.html")
    one, other = (plots.plot(log, f"IMU[{n}].AccZ", tmp_path / "a.html").points for n in (0, 1))
    assert (done.points, both.points) == (249 + one, one + other)


def test_the_command(tmp_path, log, capsys):
    out = tmp_path / "a.html"
    assert cli.main(["map", str(log), "--out", str(out)]) == 0
    assert capsys.readouterr().out == f"{out}: 10 positions, 2 waypoints\n"
    assert cli.main(["map", str(log), "--out", str(tmp_path / "a.pdf")]) == 1
    assert ".kml" in capsys.readouterr().err
    assert cli.main(["map", str(log), "--out", str(log)]) == 1
    assert "is the log itself" in capsys.readouterr().err
    assert cli.main(["map", str(tmp_path / "none.tlog"), "--out", str(out)]) == 1
    assert "none.tlog" in capsys.readouterr().err


def test_compressed_logs(log, tmp_path):
    dataflash = tmp_path / "flight.BIN"
    made = Log().define("POS", "QLLe", "TimeUS,Lat,Lng,Alt")
    made.add("POS", 1_000_000, 473_977_418, 85_455_939, 12_345).write(dataflash)
    for path in (log, dataflash):
        packed = tmp_path / f"{path.name}.gz"
        packed.write_bytes(gzip.compress(path.read_bytes()))
        found, same = read_track(str(packed)), read_track(str(path))
        assert found.name == packed.name
        assert (found.lat.tolist(), found.modes) == (same.lat.tolist(), same.modes)
        assert (found.home, found.waypoints) == (same.home, same.waypoints)
