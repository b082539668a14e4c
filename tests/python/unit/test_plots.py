"""Plots show what the messages say, and what a log holds never becomes markup or code."""

from __future__ import annotations

import base64
import gzip
import io
import json
import sys
from html.parser import HTMLParser
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest
from dataflash_writer import Log, sample
from mavwire import cli, mavutil, plots, traffic
from mavwire.cli.plots.plot import is_log
from mavwire.dialects.v20 import all as mavlink
from mavwire.expression import ExpressionError
from mavwire.plots.expressions import parse
from mavwire.plots.modes import Span, colours_of, spans
from mavwire.plots.pages import extremes
from mavwire.plots.series import read_series
from unit.link_tools import T0, heartbeat, pack, record

HOSTILE = "</script><script>alert(1)</script><!-- $x^ \u2028\x00\ud800&\"'"


@pytest.fixture(scope="module")
def flight(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("logs") / "flight.tlog"
    traffic.generate(path, 6_000, systems=2)
    return path


def attitudes(
    path: Path, count: int = 20, custom_modes: tuple[int, ...] = (0, 3), yaw: float = 0
) -> None:
    """A log in which the roll rises, with changes of mode in even spaces."""
    out = b""
    for n in range(count):
        mode = custom_modes[n * len(custom_modes) // count]
        beat = mavlink.MAVLink_heartbeat_message(2, 3, 81, mode, 4, 3)
        attitude = mavlink.MAVLink_attitude_message(n, n / 10, -n / 10, yaw, 0, 0, 0)
        out += record(pack(beat), T0 + n * 1_000_000)
        out += record(pack(attitude), T0 + n * 1_000_000 + 500_000)
    path.write_bytes(out)


class Page(HTMLParser):
    """The elements of a page, the texts of its scripts, and everything that leads elsewhere."""

    def __init__(self, content: bytes) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.scripts: list[str] = []
        self.links: list[str] = []
        self.feed(content.decode())

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.links += [value or "" for name, value in attrs if name in ("src", "href")]

    def handle_data(self, data: str) -> None:
        if self.tags[-1:] == ["script"]:
            self.scripts.append(data)

    def data(self) -> Any:
        """What the page draws."""
        return json.loads(self.scripts[0])


def numbers(text: str) -> Any:
    return np.frombuffer(base64.b64decode(text), "<f8")


# -- expressions


@pytest.mark.parametrize(
    ("text", "types", "plain", "right"),
    [
        ("ATTITUDE.roll", {"ATTITUDE"}, True, False),
        ("degrees(ATTITUDE.pitch):2", {"ATTITUDE"}, True, True),
        ("-ATTITUDE.roll*2+1:1", {"ATTITUDE"}, True, False),
        ("BATTERY_STATUS.voltages[0]/1000", {"BATTERY_STATUS"}, True, False),
        ("BATTERY_STATUS[0].current_battery", {"BATTERY_STATUS"}, False, False),
        ("ATTITUDE.roll%2", {"ATTITUDE"}, False, False),
        ("atan2(ATTITUDE.roll, 1)", {"ATTITUDE"}, True, False),
        ("atan2(ATTITUDE.roll)", {"ATTITUDE"}, False, False),
        ("sin(1, ATTITUDE.roll)", {"ATTITUDE"}, False, False),
        ("ATTITUDE.roll-VFR_HUD.alt", {"ATTITUDE", "VFR_HUD"}, False, False),
        ("ATTITUDE.roll{VFR_HUD.alt>3}", {"ATTITUDE", "VFR_HUD"}, False, False),
        ("mag_field(RAW_IMU)", {"RAW_IMU"}, False, False),
        ("sum([v for v in BATTERY_STATUS.voltages])", {"BATTERY_STATUS"}, False, False),
    ],
)
def test_what_an_expression_is(text, types, plain, right):
    found = parse(text)
    assert (found.types, found.plain, found.right) == (types, plain, right)


@pytest.mark.parametrize("text", ["", ":2", "ATTITUDE.roll+", "1+1", "MAV.flightmode", "a{b"])
def test_what_is_no_expression_is_named(text):
    with pytest.raises(ValueError):
        parse(text)


@pytest.mark.parametrize("text", ["__import__('os')", "ATTITUDE.__class__", "open('x')"])
def test_expressions_reach_nothing_but_messages(flight, tmp_path, text):
    with pytest.raises((ExpressionError, ValueError)):
        plots.plot(flight, f"{text}", tmp_path / "x.html")
    assert not (tmp_path / "x.html").exists()


EXPRESSIONS = [
    "ATTITUDE.roll",
    "degrees(ATTITUDE.pitch)",
    "-VFR_HUD.alt*2+1",
    "atan2(ATTITUDE.roll, ATTITUDE.pitch)",
    "BATTERY_STATUS.voltages[0]/1000",
    "GPS_RAW_INT.lat*1e-7",
    "SYSTEM_TIME.time_unix_usec",
    "sqrt(abs(ATTITUDE.roll))",
    "HEARTBEAT.custom_mode",
    "RAW_IMU.xacc/RAW_IMU.yacc",
    "MISSION_CURRENT.seq",
]


@pytest.mark.parametrize("text", EXPRESSIONS)
def test_columns_give_what_messages_give(flight, text):
    (fast,) = read_series(str(flight), [parse(text)]).series
    assert fast.expression.plain
    # A condition that always holds is asked of messages.
    (slow,) = read_series(str(flight), [parse(text)], condition="1").series
    assert len(fast.times) > 10
    np.testing.assert_array_equal(fast.times, slow.times)
    np.testing.assert_allclose(fast.values, slow.values, rtol=1e-13)


def test_each_message_of_the_vehicle_is_a_point(flight):
    link = mavutil.mavlink_connection(str(flight))
    expected = []
    while (msg := link.recv_match(type=["ATTITUDE"])) is not None:
        if msg.get_srcSystem() == 2:
            expected.append((msg._timestamp, msg.roll))
    link.close()
    (series,) = read_series(str(flight), [parse("ATTITUDE.roll")], system=2).series
    assert list(zip(series.times.tolist(), series.values.tolist(), strict=True)) == expected


def test_values_that_are_none_are_left_out_and_told_of(tmp_path):
    path = tmp_path / "a.tlog"
    attitudes(path)
    done = plots.plot(path, ["sqrt(ATTITUDE.pitch)", "log(ATTITUDE.roll)"], tmp_path / "a.html")
    assert done.points == 20, "the root of -0, and 19 logarithms"
    root, note = done.notes
    assert root == f"{path}: sqrt(ATTITUDE.pitch): 19 left out: no number"
    assert note.startswith(f"{path}: log(ATTITUDE.roll): 1 left out: ")
    done = plots.plot(path, ["ATTITUDE.roll", "WIND.speed"], tmp_path / "a.html")
    assert done.notes == [f"{path}: WIND.speed: there are no values"]
    with pytest.raises(ValueError, match="there are no values"):
        plots.plot(path, "WIND.speed", tmp_path / "b.html")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("ATTITUDE.rol", "no field 'rol'"),
        ("ATITUDE.roll", "did you mean 'ATTITUDE'"),
        ("STATUSTEXT.text", "texts"),
        ("BATTERY_STATUS.voltages", "name an element"),
        ("BATTERY_STATUS.voltages[10]", "no such element"),
        ("ATTITUDE.roll[0]", "no such element"),
        ("sin(1,ATTITUDE.roll)", "exactly one argument"),
        ("atan2(1,ATTITUDE.pitch,ATTITUDE.roll)", "2 arguments"),
    ],
)
def test_fields_that_are_not_there_are_named(flight, tmp_path, text, said):
    with pytest.raises(ValueError, match=said.replace("[", r"\[")):
        plots.plot(flight, text, tmp_path / "x.html")


@pytest.mark.parametrize(
    ("text", "condition", "said"),
    [
        ("nofunc(ATTITUDE.roll)", None, "there is no 'nofunc'"),
        ("ATTITUDE.roll{ATTITUDE.rol>0}", None, "ATTITUDE has no field 'rol'"),
        ("ATTITUDE.roll{ATTITUDE.roll>9}", None, "ATTITUDE.roll>9 does not hold"),
        ("ATTITUDE.roll", "ATTITUDE.roll>9", "ATTITUDE.roll>9 does not hold"),
        ("ATTITUDE.roll", "1/0", "division by zero"),
        ("ATTITUDE.roll", "x(", "the condition 'x(': '(' was never closed"),
        ("ATTITUDE.roll", "ATTITUDE.rol", "ATTITUDE has no field 'rol'"),
        ("ATTITUDE", None, "ATTITUDE is a message: name a field"),
        ("ATTITUDE[3].roll", None, "ATTITUDE has no instance 3"),
        ("max([1][ATTITUDE.type])", None, "ATTITUDE has no field 'type'"),
        ("[ATTITUDE.roll][2]", None, "list index out of range"),
        ("max([ATTITUDE.roll])/0", None, "division by zero"),
        ("[ATTITUDE.roll]", None, "list is no number"),
        ("STATUSTEXT.text+''", None, "' is no number"),
        ("mag_field(ATTITUDE)", None, "ATTITUDE has no field 'xmag'"),
    ],
)
def test_expressions_without_a_value_say_why_in_words(flight, tmp_path, text, condition, said):
    with pytest.raises(ValueError) as caught:
        plots.plot(flight, text, tmp_path / "x.html", condition=condition)
    assert said in str(caught.value) and "MAVLink_" not in str(caught.value)


def test_fields_that_a_dataflash_log_does_not_have_are_named(tmp_path):
    path = tmp_path / "flight.BIN"
    path.write_bytes(sample().data)
    with pytest.raises(ValueError, match="left out: IMU has no field 'nofield'"):
        plots.plot(path, "IMU.nofield", tmp_path / "x.html")


def battery(seq: int, number: int) -> bytes:
    return pack(mavlink.MAVLink_battery_status_message(number, 0, 0, 0, [1] * 10, 0, 0, 0, 0), seq)


@pytest.mark.parametrize("condition", [None, "1"], ids=["columns", "messages"])
@pytest.mark.parametrize(
    ("text", "numbers", "is_mixed"),
    [
        ("BATTERY_STATUS.battery_remaining", (0, 1), True),
        ("BATTERY_STATUS.battery_remaining", (1, 1), False),
        ("BATTERY_STATUS[1].battery_remaining", (0, 1), False),
        ("ATTITUDE.roll", (0, 1), False),
    ],
)
def test_a_line_of_several_instances_is_named(tmp_path, condition, text, numbers, is_mixed):
    path = tmp_path / "a.tlog"
    attitudes(path)
    with path.open("ab") as file:
        for seq, number in enumerate(numbers):
            file.write(record(battery(seq, number), T0 + seq))
    done = plots.plot(path, text, tmp_path / "a.html", condition=condition)
    said = f"{path}: {text}: all instances are one line: write BATTERY_STATUS[n] for one of them"
    assert done.notes == ([said] if is_mixed else [])


def test_instances_of_a_dataflash_log_are_named(tmp_path):
    path = sample().write(tmp_path / "flight.BIN")
    said = f"{path}: IMU.AccX: all instances are one line: write IMU[n] for one of them"
    assert plots.plot(path, "IMU.AccX", tmp_path / "x.html").notes[-1] == said
    one = plots.plot(path, "IMU[1].AccX", tmp_path / "x.html").notes
    assert not [note for note in one if "instances" in note]


@pytest.mark.parametrize("text", ["HEARTBEAT.type", "HEARTBEAT.type%20"])
def test_a_dialect_may_be_a_path(flight, tmp_path, text):
    path = tmp_path / "own.xml"
    path.write_text("<mavlink><include>minimal.xml</include></mavlink>")
    assert plots.plot(flight, text, tmp_path / "x.html", dialect=path).points


def test_a_log_without_times_is_named(tmp_path):
    path = tmp_path / "stream.raw"
    path.write_bytes(heartbeat() * 50)
    with pytest.raises(ValueError, match="no times"):
        plots.plot(path, "HEARTBEAT.type", tmp_path / "x.html")


@pytest.mark.parametrize("text", ["VFR_HUD.alt", "VFR_HUD.alt%2"], ids=["columns", "messages"])
def test_compressed_logs(flight, tmp_path, text):
    path = tmp_path / "flight.tlog.gz"
    path.write_bytes(gzip.compress(flight.read_bytes(), 1))
    found, same = (read_series(str(p), [parse(text)]) for p in (path, flight))
    assert found.path == str(path)
    assert found.modes == same.modes
    np.testing.assert_array_equal(found.series[0].times, same.series[0].times)
    np.testing.assert_array_equal(found.series[0].values, same.series[0].values)
    assert len(found.series[0].times) > 10


def test_compressed_dataflash_logs(tmp_path):
    plain, path = tmp_path / "flight.BIN", tmp_path / "flight.BIN.gz"
    plain.write_bytes(sample().data)
    path.write_bytes(gzip.compress(sample().data))
    found, same = (read_series(str(p), [parse("IMU.AccX")]) for p in (path, plain))
    assert (found.path, found.modes) == (str(path), same.modes)
    np.testing.assert_array_equal(found.series[0].values, same.series[0].values)
    assert len(found.series[0].values)


# -- the options of mavgraph


@pytest.mark.parametrize("name", ["flight.txt", "flight.txt.gz", "flight.BIN"])
def test_a_dataflash_log_under_another_name(tmp_path, name):
    """By what is in it, as tables of it are read."""
    text = (
        b"FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n"
        b"FMT, 129, 23, ATT, Qf, TimeUS,Roll\nATT, 1000000, 1.5\nATT, 2000000, 2.5\n"
    )
    path = tmp_path / name
    path.write_bytes(gzip.compress(text) if name.endswith(".gz") else text)
    (series,) = read_series(str(path), [parse("ATT.Roll")]).series
    assert series.values.tolist() == [1.5, 2.5]
    binary = tmp_path / "binary.tlog"
    sample().write(binary)
    assert len(read_series(str(binary), [parse("IMU.AccX")]).series[0].values)


def test_values_over_another_expression(tmp_path):
    path = tmp_path / "a.tlog"
    attitudes(path)
    done = plots.plot(path, "ATTITUDE.roll", tmp_path / "x.html", xaxis="ATTITUDE.pitch*2")
    assert done.points == 20
    data = Page((tmp_path / "x.html").read_bytes()).data()
    assert (data["absolute"], data["across"], data["modes"]) == (False, "ATTITUDE.pitch*2", [])
    across, values = numbers(data["lines"][0]["x"]) + data["zero"], numbers(data["lines"][0]["y"])
    np.testing.assert_allclose(across, [-n / 5 for n in range(20)], rtol=1e-6)
    np.testing.assert_allclose(values, [n / 10 for n in range(20)], rtol=1e-6)


def test_the_x_axis_may_be_of_another_message(tmp_path):
    path = tmp_path / "a.tlog"
    attitudes(path)
    (series,) = read_series(
        str(path), [parse("ATTITUDE.roll")], xaxis=parse("HEARTBEAT.custom_mode")
    ).series
    assert series.times.tolist() == [0.0] * 10 + [3.0] * 10


@pytest.mark.parametrize("more", ["", "+0%1"])
@pytest.mark.parametrize(
    ("text", "left_out"),
    [("1/ATTITUDE.pitch", 1), ("ATTITUDE.yaw", 20), ("ATTITUDE.roll", 0)],
)
def test_columns_and_messages_leave_out_the_same(tmp_path, text, left_out, more):
    path = tmp_path / "a.tlog"
    attitudes(path, yaw=float("nan"))
    parsed = parse(text + more)
    assert parsed.plain == (not more)
    (series,) = read_series(str(path), [parsed]).series
    assert (series.left_out, len(series.times)) == (left_out, 20 - left_out)
    assert series.error == ("no number" if left_out else None)


@pytest.mark.parametrize("damaged", ["nan", "inf", "1e300"])
def test_a_damaged_time_ends_no_plot_and_no_map(tmp_path, damaged):
    lines = [
        "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns",
        "FMT, 1, 0, ATT, Qff, TimeUS,Roll,Pitch",
        "FMT, 2, 0, MODE, QMB, TimeUS,Mode,ModeNum",
        "FMT, 3, 0, POS, QLLf, TimeUS,Lat,Lng,Alt",
    ]
    for n in range(30):
        time = 1_000_000 + n * 1000
        lines += [f"ATT, {time}, {n}, 1", f"POS, {time}, {-35 + n * 1e-4}, 149.1, 10"]
        if n in (5, 20):
            lines.append(f"MODE, {damaged if n == 5 else time}, {'AUTO' if n == 5 else 'RTL'}, 3")
        if n == 10:
            lines += [f"ATT, {damaged}, 5, 5", f"POS, {damaged}, -35, 149, 10"]
    path = tmp_path / "damaged.log"
    path.write_text("\n".join(lines) + "\n")
    assert plots.plot(path, "ATT.Roll", tmp_path / "a.html").points >= 30
    Page((tmp_path / "a.html").read_bytes()).data()
    for suffix in ("html", "kml", "gpx"):
        plots.draw_map(path, tmp_path / f"map.{suffix}")
        assert (tmp_path / f"map.{suffix}").stat().st_size


def test_a_condition_that_does_not_hold_leaves_nothing_out(tmp_path):
    path = tmp_path / "a.tlog"
    attitudes(path)
    (series,) = read_series(str(path), [parse("ATTITUDE.roll{ATTITUDE.roll>1}")]).series
    assert 0 < len(series.times) < 20 and series.left_out == 0


@pytest.mark.parametrize(
    ("xaxis", "left", "told", "why"),
    [
        ("1/ATTITUDE.pitch", 19, 1, "no number"),
        ("VFR_HUD.alt", 0, 0, "there is no 'VFR_HUD'"),
        ("sqrt(ATTITUDE.pitch)", 1, 19, "math domain error"),
    ],
)
def test_what_has_no_place_on_the_x_axis_is_left_out(tmp_path, xaxis, left, told, why):
    path = tmp_path / "a.tlog"
    attitudes(path)
    (series,) = read_series(str(path), [parse("ATTITUDE.roll")], xaxis=parse(xaxis)).series
    assert (len(series.times), series.left_out, series.error) == (left, told, why)


def test_the_first_log_moves_in_time(tmp_path):
    path, out = tmp_path / "a.tlog", tmp_path / "x.html"
    attitudes(path)
    plots.plot([path, path], "ATTITUDE.roll", out, timeshift=-2.5)
    data = Page(out.read_bytes()).data()
    first, second = (numbers(line["x"]) for line in data["lines"])
    np.testing.assert_allclose(first + 2.5, second, atol=1e-6)
    begin = data["modes"][0]["start"]
    plots.plot([path, path], "ATTITUDE.roll", out)
    data = Page(out.read_bytes()).data()
    assert data["modes"][0]["start"] + data["zero"] == pytest.approx(T0 / 1e6)
    assert begin == pytest.approx(-0.5), "modes move with their log"


def test_numbers_of_numpy_are_numbers(flight, tmp_path):
    out, shift = tmp_path / "x.html", np.float32(1)
    assert plots.plot(flight, "ATTITUDE.roll", out, timeshift=shift, system=np.uint8(1)).points
    with pytest.raises(ValueError, match="a system id is a number"):
        plots.draw_map(flight, out, system=[1])


def test_whose_flight_modes_they_are(tmp_path):
    path = tmp_path / "a.tlog"
    attitudes(path)
    found = {
        name: [span.mode for span in read_series(str(path), [], autopilot=number).modes]
        for name, number in {"own": None, "apm": 3, "px4": 12}.items()
    }
    assert found["own"] == found["apm"] == ["STABILIZE", "AUTO"]
    assert found["px4"] != found["apm"]


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"flightmode": "inav"}, "apm, px4"),
        ({"xaxis": "ATTITUDE.pitch", "relative": True}, "relative"),
        ({"xaxis": "ATTITUDE.pitch", "timeshift": 1.0}, "timeshift"),
        ({"xaxis": "1+"}, "no expression"),
        ({"timeshift": float("nan")}, "seconds"),
        ({"timeshift": "1"}, "seconds"),
        ({"xaxis": 1}, "an expression is a text"),
        ({"system": [1]}, "a system id is a number"),
        ({"system": 256}, "a system id is 0 to 255"),
    ],
)
def test_options_that_make_no_sense_are_named(flight, tmp_path, wrong, said):
    with pytest.raises(ValueError, match=said):
        plots.plot(flight, "ATTITUDE.roll", tmp_path / "x.html", **wrong)
    assert not (tmp_path / "x.html").exists()


def test_the_command_takes_the_options(tmp_path, capsys):
    path, out = tmp_path / "a.tlog", tmp_path / "x.html"
    attitudes(path)
    argv = ["plot", str(path), "ATTITUDE.roll", "-o", str(out)]
    assert cli.main([*argv, "--xaxis", "ATTITUDE.pitch", "--condition", "ATTITUDE.roll>1"]) == 0
    data = Page(out.read_bytes()).data()
    assert (data["across"], len(numbers(data["lines"][0]["x"]))) == ("ATTITUDE.pitch", 9)
    assert cli.main([*argv, "--timeshift", "3", "--flightmode", "px4"]) == 0
    assert "20 points" in capsys.readouterr().out


# -- modes


def test_flight_modes(tmp_path):
    path = tmp_path / "a.tlog"
    attitudes(path, custom_modes=(0, 3, 3, 6))
    (span, auto, rtl) = read_series(str(path), [parse("ATTITUDE.roll")]).modes
    assert [one.mode for one in (span, auto, rtl)] == ["STABILIZE", "AUTO", "RTL"]
    assert (span.start, span.end, auto.end) == (T0 / 1e6, T0 / 1e6 + 5, T0 / 1e6 + 15)
    assert rtl.end == T0 / 1e6 + 19.5


def test_modes_of_messages_are_those_of_columns(flight):
    fast = read_series(str(flight), [parse("ATTITUDE.roll")]).modes
    link = mavutil.mavlink_connection(str(flight))
    changes = []
    while (msg := link.recv_match(type=["HEARTBEAT"])) is not None:
        if msg.get_srcSystem() == link.sysid:
            changes.append((msg._timestamp, link.flightmode))
    link.close()
    assert [(s.mode, s.start) for s in fast] == [(s.mode, s.start) for s in spans(changes, None)]
    assert colours_of(["A", "B", "A"]).keys() == {"A", "B"}


def test_a_flood_of_modes_is_bounded():
    changes = [(float(n), f"MODE{n}") for n in range(20_000)]
    assert len(spans(changes, 30_000.0)) == 10_000
    assert spans([], 1.0) == []
    assert spans([(1.0, "UNKNOWN"), (2.0, "AUTO")], 3.0) == [Span("AUTO", 2.0, 3.0)]


# -- pages


def test_a_page_holds_the_values_and_loads_nothing(tmp_path):
    log, out = tmp_path / "a.tlog", tmp_path / "a.html"
    attitudes(log)
    plots.plot(log, ["ATTITUDE.roll", "ATTITUDE.pitch:2"], out)
    page = Page(out.read_bytes())
    assert page.tags.count("script") == 2 and page.links == []
    assert b"http" not in out.read_bytes().replace(b"http-equiv", b"")
    data = page.data()
    roll, pitch = data["lines"]
    assert numbers(roll["x"]).tolist() == [float(n) for n in range(20)]
    np.testing.assert_allclose(numbers(pitch["y"]), -np.arange(20) / 10, rtol=1e-6)
    assert (roll["right"], pitch["right"], pitch["label"]) == (False, True, "ATTITUDE.pitch")
    assert (data["zero"], data["absolute"]) == (T0 / 1e6 + 0.5, True)
    assert [one["mode"] for one in data["modes"]] == ["STABILIZE", "AUTO"]


def test_names_are_data_and_never_markup(tmp_path):
    log, out = tmp_path / "<img src=x onerror=alert(1)>.tlog", tmp_path / "a.html"
    attitudes(log)
    plots.plot([log, log], "ATTITUDE.roll", out, labels=[HOSTILE], title=HOSTILE)
    page = Page(out.read_bytes())
    assert page.tags.count("script") == 2 and "img" not in page.tags and page.links == []
    label = page.data()["lines"][0]["label"]
    assert label == f"{log.name}: {HOSTILE}"


def test_many_points_keep_their_extremes():
    values = np.array([Random(1).random() for _ in range(10_007)])
    values[5_000], values[7_001] = 9.0, -9.0
    kept = extremes(values, 1_000)
    assert len(kept) <= 1_000 and {0, 5_000, 7_001, 10_006} <= set(kept.tolist())
    assert (np.diff(kept) > 0).all()
    assert extremes(values, 20_000).tolist() == list(range(10_007))


# -- images


@pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
def test_images(tmp_path, suffix):
    pytest.importorskip("matplotlib")
    log, out = tmp_path / "a$b_$.tlog", tmp_path / f"a.{suffix}"
    attitudes(log, custom_modes=(0, 3, 99))
    plots.plot(log, ["ATTITUDE.roll", "ATTITUDE.pitch:2"], out, labels=["_$\\frac$ \x01", "\u6f22"])
    content = out.read_bytes()
    assert content.startswith({"png": b"\x89PNG", "svg": b"<?xml", "pdf": b"%PDF"}[suffix])
    assert [one.name for one in tmp_path.iterdir() if one.suffix == ".part"] == []


def test_an_image_shows_lines_axes_and_modes(tmp_path):
    pytest.importorskip("matplotlib")
    from matplotlib.figure import Figure
    from mavwire.plots import images
    from mavwire.plots.charts import Chart, Line

    times = np.arange(10.0) + 1.6e9
    modes = [Span("AUTO", 1.6e9, 1.6e9 + 5), Span("RTL", 1.6e9 + 5, 1.6e9 + 9)]
    lines = [Line("a", False, times, times % 7), Line("b", True, times, times % 3)]
    figure = Figure()
    images._draw(figure, Chart("title", lines, modes, absolute=True))
    left, right = figure.axes
    assert [len(axes.lines) for axes in (left, right)] == [1, 1]
    assert [text.get_text().strip() for text in left.texts] == ["AUTO", "RTL"]
    assert [text.get_text() for text in right.get_legend().get_texts()] == ["a", "b (right)"]
    figure.savefig(io.BytesIO())


@pytest.mark.parametrize("right", [False, True])
def test_a_legend_hides_no_mode(right):
    pytest.importorskip("matplotlib")
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from mavwire.plots import images
    from mavwire.plots.charts import Chart, Line

    times = np.arange(100.0)
    modes = [Span(f"MODE{n}", 20.0 * n, 20.0 * n + 20) for n in range(5)]
    # What is drawn leaves room at the top alone.
    lines = [
        Line("a name", right, times, (times % 7) * 1e-3),
        Line("other", False, times, -times % 5),
    ]
    lines.append(Line("top", False, np.array([50.0]), np.array([40.0])))
    figure = Figure(figsize=images.SIZE, layout="constrained")
    FigureCanvasAgg(figure)
    images._draw(figure, Chart("title", lines, modes, absolute=False))
    figure.draw_without_rendering()
    left = figure.axes[0]
    legend = figure.axes[-1].get_legend().get_window_extent()
    names = [text.get_window_extent() for text in left.texts]
    assert len(names) == 5
    for name in names:
        assert not legend.overlaps(name) and not left.title.get_window_extent().overlaps(name)


@pytest.mark.parametrize("what", ["plot", "map"])
def test_pictures_without_numpy_say_what_to_install(tmp_path, flight, monkeypatch, capsys, what):
    monkeypatch.setitem(sys.modules, "numpy", None)
    expressions = ["ATTITUDE.roll"] if what == "plot" else []
    assert cli.main([what, str(flight), *expressions, "-o", str(tmp_path / "x.html")]) == 1
    assert "numpy is needed: pip install 'mavwire[plot]'" in capsys.readouterr().err


def test_images_without_matplotlib_say_what_to_install(tmp_path, flight, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    argv = ["plot", str(flight), "ATTITUDE.roll", "-o", str(tmp_path / "x.png")]
    assert cli.main(argv) == 1
    assert "pip install 'mavwire[plot]'" in capsys.readouterr().err


YEAR_9999 = 253_400_000 * 10**9
"""Microseconds since 1970 of a day in December."""


@pytest.mark.parametrize(
    "stamps",
    [(2**60, 2**60 + 10**6, 2**61), (2**64 - 1,), (T0, 2**63), (T0, YEAR_9999), (YEAR_9999,)],
)
def test_times_that_no_calendar_has(tmp_path, stamps):
    """Some have none for the margins of an axis only."""
    pytest.importorskip("matplotlib")
    path = tmp_path / "far.tlog"
    attitude = mavlink.MAVLink_attitude_message(0, 1, 2, 3, 0, 0, 0)
    frames = heartbeat(), pack(attitude)
    path.write_bytes(b"".join(record(frame, one) for one in stamps for frame in frames))
    for suffix in ("png", "html"):
        assert plots.plot(path, "ATTITUDE.roll", tmp_path / f"x.{suffix}").points == len(stamps)
    assert Page((tmp_path / "x.html").read_bytes()).data()["absolute"] is False
    argv = ["graph", str(path), "ATTITUDE.roll", "--flightmode", "apm", "--output"]
    assert cli.main([*argv, str(tmp_path / "graph.png")]) == 0


def test_several_logs_side_by_side(tmp_path):
    logs = [tmp_path / "a.tlog", tmp_path / "b.tlog"]
    for log in logs:
        attitudes(log)
    logs[1].write_bytes(logs[1].read_bytes().replace(b"\x00\x05\xaf", b"\x00\x05\xb0"))
    plots.plot(logs, "ATTITUDE.roll", tmp_path / "x.html", relative=True)
    data = Page((tmp_path / "x.html").read_bytes()).data()
    assert [one["label"] for one in data["lines"]] == [f"{n}.tlog: ATTITUDE.roll" for n in "ab"]
    assert {numbers(one["x"])[0] for one in data["lines"]} == {0.0}


def test_each_expression_is_drawn_from_the_logs_that_have_its_message(tmp_path):
    flight, onboard = tmp_path / "a.tlog", sample().write(tmp_path / "b.BIN")
    attitudes(flight)
    for logs in ([flight, onboard], [onboard, flight]):
        done = plots.plot(
            logs, ["IMU.AccX", "ATTITUDE.roll"], tmp_path / "x.html", labels=["x", "r"]
        )
        lines = Page((tmp_path / "x.html").read_bytes()).data()["lines"]
        assert {one["label"] for one in lines} == {"b.BIN: x", "a.tlog: r"}
        assert not any("a.tlog: IMU" in note for note in done.notes)
        done = plots.plot(logs, "IMU.AccX{IMU.AccX>-99}", tmp_path / "x.html")
        assert f"{flight}: not drawn: it cannot have the messages of the expressions" in done.notes
    for wrong, hint in ("IMV.AccX", "'IMU'"), ("ATITUDE.roll%2", "'ATTITUDE'"):
        said = f"{wrong}: no log has a message .*; did you mean {hint}"
        with pytest.raises(ValueError, match=said):
            plots.plot([flight, onboard], ["IMU.AccX", wrong], tmp_path / "x.html")
    with pytest.raises(ValueError, match="no log has all of ATTITUDE, IMU"):
        plots.plot([flight, onboard], "ATTITUDE.roll+IMU.AccX", tmp_path / "x.html")


def test_home_is_no_field_of_the_message():
    from mavwire.plots.expressions import parse

    assert not parse("GLOBAL_POSITION_INT.lat-HOME.lat").plain
    assert parse("GLOBAL_POSITION_INT.lat-1").plain


# -- the command


def test_the_command(tmp_path, flight, capsys):
    out = tmp_path / "x.html"
    argv = ["plot", "ATTITUDE.roll", str(flight), "VFR_HUD.alt:2", "-o", str(out)]
    assert cli.main(argv) == 0
    assert capsys.readouterr().out.startswith(f"{out}: ")
    assert len(Page(out.read_bytes()).data()["lines"]) == 2


@pytest.mark.parametrize("field", ["GX", "GZ"])
def test_a_field_is_no_compressed_log(tmp_path, capsys, field):
    log = Log().define("XKF1", "Qff", "TimeUS,GX,GZ")
    for n in range(3):
        log.add("XKF1", 1000 * n, 0.5, 0.5)
    path, out = log.write(tmp_path / "X.BIN"), tmp_path / "x.html"
    assert cli.main(["plot", path, f"XKF1.{field}", "-o", str(out)]) == 0, capsys.readouterr().err
    assert [one["label"] for one in Page(out.read_bytes()).data()["lines"]] == [f"XKF1.{field}"]


@pytest.mark.parametrize(
    ("name", "wanted"),
    [
        ("XKF1.GZ", False),
        ("NKF1.GZ", False),
        ("XKF1.GX", False),
        ("IMU.gz", False),
        ("degrees(IMU.GZ)", False),
        ("none.tlog", True),
        ("none.tlog.gz", True),
        ("NONE.BIN", True),
        ("NONE.BIN.GZ", True),
        ("none.log.zst", True),
    ],
)
def test_what_is_a_log_though_it_is_missing(tmp_path, monkeypatch, name, wanted):
    monkeypatch.chdir(tmp_path)
    assert is_log(name) is wanted


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["{log}", "ATTITUDE.roll", "-o", "x.jpg"], "cannot write"),
        (["{log}", "none.tlog.gz", "ATTITUDE.roll", "-o", "x.html"], "none.tlog.gz: No such file"),
        (["{log}", "-o", "x.html"], "no expression given"),
        (["ATTITUDE.roll", "-o", "x.html"], "there is no log"),
        (["none.tlog", "ATTITUDE.roll", "-o", "x.html"], "none.tlog"),
        (["{log}", "ATTITUDE.roll", "-o", "{log}"], "is the log itself"),
        (["{log}", "ATTITUDE.roll", "-o", "no/folder/x.html"], "no/folder"),
        (["{log}", "ATTITUDE.roll", "--labels", "a,b", "-o", "x.html"], "labels"),
        (["{log}", "ATTITUDE.roll", "--dialect", "nope", "-o", "x.html"], "nope"),
        (["{log}", "ATTITUDE.roll", "--condition", "1+", "-o", "x.html"], "the condition '1+'"),
    ],
)
def test_the_command_says_what_is_wrong(tmp_path, flight, capsys, monkeypatch, words, said):
    monkeypatch.chdir(tmp_path)
    assert cli.main(["plot", *(word.format(log=flight) for word in words)]) == 1
    error = capsys.readouterr().err
    assert said in error and "Traceback" not in error
    assert list(tmp_path.iterdir()) == []
