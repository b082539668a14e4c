"""The methods of a live link beside pymavlink's: the same calls, the same datagrams either way."""

from __future__ import annotations

import importlib
import socket
from collections.abc import Iterator
from typing import Any

import pytest
from unit.link_tools import free_port

WAIT = 60.0

SENDING = (
    "param_fetch_all()", "param_fetch_one('RC1_MIN')", "param_fetch_one(b'RC1_MIN')",
    "param_fetch_one(7)", "param_fetch_one('12')", "param_set_send('RC1_MIN', 1100)",
    "param_set_send('RC1_MIN', 5, 2)", "waypoint_request_list_send()",
    "waypoint_clear_all_send()", "waypoint_request_send(3)", "waypoint_set_current_send(4)",
    "waypoint_count_send(5)", "set_mode_flag(128, True)", "set_mode_flag(128, False)",
    "set_mode_auto()", "set_mode_rtl()", "set_mode_manual()", "set_mode_fbwa()",
    "set_mode_loiter()", "set_mode_apm('AUTO')", "set_mode_apm(9)", "set_mode_apm('NO')",
    "set_mode_px4('RTL', 0, 0)", "set_mode_px4('MISSION', 0, 0)", "set_mode_px4(81, 2, 0)", "set_mode('RTL')", "set_mode(4)",
    "set_servo(5, 1500)", "set_relay()", "set_relay(2, False)", "calibrate_level()",
    "calibrate_pressure()", "reboot_autopilot()", "reboot_autopilot(True)",
    "reboot_autopilot(force=True)", "arducopter_arm()", "arducopter_disarm()",
)  # fmt: skip
ASKING = (
    "target_system", "target_component", "flightmode", "mav_type", "base_mode", "vehicle_type",
    "motors_armed()", "mode_mapping()", "params", "param('RC1_MIN')", "param('NONE', 4)",
    "field('VFR_HUD', 'alt')", "field('NONE', 'alt', 7)", "packet_loss()", "mav_count", "mav_loss",
    "last_seq", "sorted(m.messages)", "sorted(m.sysid_state)", "sorted(m.param_state)", "uptime",
    "check_condition('VFR_HUD.alt>5')", "mavlink20()", "mavlink10()", "WIRE_PROTOCOL_VERSION",
    "first_byte", "mav.total_packets_received", "mav.total_bytes_received",
    "mav.total_receive_errors", "mav.seq", "mav.total_packets_sent", "mav.total_bytes_sent",
)  # fmt: skip
# What a vehicle says: its autopilot and type are the case's.
TELEMETRY = (
    ("heartbeat", 1, "{type}, {autopilot}, 217, 65536, 4, 3"),
    ("param_value", 1, "b'RC1_MIN', 1100.5, 9, 2, 0"),
    ("param_value", 1, "b'RC1_MAX', 1900.25, 9, 2, 1"),
    ("heartbeat", 190, "6, 8, 0, 0, 4, 3"),
    ("vfr_hud", 1, "1.5, 2.5, 90, 50, 10.5, 0.5"),
    ("gps_raw_int", 1, "1000000, 3, 471234567, 81234567, 488000, 1, 1, 1, 1, 9"),
    ("vfr_hud", 1, "1.5, 2.5, 91, 50, 11.5, 0.5"),
    ("global_position_int", 1, "5000, 471234567, 81234567, 488000, 12000, 1, 2, 3, 100"),
    ("battery_status", 1, "1, 0, 0, 100, [65535] * 10, 5, 6, 7, 80"),
    ("mission_current", 1, "6"),
)


class End:
    """A link of one package to a vehicle that this test plays."""

    def __init__(self, package: str) -> None:
        self.mavutil = importlib.import_module(f"{package}.mavutil")
        self.mavutil.set_dialect("all")
        port = free_port(socket.SOCK_DGRAM)
        self.link: Any = self.mavutil.mavlink_connection(f"udpin:127.0.0.1:{port}")
        self.vehicle = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.vehicle.settimeout(WAIT)
        self.vehicle.connect(("127.0.0.1", port))

    def fly(self, frames: list[bytes]) -> None:
        for frame in frames:
            self.vehicle.send(frame)

    def sent(self) -> list[bytes]:
        """The datagrams that a call sent. One more, which the test sends, says that it is over."""
        self.link.write(b"end")
        found = []
        while (datagram := self.vehicle.recv(1000)) != b"end":
            found.append(datagram)
        return found

    def ask(self, question: str) -> Any:
        text = question if question.startswith("sorted") else f"m.{question}"
        return eval(text, {"m": self.link})

    def close(self) -> None:
        self.link.close()
        self.vehicle.close()


@pytest.fixture
def ends(monkeypatch: pytest.MonkeyPatch, subject: str, oracle: str) -> Iterator[list[End]]:
    monkeypatch.setenv("MAVLINK20", "1")
    opened = [End(subject), End(oracle)]
    yield opened
    for end in opened:
        end.close()
    monkeypatch.delenv("MAVLINK20")
    for end in opened:
        end.mavutil.set_dialect("all")


def telemetry(mavlink: Any, mav_type: int, autopilot: int) -> list[bytes]:
    mav = mavlink.MAVLink(None, 5, 1)
    frames = []
    for seq, (name, compid, arguments) in enumerate(TELEMETRY):
        values = eval(f"({arguments.format(type=mav_type, autopilot=autopilot)},)")
        mav.seq, mav.srcComponent = seq, compid
        frames.append(bytes(getattr(mavlink, f"MAVLink_{name}_message")(*values).pack(mav)))
    return frames


@pytest.mark.parametrize(
    ("mav_type", "autopilot"), [(2, 3), (1, 3), (2, 12), (19, 12), (30, 3)],
    ids=["copter", "plane", "px4", "px4-vtol", "unmapped"],
)  # fmt: skip
def test_methods_of_a_link(
    ends: list[End], mav_type: int, autopilot: int, capsys: pytest.CaptureFixture[str]
) -> None:
    frames = telemetry(ends[0].mavutil.mavlink, mav_type, autopilot)
    answers = []
    for end in ends:
        # Up to the position, what location() waits for; the rest stays for waypoint_current().
        end.fly(frames)
        place = end.link.location(relative_alt=True)
        answers.append([str(place), place.heading, end.link.waypoint_current()])
        answers[-1] += [repr(end.ask(question)) for question in ASKING]
    assert answers[0] == answers[1]
    # pymavlink goes by the newest HEARTBEAT, which was the camera's.
    for end in ends:
        end.fly(telemetry(end.mavutil.mavlink, mav_type, autopilot)[:1])
        assert end.link.wait_heartbeat(timeout=WAIT).type == mav_type
    for call in SENDING:
        outcomes: list[Any] = []
        for end in ends:
            try:
                end.ask(call)
                outcomes.append((end.sent(), capsys.readouterr().out))
            except Exception as error:
                outcomes.append((f"{type(error).__name__}: {error}", end.sent()))
        assert outcomes[0] == outcomes[1], call
