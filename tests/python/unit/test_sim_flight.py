"""How the simulated copter flies: take-off, targets, mission, return, landing, and physics that agree
with themselves.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import pytest
from mavwire.dialects.v20 import all as mavlink
from mavwire.sim import Vehicle
from mavwire.sim.geo import Local, distance, e7
from unit.sim_tools import NAN, Station, flying, mission_item, ready, upload

AUTOPILOTS = ["ardupilot", "px4"]
ARM = mavlink.MAV_CMD_COMPONENT_ARM_DISARM
SET_MODE = mavlink.MAV_CMD_DO_SET_MODE
ACCEPTED = mavlink.MAV_RESULT_ACCEPTED
REFUSED = {
    "ardupilot": mavlink.MAV_RESULT_FAILED,
    "px4": mavlink.MAV_RESULT_TEMPORARILY_REJECTED,
}
GUIDED = (1, 4)
POSITION = 0b110111111000
VELOCITY = 0b110111000111
VELOCITY_KEEPING_HEIGHT = 0b110111100011


def local_target(mask: int, **values: float) -> Any:
    """SET_POSITION_TARGET_LOCAL_NED."""
    names = ("x", "y", "z", "vx", "vy", "vz", "afx", "afy", "afz", "yaw", "yaw_rate")
    frame = int(values.pop("frame", mavlink.MAV_FRAME_LOCAL_NED))
    return mavlink.MAVLink_set_position_target_local_ned_message(
        0, 1, 1, frame, mask, *[values.get(name, 0.0) for name in names]
    )


def offboard(station: Station, message: Any) -> None:
    """Send a target; a PX4 wants targets before it takes the mode."""
    station.send(message)
    if station.vehicle.personality.name == "px4":  # type: ignore[union-attr]
        assert station.command(SET_MODE, 1, 6) == ACCEPTED


@pytest.mark.parametrize("autopilot", AUTOPILOTS)
def test_take_off_climbs_straight_to_the_height(autopilot: str) -> None:
    vehicle, station = flying(autopilot, height=12)
    station.step(5)
    assert vehicle.height == pytest.approx(12, abs=0.1)
    assert math.hypot(vehicle.copter.north, vehicle.copter.east) < 0.1
    heights = [msg.relative_alt / 1e3 for msg in station.of("GLOBAL_POSITION_INT")]
    assert max(heights) < 12.3
    assert station.last("HEARTBEAT").system_status == mavlink.MAV_STATE_ACTIVE
    assert station.last("HEARTBEAT").base_mode & mavlink.MAV_MODE_FLAG_SAFETY_ARMED


def test_px4_takes_off_to_its_parameter_by_set_mode() -> None:
    vehicle, station = ready("px4", params={"MIS_TAKEOFF_ALT": 6})
    assert station.command(ARM, 1) == ACCEPTED
    station.send(mavlink.MAVLink_set_mode_message(1, 129, 0x2040000))
    assert vehicle.mode == "TAKEOFF"
    station.until(lambda: vehicle.mode == "LOITER")
    station.step(3)
    assert vehicle.height == pytest.approx(6, abs=0.2)
    station.send(mavlink.MAVLink_set_mode_message(1, 129, 0x6040000))
    assert vehicle.mode == "LAND"
    station.until(lambda: not vehicle.armed)
    assert vehicle.mode == "LOITER"


def test_ardupilot_takes_off_in_guided_mode_only() -> None:
    vehicle, station = ready("ardupilot")
    assert station.command(ARM, 1) == ACCEPTED
    assert (
        station.command(mavlink.MAV_CMD_NAV_TAKEOFF, 0, 0, 0, 0, 0, 0, 10) == REFUSED["ardupilot"]
    )
    assert "Takeoff: only in GUIDED mode" in station.texts()
    assert station.command(SET_MODE, *GUIDED) == ACCEPTED
    assert station.command(mavlink.MAV_CMD_NAV_TAKEOFF, 0, 0, 0, 0, 0, 0, 10) == ACCEPTED
    assert station.command(mavlink.MAV_CMD_NAV_LAND) == ACCEPTED
    assert vehicle.mode == "LAND"


@pytest.mark.parametrize("autopilot", AUTOPILOTS)
def test_position_targets_are_flown_to(autopilot: str) -> None:
    vehicle, station = flying(autopilot)
    offboard(station, local_target(POSITION, x=30, y=-20, z=-15))
    for _ in range(200):
        station.send(local_target(POSITION, x=30, y=-20, z=-15), dt=0.1)
    assert distance(vehicle.copter.local, Local(30, -20, 15)) < 0.3
    assert vehicle.copter.up == pytest.approx(15, abs=0.2)
    assert math.degrees(vehicle.copter.yaw) == pytest.approx(-33.7, abs=5)


@pytest.mark.parametrize("autopilot", AUTOPILOTS)
def test_global_targets_are_flown_to(autopilot: str) -> None:
    vehicle, station = flying(autopilot)
    place = vehicle.copter.origin.globe(Local(-25, 10, 0))
    target = mavlink.MAVLink_set_position_target_global_int_message(
        0, 1, 1, mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT, POSITION, e7(place.lat), e7(place.lon),
        8.0, 0, 0, 0, 0, 0, 0, 0, 0,
    )  # fmt: skip
    offboard(station, target)
    for _ in range(150):
        station.send(target, dt=0.1)
    assert distance(vehicle.copter.local, Local(-25, 10, 8)) < 0.3
    assert vehicle.height == pytest.approx(8, abs=0.2)


def test_velocities_are_flown_and_run_out() -> None:
    vehicle, station = flying("ardupilot")
    station.send(local_target(VELOCITY, vx=3, vy=1, vz=-0.5), dt=2.5)
    assert (vehicle.copter.vn, vehicle.copter.ve) == pytest.approx((3, 1), abs=0.3)
    assert vehicle.copter.climb == pytest.approx(0.5, abs=0.1)
    station.step(5)
    assert vehicle.copter.groundspeed < 0.1


def test_velocity_in_the_body_frame_turns_with_the_vehicle() -> None:
    vehicle, station = flying("ardupilot", heading=90)
    forward = local_target(VELOCITY_KEEPING_HEIGHT, vx=2, frame=mavlink.MAV_FRAME_BODY_OFFSET_NED)
    station.send(forward, dt=2.5)
    assert (vehicle.copter.vn, vehicle.copter.ve) == pytest.approx((0, 2), abs=0.2)


def test_targets_count_in_their_mode_only() -> None:
    vehicle, station = flying("px4")
    station.send(local_target(POSITION, x=50, y=0, z=-10), dt=5)
    assert vehicle.copter.north < 0.5
    vehicle, station = flying("ardupilot")
    assert station.command(SET_MODE, 1, 5) == ACCEPTED
    station.send(local_target(POSITION, x=50, y=0, z=-10), dt=5)
    assert vehicle.copter.north < 0.5


def test_px4_offboard_needs_a_stream_of_targets() -> None:
    vehicle, station = flying("px4")
    assert station.command(SET_MODE, 1, 6) == REFUSED["px4"]
    offboard(station, local_target(POSITION, x=50, z=-10))
    station.step(3)
    assert vehicle.mode == "LOITER"
    assert "Offboard control lost" in station.texts()


@pytest.mark.parametrize("autopilot", AUTOPILOTS)
def test_reposition_flies_there(autopilot: str) -> None:
    vehicle, station = flying(autopilot)
    place = vehicle.copter.origin.globe(Local(15, 15, 0))
    msg = mavlink.MAVLink_command_int_message(
        1, 1, mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT, mavlink.MAV_CMD_DO_REPOSITION, 0, 0, -1, 1, 0,
        NAN, e7(place.lat), e7(place.lon), 14.0,
    )  # fmt: skip
    (ack,) = [m for m in station.send(msg) if m.get_type() == "COMMAND_ACK"]
    assert ack.result == ACCEPTED
    station.step(15)
    assert distance(vehicle.copter.local, Local(15, 15, 14)) < 0.3
    assert vehicle.height == pytest.approx(14, abs=0.2)


def test_orbit_keeps_its_radius_and_looks_inwards() -> None:
    vehicle, station = flying("px4")
    centre = vehicle.place
    params = (12, 3, 0, 0, centre.lat, centre.lon, centre.alt)
    assert station.command(mavlink.MAV_CMD_DO_ORBIT, *params) == ACCEPTED
    station.step(25)
    radii = []
    for _ in range(250):
        station.step(0.1)
        radii.append(math.hypot(vehicle.copter.north, vehicle.copter.east))
    assert min(radii) > 11
    assert max(radii) < 13
    towards = math.atan2(-vehicle.copter.east, -vehicle.copter.north)
    assert abs(math.remainder(towards - vehicle.copter.yaw, math.tau)) < 0.3


def test_sticks_move_it_and_let_go_of_it_stays() -> None:
    vehicle, station = flying("px4")
    assert station.command(SET_MODE, 1, 3) == ACCEPTED
    for _ in range(30):
        station.send(mavlink.MAVLink_manual_control_message(1, 500, 0, 500, 0, 0), dt=0.1)
    assert vehicle.copter.vn > 1.5
    station.step(8)
    assert vehicle.copter.groundspeed < 0.1
    height = vehicle.height
    for _ in range(20):
        station.send(mavlink.MAVLink_manual_control_message(1, 0, 0, 1000, 500, 0), dt=0.1)
    assert vehicle.height > height + 2
    assert vehicle.copter.yaw > 0.5


def test_overridden_channels_are_sticks_and_are_shown() -> None:
    vehicle, station = flying("ardupilot")
    assert station.command(SET_MODE, 1, 5) == ACCEPTED
    channels = (1500, 1300, 1500, 1500, 0, 0, 0, 0)
    for _ in range(20):
        station.send(mavlink.MAVLink_rc_channels_override_message(1, 1, *channels), dt=0.1)
    assert vehicle.copter.vn > 1
    assert station.last("RC_CHANNELS").chan2_raw == 1300
    station.send(mavlink.MAVLink_rc_channels_override_message(1, 1, *[0] * 8), dt=2)
    assert station.last("RC_CHANNELS").chan2_raw == 1500


# -- coming home


@pytest.mark.parametrize("autopilot", AUTOPILOTS)
def test_return_climbs_comes_back_lands_and_disarms(autopilot: str) -> None:
    vehicle, station = flying(autopilot, params=None)
    assert station.command(mavlink.MAV_CMD_DO_CHANGE_SPEED, 1, 6) == ACCEPTED
    vehicle.autopilot.go_to(Local(40, 10, 10))
    station.step(15)
    assert station.command(mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH) == ACCEPTED
    assert vehicle.mode == "RTL"
    highest = 0.0
    while vehicle.armed:
        station.step(0.2)
        highest = max(highest, vehicle.height)
        assert vehicle.time < 200
    assert highest == pytest.approx(vehicle.tuning.return_height, abs=0.5)
    assert math.hypot(vehicle.copter.north, vehicle.copter.east) < 0.5
    assert vehicle.landed
    assert station.last("HEARTBEAT").base_mode & mavlink.MAV_MODE_FLAG_SAFETY_ARMED == 0
    states = [msg.landed_state for msg in station.of("EXTENDED_SYS_STATE")]
    if autopilot == "px4":
        assert [states[0], *(b for a, b in pairwise(states) if a != b)] == [1, 3, 2, 4, 1]


def test_landing_is_slow_near_the_ground() -> None:
    vehicle, station = flying("ardupilot", height=20)
    assert station.command(mavlink.MAV_CMD_NAV_LAND) == ACCEPTED
    slowest = []
    while not vehicle.landed:
        station.step(0.1)
        if vehicle.height < 5:
            slowest.append(vehicle.copter.climb)
    assert min(slowest[:-1]) > -0.7
    station.until(lambda: not vehicle.armed, limit=5)


# -- arming


@pytest.mark.parametrize("autopilot", AUTOPILOTS)
def test_it_does_not_arm_before_it_knows_where_it_is(autopilot: str) -> None:
    vehicle = Vehicle(autopilot)
    station = Station(vehicle)
    station.step(0.5)
    assert station.command(ARM, 1) == REFUSED[autopilot]
    assert not vehicle.armed
    assert station.texts()
    assert station.command(ARM, 1, 21196) == ACCEPTED
    assert vehicle.armed


def test_health_and_prearm_follow_the_position() -> None:
    prearm = mavlink.MAV_SYS_STATUS_PREARM_CHECK
    vehicle = Vehicle()
    station = Station(vehicle)
    station.step(1)
    early = station.last("SYS_STATUS")
    assert not early.onboard_control_sensors_health & (prearm | mavlink.MAV_SYS_STATUS_SENSOR_GPS)
    assert early.onboard_control_sensors_health & mavlink.MAV_SYS_STATUS_GEOFENCE
    assert station.last("EKF_STATUS_REPORT").flags & mavlink.EKF_CONST_POS_MODE
    assert station.last("GPS_RAW_INT").fix_type < 3
    station.step(4)
    late = station.last("SYS_STATUS")
    assert late.onboard_control_sensors_health & prearm
    assert station.last("EKF_STATUS_REPORT").flags & mavlink.EKF_POS_HORIZ_ABS
    assert station.last("GPS_RAW_INT").fix_type == 3


def test_checks_can_be_switched_off_on_ardupilot() -> None:
    station = Station(Vehicle(params={"ARMING_CHECK": 0}))
    assert station.command(ARM, 1) == ACCEPTED


def test_ardupilot_does_not_arm_in_modes_that_fly_by_themselves() -> None:
    vehicle, station = ready("ardupilot")
    assert station.command(SET_MODE, 1, 6) == ACCEPTED
    assert station.command(ARM, 1) == REFUSED["ardupilot"]
    assert "Arm: RTL mode not armable" in station.texts()
    assert not vehicle.armed


@pytest.mark.parametrize("autopilot", AUTOPILOTS)
def test_motors_do_not_stop_in_the_air_unless_forced(autopilot: str) -> None:
    vehicle, station = flying(autopilot)
    assert station.command(ARM, 0) == REFUSED[autopilot]
    assert vehicle.armed
    assert station.command(ARM, 0, 21196) == ACCEPTED
    station.until(lambda: vehicle.landed, limit=5)


@pytest.mark.parametrize("autopilot", AUTOPILOTS)
def test_motors_stop_by_themselves_on_the_ground(autopilot: str) -> None:
    vehicle, station = ready(autopilot)
    assert station.command(ARM, 1) == ACCEPTED
    assert station.until(lambda: not vehicle.armed) == pytest.approx(10, abs=0.3)


@pytest.mark.parametrize("autopilot", AUTOPILOTS)
def test_modes_that_need_a_position_wait_for_it(autopilot: str) -> None:
    vehicle = Vehicle(autopilot)
    station = Station(vehicle)
    number = (1, 4) if autopilot == "ardupilot" else (1, 4, 5)
    assert station.command(SET_MODE, *number) == REFUSED[autopilot]
    station.step(5)
    assert station.command(SET_MODE, *number) == ACCEPTED


def test_termination_drops_it() -> None:
    vehicle, station = flying("px4", height=30)
    assert station.command(mavlink.MAV_CMD_DO_FLIGHTTERMINATION, 1) == ACCEPTED
    assert station.until(lambda: vehicle.landed) < 4
    assert station.last("HEARTBEAT").system_status == mavlink.MAV_STATE_FLIGHT_TERMINATION


# -- battery


def test_the_battery_drains_and_brings_it_home() -> None:
    vehicle, station = flying("ardupilot", params={"BATT_CAPACITY": 400, "BATT_LOW_MAH": 100})
    volts = vehicle.battery.voltage
    station.until(lambda: vehicle.mode == "RTL", limit=300)
    assert vehicle.battery.remaining == pytest.approx(25, abs=1)
    assert vehicle.battery.voltage < volts
    assert any(text.startswith("Battery 1 is low") for text in station.texts())
    assert station.last("SYS_STATUS").battery_remaining <= 26
    station.until(lambda: not vehicle.armed)


# -- missions


def route(vehicle: Vehicle) -> list[Any]:
    """Take-off, three waypoints, home; ArduPilot has its home in front."""
    place = [vehicle.copter.origin.globe(Local(*at, 0)) for at in ((20, 0), (20, 20), (0, 20))]
    items = [mission_item(0, mavlink.MAV_CMD_NAV_WAYPOINT)] if vehicle.mode == "STABILIZE" else []
    items.append(mission_item(len(items), mavlink.MAV_CMD_NAV_TAKEOFF, z=10))
    for at in place:
        fields = {"x": e7(at.lat), "y": e7(at.lon), "z": 10, "param1": 1}
        items.append(mission_item(len(items), mavlink.MAV_CMD_NAV_WAYPOINT, **fields))
    items.append(mission_item(len(items), mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH))
    return items


@pytest.mark.parametrize("autopilot", AUTOPILOTS)
def test_a_mission_is_flown_from_take_off_to_landing(autopilot: str) -> None:
    vehicle, station = ready(autopilot)
    first = vehicle.personality.first_mission_item
    items = route(vehicle)
    assert upload(station, items) == mavlink.MAV_MISSION_ACCEPTED
    if autopilot == "ardupilot":
        assert station.command(SET_MODE, *GUIDED) == ACCEPTED
    assert station.command(ARM, 1) == ACCEPTED
    assert station.command(mavlink.MAV_CMD_MISSION_START) == ACCEPTED
    assert vehicle.mode in ("AUTO", "MISSION")
    nearest = [1e9] * len(items)
    while vehicle.armed:
        station.step(0.1)
        for seq in range(first + 1, first + 4):
            item = vehicle.copter.origin.local(
                vehicle.mission.items[seq].place(vehicle.autopilot.home_place, vehicle.place)
            )
            nearest[seq] = min(nearest[seq], distance(vehicle.copter.local, item))
        assert vehicle.time < 300
    assert max(nearest[first + 1 : first + 4]) < 2
    reached = [msg.seq for msg in station.of("MISSION_ITEM_REACHED")]
    assert reached == list(range(first, len(items)))
    assert math.hypot(vehicle.copter.north, vehicle.copter.east) < 0.5
    assert station.last("MISSION_CURRENT").mission_state == mavlink.MISSION_STATE_COMPLETE


def test_ardupilot_refuses_a_mission_that_cannot_lift_off() -> None:
    vehicle, station = ready("ardupilot")
    assert station.command(SET_MODE, 1, 3) == REFUSED["ardupilot"]
    items = [mission_item(n, mavlink.MAV_CMD_NAV_WAYPOINT, z=10) for n in range(3)]
    assert upload(station, items) == mavlink.MAV_MISSION_ACCEPTED
    assert station.command(SET_MODE, 1, 3) == REFUSED["ardupilot"]
    assert any("missing takeoff" in text for text in station.texts())
    assert vehicle.mode == "STABILIZE"


def test_ardupilot_waits_on_the_ground_for_the_start() -> None:
    vehicle, station = ready("ardupilot", params={"AUTO_OPTIONS": 1})
    upload(station, route(vehicle))
    assert station.command(SET_MODE, 1, 3) == ACCEPTED
    assert station.command(ARM, 1) == ACCEPTED
    station.step(5)
    assert vehicle.landed
    channels = (1500, 1500, 1700, 1500, 0, 0, 0, 0)
    station.send(mavlink.MAVLink_rc_channels_override_message(1, 1, *channels), dt=5)
    assert vehicle.height > 3


def test_jumps_speeds_and_delays() -> None:
    vehicle, station = ready("px4")
    there = vehicle.copter.origin.globe(Local(30, 0, 0))
    items = [
        mission_item(0, mavlink.MAV_CMD_NAV_TAKEOFF, z=5),
        mission_item(1, mavlink.MAV_CMD_DO_CHANGE_SPEED, param1=1, param2=2),
        mission_item(2, mavlink.MAV_CMD_NAV_WAYPOINT, x=e7(there.lat), y=e7(there.lon), z=5),
        mission_item(3, mavlink.MAV_CMD_NAV_DELAY, param1=3),
        mission_item(4, mavlink.MAV_CMD_NAV_WAYPOINT, z=5),
        mission_item(5, mavlink.MAV_CMD_DO_JUMP, param1=2, param2=1),
        mission_item(6, mavlink.MAV_CMD_NAV_LAND),
    ]
    assert upload(station, items) == mavlink.MAV_MISSION_ACCEPTED
    station.command(ARM, 1)
    assert station.command(mavlink.MAV_CMD_MISSION_START) == ACCEPTED
    station.until(lambda: not vehicle.armed)
    assert [msg.seq for msg in station.of("MISSION_ITEM_REACHED")] == [0, 2, 3, 4, 2, 3, 4, 6]
    fastest = max(math.hypot(m.vx, m.vy) / 100 for m in station.of("GLOBAL_POSITION_INT"))
    assert fastest == pytest.approx(2, abs=0.3)


def test_a_circle_of_jumps_does_not_hang() -> None:
    vehicle, station = ready("px4")
    jump = [mission_item(n, mavlink.MAV_CMD_DO_JUMP, param1=1 - n, param2=-1) for n in range(2)]
    assert upload(station, jump) == mavlink.MAV_MISSION_ACCEPTED
    station.command(ARM, 1)
    assert station.command(mavlink.MAV_CMD_MISSION_START) == ACCEPTED
    station.step(2)
    assert vehicle.mission.complete
    assert vehicle.landed


def test_the_current_item_can_be_chosen_in_flight() -> None:
    vehicle, station = ready("px4")
    upload(station, route(vehicle))
    station.command(ARM, 1)
    station.command(mavlink.MAV_CMD_MISSION_START)
    station.until(lambda: vehicle.mission.current == 1)
    station.send(mavlink.MAVLink_mission_set_current_message(1, 1, 3), dt=0.1)
    assert vehicle.mission.current == 3
    assert station.last("MISSION_CURRENT").seq == 3
    station.send(mavlink.MAVLink_mission_set_current_message(1, 1, 99))
    assert vehicle.mission.current == 3
    assert "no mission item 99" in station.texts()[-1]
    assert station.command(mavlink.MAV_CMD_DO_SET_MISSION_CURRENT, 2) == ACCEPTED
    assert vehicle.mission.current == 2


# -- physics


def test_what_it_reports_agrees() -> None:
    """Attitude, velocity, position and accelerations of one flight fit each other."""
    vehicle, _ = flying("ardupilot")
    vehicle.autopilot.go_to(Local(60, 40, 20))
    copter, dt = vehicle.copter, 0.01
    before = (copter.local, copter.vn, copter.ve, copter.yaw)
    for _ in range(1500):
        vehicle.step(dt)
        moved = ((copter.north - before[0].north) / dt, (copter.east - before[0].east) / dt)
        assert moved == pytest.approx((copter.vn, copter.ve), abs=1e-6)
        gained = ((copter.vn - before[1]) / dt, (copter.ve - before[2]) / dt)
        assert gained == pytest.approx((copter.an, copter.ae), abs=1e-6)
        assert max(abs(copter.roll), abs(copter.pitch)) <= math.radians(30) + 1e-9
        force = copter.specific_force()
        # Level flight or not: across the frame an accelerometer feels only the air's resistance.
        assert math.hypot(force[0], force[1]) < 2.0
        before = (copter.local, copter.vn, copter.ve, copter.yaw)


def test_wind_makes_it_lean_and_does_not_carry_it_off() -> None:
    vehicle, station = flying("ardupilot", wind=(-6.0, 0.0))
    station.step(20)
    assert math.hypot(vehicle.copter.north, vehicle.copter.east) < 1.5
    assert vehicle.copter.pitch < -0.03
    assert station.last("VFR_HUD").airspeed == pytest.approx(6, abs=0.3)
    assert station.last("WIND").speed == pytest.approx(6)


def test_the_quaternion_is_the_attitude() -> None:
    vehicle, station = flying("px4", heading=120)
    vehicle.autopilot.go_to(Local(20, 20, 15))
    station.step(2)
    for message in (mavlink.MAVLINK_MSG_ID_ATTITUDE, mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION):
        assert station.command(mavlink.MAV_CMD_REQUEST_MESSAGE, message) == ACCEPTED
    attitude, q = station.last("ATTITUDE"), station.last("ATTITUDE_QUATERNION")
    roll = math.atan2(2 * (q.q1 * q.q2 + q.q3 * q.q4), 1 - 2 * (q.q2**2 + q.q3**2))
    pitch = math.asin(2 * (q.q1 * q.q3 - q.q4 * q.q2))
    yaw = math.atan2(2 * (q.q1 * q.q4 + q.q2 * q.q3), 1 - 2 * (q.q3**2 + q.q4**2))
    assert (roll, pitch, yaw) == pytest.approx(
        (attitude.roll, attitude.pitch, attitude.yaw), abs=1e-5
    )
