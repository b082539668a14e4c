"""The inspector's page in a real browser: a simulated vehicle on it, plotted, paused and filtered."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest

pytest.importorskip("aiohttp", reason="aiohttp is not installed: pip install 'mavwire[web]'")

from integration.browser import browse, executable
from mavwire import Bridge
from mavwire.bridge.inspector_server import Inspector
from mavwire.dialects.v20 import all as mavlink
from mavwire.sim import Vehicle, serve
from unit.bridge_tools import port_of, udp_peer
from unit.link_tools import heartbeat, pack

HOSTILE = "<img src=x onerror=document.title='bad'>"
ROW = "[...document.querySelectorAll('.kind')].find(row => row.cells[0].textContent == '{}')"
# What takes the most room of texts, and of numbers that are none to JavaScript.
LONG_NAME, NOTICE, MOST = (
    "BATT_LOW_TIMERS_",
    "PreArm: compass not calibrated, GPS 1: not healthy",
    2**64 - 1,
)
TEXTS = [
    mavlink.MAVLink_param_value_message(LONG_NAME.encode(), 1, 9, 900, 3),
    mavlink.MAVLink_statustext_message(4, NOTICE.encode()),
    mavlink.MAVLink_named_value_float_message(5, b"motor 1", float("nan")),
    mavlink.MAVLink_system_time_message(MOST, 1),
]  # fmt: skip
WHOLE = "no name, number or text is cut into pieces"
OURS = "[...document.querySelectorAll('.kind')].find(row => row.cells[1].textContent == '66/1')"
# Of two plots, which rise by 1 rad and by 1 m high up: the share of the canvas from their lowest to their highest point.
HEIGHTS = """(() => {
  const plots = [["rad", 0, "#ff0000"], ["m", 600, "#0000ff"]];
  series.clear();
  for (const [unit, low, colour] of plots)
    series.set(unit, { row: { key: unit }, unit, colour, points: [[clock - 20, low], [clock - 10, low + 1]] });
  draw();
  const { width, height } = byId("plot");
  const pixels = byId("plot").getContext("2d").getImageData(0, 0, width, height).data;
  return [0, 2].map((channel) => {
    const rows = [];
    for (let at = 0; at < pixels.length; at += 4)
      if (pixels[at + channel] > 200 && pixels[at + 1] < 50 && pixels[at + 2 - channel] < 50) rows.push(at / 4 / width);
    return (rows[rows.length - 1] - rows[0]) / height;
  });
})()"""
# The points of a plot after the bridge's clock was set back.
CLOCK_SET_BACK = """(() => {
  const one = { row: { key: "9/9/30" }, field: 0, at: null, unit: "", points: [] };
  series.clear();
  series.set("one", one);
  for (const [time, value] of [[5000, 1], [1000, 2]]) take({ time, values: { "9/9/30": [time, [[value, ""]]] } });
  return one.points.map(([time, value]) => [time, value]);
})()"""
# Which points of a plot begin a new line when the page was paused, or without the bridge, between them.
CUTS = """(() => {
  const one = { row: { key: "9/9/31" }, field: 0, at: null, unit: "", points: [] };
  series.clear();
  series.set("one", one);
  const point = (time) => take({ time, values: { "9/9/31": [time, [[1, ""]]] } });
  point(100); point(101); cut(); point(104); point(105);
  return one.points.map(([time, , isCut]) => isCut ? time : 0);
})()"""
# Rates of counters that are asked for each half second: of 1 Hz, of one message in 1.7 s, and of what ended; and the
# least and the greatest rate that the first two showed. The times of components jitter.
RATES = """(() => {
  const seen = { 1: [], 1.7: [] };
  for (let now = 10, jitter = 0; now < 30; now += 0.5, jitter = 0.0002 - jitter)
    for (const each of [1, 1.7]) {
      const count = Math.floor(now / each);
      seen[each].push(rate("test" + each, count, count * each + jitter, now));
    }
  const ended = rate("test1", 29, 29, 60);
  for (const each of [1, 1.7]) rates.delete("test" + each);
  return [1, 1.7].flatMap((each) => [Math.min(...seen[each].slice(8)), Math.max(...seen[each].slice(8))]).concat(ended);
})()"""
# The rates that are shown of 50 Hz from the second time on, the first time, after a rest of a minute, and after the counter
# and then the clock began anew; and the rate of what has not come since.
RESTS = """(() => {
  const shown = [];
  let now = 1000, count = 0;
  const half = () => rate("rests", count += 25, now += 0.5, now);
  const twice = () => { half(); shown.push(half(), half()); };
  twice();
  now += 60; twice();
  now += 60; half(); now += 60; twice();
  count = 0; twice();
  now = 500; twice();
  shown.push(rate("rests", count, now, 100));
  rates.delete("rests");
  return shown;
})()"""
# The greatest rate of five messages at once each five seconds, one update of the page between them.
BURSTS = """(() => {
  const shown = [];
  for (let n = 1; n < 10; n++)
    shown.push(rate("bursts", 5 * n - 3, 5 * n, 5 * n), rate("bursts", 5 * n, 5 * n + 0.05, 5 * n + 0.5));
  rates.delete("bursts");
  return Math.max(...shown.slice(2));
})()"""
# Lines and elements of a page with 4,000 kinds of messages, at its beginning and in the middle, and how many a filter finds.
MANY = """(async () => {
  const kinds = [];
  for (let system = 1; system <= 250; system++)
    for (let id = 0; id < 16; id++) kinds.push([system, 7, 9000 + id, 1, 1, "far"]);
  for (let id = 0; id < 16; id++) types[9000 + id] = { name: `KIND_${id}`, fields: [["x", "float", "m"]] };
  const tables = { uptime: 1, links: [], components: [], hidden: 0, hidden_components: 0, recording: null };
  paused = true;
  const drawn = () => document.querySelectorAll(".kind").length;
  take({ ...tables, time: 1, kinds });
  const result = [found.length, drawn()];
  byId("kinds").querySelector(".kind").focus();
  take({ ...tables, time: 2, kinds });
  result.push(document.activeElement.className);
  window.scrollTo(0, document.documentElement.scrollHeight / 2);
  await new Promise((done) => setTimeout(done, 300));
  const places = [...document.querySelectorAll(".kind")].map((line) => line.getBoundingClientRect());
  result.push(drawn(), places[0].top < 0 && places[places.length - 1].bottom > innerHeight);
  for (const words of ["kind_3 7/7", "kind_3 17/7, kind_4 17/7", "nothing", ""]) {
    byId("filter").value = words;
    sift();
    result.push(found.length);
  }
  window.scrollTo(0, 0);
  paused = false;
  return result;
})()"""
# Lines of text that names, single numbers and texts of open messages take, at most.
BROKEN = """(() => {
  const pieces = (one) => {
    const range = document.createRange();
    range.selectNodeContents(one);
    return new Set([...range.getClientRects()].map((box) => box.top)).size;
  };
  return Math.max(...[...document.querySelectorAll(".fields td td:first-child, .value span")].map(pieces));
})()"""
# What is left of messages and links when the bridge has none any more.
FORGOTTEN = """(() => {
  take({ time: 0, uptime: 0, kinds: [], links: [], components: [], hidden: 0, hidden_components: 0, recording: null });
  return [rows.size, sorted.length, rates.size, document.querySelectorAll('.kind').length];
})()"""


@pytest.mark.skipif(executable() is None, reason="no Chromium: apt-get install chromium")
def test_a_vehicle_on_the_page(tmp_path: Path) -> None:
    text = mavlink.MAVLink_statustext_message(6, HOSTILE.encode())
    with (
        Bridge(record=tmp_path / "logs") as bridge,
        Inspector(bridge, "127.0.0.1", 0) as inspector,
    ):
        name = bridge.add("udpin:127.0.0.1:0", name="vehicles <b>")
        bridge.add("tcpin:127.0.0.1:0", name="stations")
        with (
            serve(f"udpout:127.0.0.1:{port_of(bridge, name)}", Vehicle()),
            browse(inspector.url, tmp_path / "profile") as page,
        ):
            for message in ("HEARTBEAT", "ATTITUDE", "GPS_RAW_INT"):
                page.wait_for(f"!!{ROW.format(message)}")
                page.run(f"{ROW.format(message)}.click()")
            page.wait_for("document.body.innerText.includes('MAV_TYPE_QUADROTOR')")
            page.wait_for(f"+{ROW.format('ATTITUDE')}.cells[2].textContent > 1")
            assert page.run("document.body.innerText.includes('rad/s')")
            for field in ("roll", "yaw"):
                number = (
                    f"[...{ROW.format('ATTITUDE')}.nextSibling.querySelectorAll('tr')]"
                    f".find(row => row.cells[0].textContent == '{field}').querySelector('.plottable')"
                )
                page.wait_for(f"!!{number}")
                page.run(f"{number}.click()")
            page.wait_for("Math.min(...[...series.values()].map(one => one.points.length)) > 10")
            assert page.run("byId('legend').textContent.includes('ATTITUDE.yaw (1/1)')")
            assert page.run("byId('links').textContent.includes('vehicles <b>')")
            assert page.run("!byId('recording').hidden")

            with udp_peer(bridge, name) as quiet:
                quiet.send(heartbeat(sysid=77))  # and no more: its counter stands still from now on
            page.wait_for("byId('components').textContent.includes('77/1')")

            bridge.send(pack(text, 0, 66))
            page.wait_for(f"!!{OURS}")
            page.run(f"{OURS}.click()")
            page.wait_for(f"document.body.innerText.includes({json.dumps(HOSTILE)})")
            assert page.run("document.title") == "mavwire bridge"
            assert page.run("document.querySelectorAll('img').length") == 0
            page.screenshot(Path(os.environ.get("MAVWIRE_SCREENSHOT", tmp_path / "page.png")))

            page.run("byId('filter').value = '66/1'; sift()")
            for n, one in enumerate(TEXTS, 1):
                bridge.send(pack(one, n, 66))
                page.wait_for(f"!!{ROW.format(one.get_type())}")
                if one.get_type() != "STATUSTEXT":  # which is open
                    page.run(f"{ROW.format(one.get_type())}.click()")
            shown = "[...document.querySelectorAll('.value')].map(one => one.textContent)"
            page.wait_for(
                f"['{LONG_NAME}', '{NOTICE}', 'nan', '{MOST}'].every(text => {shown}.includes(text))"
            )
            assert page.run(BROKEN) == 1, WHOLE
            page.run("document.querySelectorAll('.open').forEach(row => row.click())")
            page.run("byId('filter').value = ''; sift()")

            page.wait_for(f"!!{ROW.format('SYS_STATUS')}")
            page.run(f"{ROW.format('SYS_STATUS')}.click()")
            page.wait_for("document.body.innerText.includes('SENSOR_ANGULAR_RATE_CONTROL')")
            page.wait_for(f"!!{ROW.format('SYS_STATUS')}.nextSibling.querySelector('.plottable')")
            assert page.run(BROKEN) == 1, WHOLE
            widths = "[...document.querySelectorAll('section')].map(one => [one.scrollWidth, one.clientWidth])"
            for needed, given in page.run(widths):
                assert needed <= given, "no column is cut off, or runs into another"

            phone = {"width": 420, "height": 900, "deviceScaleFactor": 1, "mobile": False}
            page.call("Emulation.setDeviceMetricsOverride", **phone)
            assert page.run(BROKEN) == 1, WHOLE
            assert page.run("document.documentElement.scrollWidth <= innerWidth"), "it fits a phone"
            for needed, given in page.run(widths):
                assert needed <= given
            page.call("Emulation.clearDeviceMetricsOverride")
            page.run(f"{ROW.format('SYS_STATUS')}.click()")

            page.run("byId('filter').value = 'attitude 1/1, statustext 66/1'; sift()")
            shown = "[...document.querySelectorAll('.kind')].filter(row => !row.hidden).length"
            assert page.run(shown) == 2
            page.run("byId('pause').click()")
            state = "byId('state').textContent + series.values().next().value.points.length"
            before, start = page.run(state), bridge.stats()["uptime"]
            with bridge.frames() as batches:
                bridge.send(pack(mavlink.MAVLink_vibration_message(1, *[0] * 6), 9, 66))
                while bridge.stats()["uptime"] < start + 1.5:
                    assert batches.next() is not None
            assert page.run(state) == before
            page.run("byId('filter').value = ''; byId('pause').click()")
            page.wait_for(f"({state}) != {json.dumps(before)}")
            page.wait_for(f"!!{ROW.format('VIBRATION')}")
            page.wait_for("byId('state').textContent.startsWith('up for')")
            assert page.run(CLOCK_SET_BACK) == [[1000, 2]]
            assert page.run(CUTS) == [0, 0, 104, 0]
            assert page.run(RATES) == pytest.approx([1, 1, 1 / 1.7, 1 / 1.7, 0], abs=0.001)
            assert page.run(RESTS) == pytest.approx([50] * 10 + [0])
            assert page.run(BURSTS) < 1.5
            found, drawn, focused, in_the_middle, fills, *filtered = page.run(MANY)
            assert (found, focused, fills, filtered) == (4000, "kind", True, [1, 2, 0, 4000])
            assert drawn < 200 and in_the_middle < 300, "only what is in the window"
            assert page.run(FORGOTTEN) == [0, 0, 0, 0]
            assert min(page.run(HEIGHTS)) > 0.2, "metres leave room for radians"
            page.wait_for("byId('main').className == ''")
            bridge.stop()
            page.wait_for("byId('main').className == 'gone'")
            assert page.run("byId('state').textContent").startswith("no connection to the bridge")
