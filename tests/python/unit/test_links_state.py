"""The state that links share and keep: dialect switches, targets, caps, timeouts, modes."""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
import time
from unittest import mock

import pytest
from mavwire import mavutil
from mavwire.cli._reading import definitions
from mavwire.dialects import load
from mavwire.dialects.v20 import all as mavlink
from mavwire.links import state
from unit.link_tools import KEY, Capture, drain, drain_in_portions, heartbeat, pack, signed, types
from watchdog import watched

XML = """<mavlink><messages><message id="{msgid}" name="{name}">
<description/><field type="uint8_t" name="value">v</field></message></messages></mavlink>"""


@pytest.fixture(autouse=True)
def fresh_state(monkeypatch):
    # pymavlink, where a test has imported it, has set the latter.
    for name in ("MAVLINK20", "MAVLINK_DIALECT"):
        monkeypatch.delenv(name, raising=False)
    mavutil.set_wire_protocol(None)
    mavutil.set_dialect("all")
    yield
    mavutil.set_wire_protocol(None)
    mavutil.set_dialect("all")


def test_the_switch_to_v2_keeps_the_parser_s_state():
    link = Capture(source_system=7)
    link.setup_signing(KEY, initial_timestamp=5)
    old = link.mav
    old.seq = 9
    old.total_packets_sent = 4
    signing = old.signing
    environment = dict(os.environ)
    link.rx += signed(mavlink.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3), timestamp=50)
    msg = link.recv_msg()
    assert (msg.get_type(), msg.get_signed()) == ("HEARTBEAT", True)
    assert link.mav is not old
    assert link.mav.signing is signing
    assert (link.mav.seq, link.mav.total_packets_sent, link.mav.srcSystem) == (9, 4, 7)
    assert mavutil.mavlink.__name__.endswith("v20.all")
    assert dict(os.environ) == environment


def test_bytes_before_the_switch_are_not_lost():
    link = Capture()
    link.recv = lambda n=None: chunks.pop(0) if chunks else b""
    chunks = [b"\x00" + heartbeat(1), heartbeat(2), heartbeat(3)]
    assert types(drain(link)) == ["BAD_DATA", "HEARTBEAT", "HEARTBEAT", "HEARTBEAT"]
    assert link.WIRE_PROTOCOL_VERSION == "2.0"
    assert link.mav.total_bytes_received == 1 + 3 * 21


def test_set_wire_protocol():
    mavutil.set_wire_protocol("2.0")
    assert mavutil.mavlink20()
    mavutil.set_dialect("common")
    assert mavutil.mavlink.__name__.endswith("v20.common")
    mavutil.set_wire_protocol("1.0")
    assert (mavutil.mavlink20(), mavutil.mavlink.WIRE_PROTOCOL_VERSION) == (False, "1.0")
    with pytest.raises(ValueError, match="wire protocol"):
        mavutil.set_wire_protocol("3")


def test_a_wire_protocol_that_was_chosen_is_spoken_and_signed():
    """A program that speaks first: nothing that it hears says which protocol is meant."""
    mavutil.set_wire_protocol("2.0")
    link = Capture()
    link.setup_signing(KEY)
    link.mav.heartbeat_send(6, 8, 0, 0, 0)
    assert (link.tx[0], link.tx[2] & 1) == (0xFD, 1)
    mavutil.set_wire_protocol("1.0")
    assert Capture().WIRE_PROTOCOL_VERSION == "1.0"
    assert link.WIRE_PROTOCOL_VERSION == "2.0"


def test_a_wire_protocol_that_the_dialect_cannot_follow_is_not_taken(tmp_path):
    path = tmp_path / "own.xml"
    path.write_text(XML.format(msgid=200, name="OWN"))
    mavutil.set_dialect(str(path))
    path.unlink()
    with pytest.raises(FileNotFoundError):
        mavutil.set_wire_protocol("2.0")
    assert (mavutil.mavlink20(), mavutil.mavlink.WIRE_PROTOCOL_VERSION) == (False, "1.0")


def test_mavlink20_follows_the_environment(monkeypatch):
    monkeypatch.setenv("MAVLINK20", "")
    assert mavutil.mavlink20()
    mavutil.set_dialect("all")
    assert mavutil.mavlink.WIRE_PROTOCOL_VERSION == "2.0"


def test_dialect_from_xml_and_from_mdef(tmp_path, monkeypatch):
    mavutil.set_wire_protocol("2.0")
    path = tmp_path / "own.xml"
    path.write_text(XML.format(msgid=300, name="OWN"))
    mavutil.set_dialect(str(path))
    assert mavutil.mavlink.MAVLink_own_message(5).value == 5
    (tmp_path / "v1.0").mkdir()
    (tmp_path / "v1.0" / "mine.xml").write_text(XML.format(msgid=301, name="MINE"))
    monkeypatch.setenv("MDEF", str(tmp_path))
    mavutil.set_dialect("mine")
    assert mavutil.mavlink.MAVLINK_MSG_ID_MINE == 301
    link = Capture()  # works without HEARTBEAT, GPS_RAW_INT and the MAV_TYPE enum
    assert "HOME" not in link.messages
    with pytest.raises(FileNotFoundError, match=r"v1.0/none\.xml"):
        mavutil.set_dialect("none")


def test_process_state_can_be_assigned():
    marker = object()
    saved = mavutil.mavlink
    mavutil.mavfile_global = marker
    mavutil.global_link_id = 7
    mavutil.mavlink = mavlink
    try:
        link = Capture(input=False)
        assert isinstance(link.mav, mavlink.MAVLink)
        link.setup_signing(KEY)
        assert (link.mav.signing.link_id, mavutil.global_link_id) == (7, 8)
        assert mavutil.mavfile_global is marker
    finally:
        mavutil.mavlink, mavutil.mavfile_global, mavutil.global_link_id = saved, None, 0


@pytest.mark.parametrize("key", [b"", b"short", bytes(33)])
def test_signing_keys_of_other_lengths_are_refused(key):
    """R31."""
    with pytest.raises(ValueError, match="32 bytes"):
        Capture().setup_signing(key)


def test_tables_keyed_by_the_peer_are_capped():
    """R68."""
    of_system, shared, params = 512, 4_096, 16_384
    link = Capture()
    for i in range(of_system + shared + 10):
        name = f"n{i}".encode()
        link.rx += pack(mavlink.MAVLink_named_value_float_message(1, name, i))
    for i in range(params + 10):
        link.rx += pack(mavlink.MAVLink_param_value_message(b"n%d" % i, i, 9, 1, 0))
    for msgid in range(of_system + 10):
        frame = bytearray(heartbeat())
        frame[7:10] = (900_000 + msgid).to_bytes(3, "little")
        link.rx += frame
    link.rx += pack(mavlink.MAVLink_param_value_message(b"n1", 99, 9, 1, 0))
    link.rx += pack(mavlink.MAVLink_named_value_float_message(1, b"n7", 0.5))
    drain_in_portions(link)
    kept = link.sysid_state[1].messages
    assert sum(key.startswith("NAMED_VALUE_FLOAT[") for key in kept) == of_system + shared
    assert (kept["NAMED_VALUE_FLOAT"].value, kept["NAMED_VALUE_FLOAT[n7]"].value) == (0.5, 0.5)
    assert len(link.sysid_state[0].messages) == of_system
    kept = link.param_state[(1, 1)].params
    assert (len(kept), kept["n1"], kept[f"n{params - 1}"]) == (params, 99, params - 1)


def test_target_component_follows_the_locked_system():
    link = Capture()
    link.rx += heartbeat(sysid=3) + pack(
        mavlink.MAVLink_param_value_message(b"P", 1.5, 9, 1, 0), sysid=3
    )
    drain(link)
    link.target_component = 1
    assert (link.param_sysid, link.params, link.param("P")) == ((3, 1), {"P": 1.5}, 1.5)
    link.target_component = 0
    assert link.params == {"P": 1.5}


def test_a_fixed_target_stays():
    link = Capture()
    link.target_system = 9
    link.rx += heartbeat(sysid=3)
    drain(link)
    assert (link.target_system, sorted(link.sysid_state)) == (9, [0, 3, 9])


def test_vehicles_and_components_on_one_link_do_not_mix():
    link = Capture()
    copter = mavlink.MAVLink_heartbeat_message(2, 12, 81 | 128, 0x20000, 4, 3)
    plane = mavlink.MAVLink_heartbeat_message(1, 3, 1, 11, 4, 3)
    camera = mavlink.MAVLink_heartbeat_message(30, 8, 0, 0, 4, 3)
    battery = [
        mavlink.MAVLink_battery_status_message(i, 0, 0, 0, [i] * 10, 0, 0, 0, i) for i in (0, 1)
    ]
    link.rx += pack(copter, sysid=7, compid=1) + pack(battery[0], sysid=7, compid=1)
    assert types(drain(link)) == ["HEARTBEAT", "BATTERY_STATUS"]
    assert link.sysid_state[7].components.keys() == {1}
    assert link.messages_of(7, 1)["HEARTBEAT"] is link.messages["HEARTBEAT"]
    link.rx += pack(camera, sysid=7, compid=100) + pack(battery[1], sysid=7, compid=100)
    link.rx += pack(plane, sysid=8) + pack(battery[0], seq=1, sysid=7, compid=1)
    drain(link)
    assert (link.target_system, link.flightmode, link.motors_armed()) == (7, "ALTCTL", 128)
    assert link.sysid_state[8].flightmode == "RTL"
    assert not link.sysid_state[8].armed
    assert link.messages["HEARTBEAT"].type == 30
    assert [link.messages_of(7, compid)["HEARTBEAT"].type for compid in (1, 100)] == [2, 30]
    assert link.messages_of(7, 1)["BATTERY_STATUS"].id == 0
    assert link.messages_of(7, 100)["BATTERY_STATUS"][1].current_consumed == 0
    assert "BATTERY_STATUS[1]" not in link.messages_of(7, 1)
    assert (link.messages_of(8)["HEARTBEAT"].type, link.messages_of(8, 1)["HEARTBEAT"].type) == (
        1,
        1,
    )
    assert (link.messages_of(9), link.messages_of(8, 2)) == ({}, {})
    link.tx.clear()
    link.set_mode("MANUAL")  # by PX4's numbers, although the camera was heard last
    command = mavlink.MAVLink(None).parse_buffer(bytes(link.tx))[0]
    assert (command.param1, command.param2) == (81, 1)


def receive(link, *frames):
    link.rx += b"".join(frames)
    return drain(link)


def servo(first, port=0, seq=0):
    values = [first] * 8
    return pack(mavlink.MAVLink_servo_output_raw_message(1, port, *values), seq)


def test_a_dictionary_of_messages_that_a_program_keeps_is_current():
    link = Capture()
    receive(link, heartbeat(1))
    kept = link.messages
    (second,) = receive(link, heartbeat(2))
    assert kept["HEARTBEAT"] is second
    kept.pop("HEARTBEAT")
    (third,) = receive(link, heartbeat(3))
    assert kept["HEARTBEAT"] is third


def test_a_dictionary_of_messages_that_nobody_keeps_is_current_when_it_is_looked_at():
    link = Capture()
    attitude = pack(mavlink.MAVLink_attitude_message(1, 0, 0, 0, 0, 0, 0))
    received = receive(link, heartbeat(1), attitude, heartbeat(2), servo(1), servo(2, seq=1))
    assert list(link.messages) == [
        "MAV", "HOME", "HEARTBEAT", "ATTITUDE", "SERVO_OUTPUT_RAW", "SERVO_OUTPUT_RAW[0]",
    ]  # fmt: skip
    assert link.messages["HEARTBEAT"] is received[2]
    assert link.messages["SERVO_OUTPUT_RAW"][0] is received[4]
    del link.messages["ATTITUDE"]
    receive(link, heartbeat(3))
    assert "ATTITUDE" not in link.messages
    (renewed,) = receive(link, attitude)
    assert link.messages["ATTITUDE"] is renewed


def test_a_dictionary_of_messages_that_a_program_sets_has_later_messages_alone():
    link = Capture()
    receive(link, heartbeat(1), servo(1), servo(2))
    link.sysid_state[1].messages = {}
    assert link.messages == {}
    receive(link, servo(3), servo(4, port=1))
    assert list(link.messages) == [f"SERVO_OUTPUT_RAW{n}" for n in ("", "[0]", "[1]")]
    assert [link.messages["SERVO_OUTPUT_RAW"][port].servo1_raw for port in (0, 1)] == [3, 4]


def test_conditions_are_about_the_messages_at_that_moment():
    link = Capture()
    for number in range(5):
        link.rx += servo(number, seq=number)
    msg = link.recv_match(condition="SERVO_OUTPUT_RAW.servo1_raw == 3")
    assert msg.servo1_raw == 3


def test_a_mode_that_px4_does_not_have_is_unknown_to_set_mode_px4(capsys):
    link = Capture()
    link.rx += heartbeat()
    drain(link)
    link.set_mode_px4("STABILIZE", 0, 0)
    assert (capsys.readouterr().out, link.tx) == ("Unknown mode 'STABILIZE'\n", b"")


def test_timeouts():
    link = Capture()
    started = time.monotonic()
    with watched():
        assert link.recv_match(blocking=True, timeout=0.12) is None
    assert time.monotonic() - started >= 0.1
    link.rx += heartbeat()
    assert link.recv_match(blocking=True, timeout=0).get_type() == "HEARTBEAT"


def test_a_flood_of_other_messages_does_not_outrun_the_timeout():
    link = Capture()
    frame = heartbeat()
    link.recv = lambda n=None: frame
    with watched():
        assert link.recv_match(type="ATTITUDE", blocking=True, timeout=0.2) is None


def test_waypoint_current_and_location():
    link = Capture()
    link.rx += heartbeat() + pack(mavlink.MAVLink_mission_current_message(5))
    assert link.waypoint_current() == 5
    hud = pack(mavlink.MAVLink_vfr_hud_message(1, 2, 77, 3, 4, 5))
    no_fix = pack(mavlink.MAVLink_gps_raw_int_message(1, 2, 9, 9, 0, 0, 0, 0, 0, 0))
    fix = pack(mavlink.MAVLink_gps_raw_int_message(2, 3, 10_000_000, -20, 30, 0, 0, 0, 0, 0))
    position = pack(mavlink.MAVLink_global_position_int_message(1, 1, 2, 3, 7000, 0, 0, 0, 0))
    link.rx += hud + no_fix + fix + hud + position
    place = link.location(relative_alt=True)
    assert (place.lat, place.lng, place.alt, place.heading) == pytest.approx((1.0, -2e-6, 7.0, 77))


def test_a_position_without_a_home_is_received():
    link = Capture()
    link.rx += heartbeat()
    drain(link)
    link.messages.pop("HOME")
    link.rx += pack(mavlink.MAVLink_gps_raw_int_message(1, 3, 9, 9, 0, 0, 0, 0, 0, 0))
    assert types(drain(link)) == ["GPS_RAW_INT"]
    assert "HOME" not in link.messages


@pytest.mark.parametrize(
    ("text", "plane_auto"),
    [(json.dumps({"1": {"5": "OWN"}}), {"OWN": 5}), ("{broken", None), ("[]", None)],
)
def test_custom_mode_map(tmp_path, text, plane_auto):
    (tmp_path / ".pymavlink").mkdir()
    (tmp_path / ".pymavlink" / "custom_mode_map.json").write_text(text)
    code = "import mavwire.mavutil as m; print(m.mode_mapping_byname(1))"
    environment = {**os.environ, "HOME": str(tmp_path), "PYTHONPATH": os.pathsep.join(sys.path)}
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True
    )
    expected = plane_auto or mavutil.mode_mapping_byname(1)
    assert done.stdout.strip() == str(expected)
    assert ("ignoring" in done.stderr) == (plane_auto is None)


@pytest.mark.parametrize(
    ("module", "heavy"),
    [
        (
            "mavwire.mavutil",
            "socket ssl select subprocess json re logging mmap threading functools collections"
            " dataclasses platform fnmatch curses serial wsproto numpy",
        ),
        ("mavwire.dialects.v20.common", "collections functools threading pathlib tomllib"),
        ("mavwire.bridge", "asyncio threading subprocess"),
        ("mavwire.plots.series", "mavwire.plots.charts tempfile html"),
        ("mavwire.fleet.decoding", "mavwire.fleet.running asyncio"),
    ],
)
def test_a_module_loads_only_what_it_needs(module, heavy):
    code = f"import sys, {module}; print(*set({heavy.split()}) & set(sys.modules))"
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    done = subprocess.run(
        [sys.executable, "-S", "-c", code],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout.strip()) == (0, ""), done.stderr


def run(code, **variables):
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), **variables}
    command = [sys.executable, "-c", f"import sys, os; from mavwire import mavutil; {code}"]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout.split()


LOADED = "print(*[m for m in sys.modules if m.startswith(('mavwire.dialects.v10.', 'mavwire.dialects.v20.'))])"


def test_the_dialect_loads_when_it_is_asked_for():
    assert run(LOADED) == []
    assert run(f"mavutil.mavlink; {LOADED}") == ["mavwire.dialects.v10.all"]
    assert run(f"mavutil.set_wire_protocol('2.0'); {LOADED}") == []
    assert run(f"mavutil.set_wire_protocol('2.0'); mavutil.mavlink; {LOADED}") == [
        "mavwire.dialects.v20.all"
    ]
    assert run(f"mavutil.set_dialect('common'); {LOADED}") == ["mavwire.dialects.v10.common"]
    assert run(LOADED, MAVLINK_DIALECT="common") == []
    assert run("print(mavutil.mavlink.DIALECT)", MAVLINK_DIALECT="common") == ["common"]


def test_the_wire_protocol_of_a_dialect_is_that_of_its_choice():
    """The environment counts when mavutil is imported, and when a dialect is set."""
    later = "os.environ['MAVLINK20'] = '1'; print(mavutil.mavlink.WIRE_PROTOCOL_VERSION)"
    assert run(later) == ["1.0"]
    assert run("print(mavutil.mavlink.WIRE_PROTOCOL_VERSION)", MAVLINK20="1") == ["2.0"]


def test_a_module_takes_the_place_of_a_dialect_nobody_asked_for():
    code = "import mavwire.dialects.v20.common as c; mavutil.mavlink = c; mavutil.set_wire_protocol('2.0');"
    assert run(f"{code} print(mavutil.mavlink is c, mavutil.current_dialect)") == ["True", "all"]


def test_a_dialect_that_is_unknown_is_told_at_once():
    code = "import mavwire.mavutil"
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join(sys.path),
        "MAVLINK_DIALECT": "nonsense",
    }
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=False
    )
    assert "no dialect 'nonsense'" in done.stderr


def test_the_current_dialect_is_reached_through_the_package():
    """As where it was imported with mavutil."""
    code = "import mavwire; print(mavwire.dialects.v10.all is mavutil.mavlink)"
    assert run(code) == ["True"]
    assert run("import mavwire; print(hasattr(mavwire.dialects.v20, 'nothing'))") == ["False"]


def test_definitions_leave_a_dialect_that_nobody_asked_for_as_it_was():
    code = (
        "from mavwire.cli._reading import definitions\n"
        "with definitions('common', '2.0'): print(mavutil.mavlink.DIALECT, mavutil.current_dialect)\n"
        f"{LOADED}; print(mavutil.mavlink.WIRE_PROTOCOL_VERSION, mavutil.current_dialect)"
    )
    assert run(code) == ["common", "common", "mavwire.dialects.v20.common", "1.0", "all"]


def test_a_module_as_dialect(tmp_path):
    path, log = tmp_path / "own.xml", tmp_path / "t.tlog"
    path.write_text(XML.format(msgid=300, name="OWN"))
    module = load(path)
    frame = module.MAVLink_own_message(5).pack(module.MAVLink(None))
    log.write_bytes(bytes(8) + frame)
    link = mavutil.mavlink_connection(str(log), dialect=module)
    assert link.recv_match(type="OWN").value == 5
    assert (mavutil.mavlink, mavutil.current_dialect) == (module, "own")
    mavutil.set_wire_protocol("2.0")
    assert mavutil.mavlink is module
    with definitions():
        assert mavutil.mavlink is module
    with definitions("common"):
        assert mavutil.mavlink is not module
    assert mavutil.mavlink is module
    mavutil.set_dialect("common")
    state.renew_dialect()
    assert mavutil.mavlink.DIALECT == "common"


@pytest.mark.parametrize("wrong", [3, b"common", [3], [], math])
def test_what_is_no_dialect(wrong):
    with pytest.raises(
        TypeError, match="a name, a path to XML, a dialect module or a list of these, not "
    ):
        mavutil.mavlink_connection("udpin:127.0.0.1:0", dialect=wrong)


def test_a_dialect_that_nobody_defines(monkeypatch):
    monkeypatch.delenv("MDEF", raising=False)
    known = "name a built-in one, one in $MDEF/v1.0, or a path to XML; "
    for name, hint in (("comon", "did you mean 'common'?"), ("nope", "built in are ASLUAV, ")):
        with pytest.raises(FileNotFoundError) as caught:
            mavutil.mavlink_connection("udpin:127.0.0.1:0", dialect=name)
        assert str(caught.value).startswith(f"[Errno 2] no dialect {name!r}; {known}{hint}")
    with pytest.raises(FileNotFoundError, match="the name is empty"):
        load("")


@pytest.mark.parametrize("name", [mavutil.mode_string_acm, mavutil.mode_string_apm])
def test_a_mode_that_is_no_number(name):
    assert (name(5.5), name(250)) == ("Mode(5)", "Mode(250)")
    for wrong in (None, "x"):
        with pytest.raises(TypeError, match="%u format: a real number is required"):
            name(wrong)


def fix(sysid, lat, heading):
    """What `location` waits for, from a vehicle."""
    hud = mavlink.MAVLink_vfr_hud_message(1, 1, heading, 0, 50, 0)
    gps = mavlink.MAVLink_gps_raw_int_message(0, 3, lat, 5, 5, 0, 0, 0, 0, 0)
    position = mavlink.MAVLink_global_position_int_message(0, 0, 0, 0, 7000, 0, 0, 0, 0)
    return b"".join(pack(msg, sysid=sysid) for msg in (hud, gps, hud, position))


def test_helpers_that_wait_do_so_for_the_target_s_messages():
    link = Capture()
    link.rx += heartbeat()
    drain(link)
    assert link.target_system == 1
    for sysid, seq in ((2, 42), (1, 3)):
        link.rx += pack(mavlink.MAVLink_mission_current_message(seq), sysid=sysid)
    with watched():
        assert link.waypoint_current() == 3
        link.rx += fix(2, 20, 90) + fix(1, 10_000_000, 45)
        place = link.location(relative_alt=True)
        assert (place.lat, place.alt, place.heading) == (1.0, 7.0, 45)


def test_helpers_that_wait_take_anyone_while_there_is_no_target():
    link = Capture()
    link.rx += pack(mavlink.MAVLink_mission_current_message(42), sysid=2)
    with watched():
        assert link.waypoint_current() == 42


@pytest.mark.parametrize("name", ["mavlink", "current_dialect", "mavfile_global", "global_link_id"])
def test_what_a_mock_replaces_is_put_back(name):
    before = getattr(mavutil, name)
    with mock.patch(f"mavwire.mavutil.{name}") as replaced:
        assert getattr(mavutil, name) is getattr(state, name) is replaced
    assert getattr(mavutil, name) is getattr(state, name) is before
