"""A ground station: what links and the messages of the current dialect are to a type checker."""

from __future__ import annotations

from typing import Any, assert_type

from mavwire import mavutil
from mavwire.dialects.v20 import ardupilotmega as mavlink


def connect(device: str) -> mavutil.mavfile:
    """A link whose target is known."""
    link = mavutil.mavlink_connection(device, source_system=255, autoreconnect=True)
    beat: mavlink.MAVLink_message | None = link.wait_heartbeat(timeout=10)
    if beat is None:
        raise TimeoutError(device)
    link.mav.request_data_stream_send(link.target_system, link.target_component, 0, 4, 1)
    return link


def heading(device: str) -> float:
    """A message is one of the current dialect until `isinstance` says which."""
    link = mavutil.mavlink_connection(device)
    msg = link.recv_match(type="ATTITUDE", blocking=True)
    degrees: float = msg.yaw * 57.3
    newest = link.recv_match(type=["ATTITUDE", "AHRS2"], blocking=True, timeout=1.5)
    if isinstance(newest, mavlink.MAVLink_attitude_message):
        assert_type(newest.yaw, float)
        assert_type(newest.get_srcSystem(), int)
        return newest.yaw
    return degrees


def state(link: mavutil.mavfile) -> dict[str, float]:
    """What a link remembers."""
    assert_type(link.target_system, int)
    assert_type(link.flightmode, str)
    assert_type(link.params, dict[str, float])
    assert_type(link.messages, dict[str, Any])
    assert_type(link.time_since("HEARTBEAT"), float)
    assert_type(link.packet_loss(), float)
    assert_type(link.location(), mavutil.location)
    assert_type(link.location().lat, float)
    assert_type(link.motors_armed(), int)
    assert_type(link.mode_mapping(), dict[str, Any] | None)
    assert_type(link.mav.total_packets_sent, int)
    return link.params


def fly(link: mavutil.mavfile, key: bytes) -> None:
    """What a link can be told."""
    link.setup_signing(key, sign_outgoing=True, allow_unsigned_callback=mavutil.allow_radio_status)
    link.param_fetch_all()
    link.set_mode("GUIDED")
    link.arducopter_arm()
    link.mav.command_long_send(
        link.target_system, link.target_component, mavlink.MAV_CMD_NAV_TAKEOFF, 0,
        0, 0, 0, 0, 0, 0, 10,
    )  # fmt: skip
    link.message_hooks.append(lambda _link, msg: print(msg.get_type()))
    link.setup_logfile("flight.tlog")
    link.close()


def kinds() -> list[mavutil.mavfile]:
    """Every kind of link by its own class."""
    udp = mavutil.mavudp("127.0.0.1:14550", input=True)
    msg: mavlink.MAVLink_message | None = udp.recv_msg()
    print(msg)
    return [
        udp,
        mavutil.mavtcp("127.0.0.1:5760"),
        mavutil.mavtcpin("127.0.0.1:5761"),
        mavutil.mavserial("/dev/ttyACM0", baud=57600),
        mavutil.mavmcast(""),
        mavutil.mavchildexec("./sitl"),
    ]
