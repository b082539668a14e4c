#!/usr/bin/env python3
"""A whole session with a copter: connect, wait for its heartbeat, arm, take off, fly a square, watch
telemetry, land, and keep the log.

    mavwire sim                                      # in one terminal
    python examples/fly.py --record flight.tlog      # in another

The vehicle must fly as ArduCopter does. Do not point this at a real one with its propellers on.
"""

from __future__ import annotations

import argparse
import math
import shutil
import sys
import time
from collections.abc import Callable
from typing import Any

from mavwire import mavutil
from mavwire.dialects.v20 import ardupilotmega as mavlink

WAIT = 60.0  # seconds of real time after which something is wrong
AGAIN = 3.0  # seconds after which what was sent may be lost
HEIGHT = 10.0
ON_THE_GROUND = 1.0  # metres that a height may be wrong by
SIDE = 30.0
CORNERS = ((SIDE, 0.0), (SIDE, SIDE), (0.0, SIDE), (0.0, 0.0))
BAR = 8  # characters; a line fits into a terminal of 80 columns
PLAIN_INTERVAL = 5.0  # seconds of the vehicle's time between lines that are not on a terminal
LIVE_INTERVAL = 0.1
LATER = (mavlink.MAV_RESULT_FAILED, mavlink.MAV_RESULT_TEMPORARILY_REJECTED)
POSITION_KNOWN = mavlink.EKF_POS_HORIZ_ABS
ONLY_POSITION = 0xDF8  # of SET_POSITION_TARGET_LOCAL_NED: ignore velocities, accelerations and yaw


class View:
    """The vehicle's state: one line that changes on a terminal, lines now and then elsewhere."""

    def __init__(self) -> None:
        self.live = sys.stdout.isatty()
        self._shown = -math.inf
        self._width = 0

    def say(self, text: str) -> None:
        """A line that stays."""
        self._wipe()
        print(text, flush=True)

    def show(self, link: Any) -> None:
        """The present state, if it is time."""
        position = link.messages.get("GLOBAL_POSITION_INT")
        if position is None:
            return
        seconds = position.time_boot_ms / 1e3
        now = time.monotonic() if self.live else seconds
        if now - self._shown < (LIVE_INTERVAL if self.live else PLAIN_INTERVAL):
            return
        self._shown = now
        text = f"{seconds:6.1f} s {describe(link, position)}"
        if self.live:
            self._draw(text)
        else:
            print(text, flush=True)

    def _draw(self, text: str) -> None:
        text = text[: max(shutil.get_terminal_size().columns - 1, BAR)]
        print(f"\r{text:<{self._width}}", end="", flush=True)
        self._width = len(text)

    def _wipe(self) -> None:
        if self._width:
            print(f"\r{'':<{self._width}}\r", end="")
            self._width = 0


def describe(link: Any, position: Any) -> str:
    """Mode, height, speed, heading and battery in a line."""
    height = position.relative_alt / 1e3
    filled = max(0, min(BAR, round(BAR * height / HEIGHT)))
    speed = math.hypot(position.vx, position.vy) / 100
    battery = link.messages.get("SYS_STATUS")
    charge = "" if battery is None else f"  battery {battery.battery_remaining}%"
    armed = "armed" if link.motors_armed() else "safe "
    return (
        f"{link.flightmode:<9} {armed} [{'#' * filled:-<{BAR}}] {height:4.1f} m"
        f"  {speed:4.1f} m/s  heading {position.hdg / 100:03.0f}{charge}"
    )


class Session:
    """A ground station with one vehicle. Everything that waits keeps the view and the heartbeats
    going, and raises `TimeoutError` rather than waiting for ever.
    """

    def __init__(self, link: Any, view: View) -> None:
        self.link = link
        self.view = view
        self._beat = mavutil.periodic_event(1)
        self.highest = self.fastest = 0.0

    def until(self, wanted: Callable[[Any], object], what: str, seconds: float = WAIT) -> Any:
        """Receive until there is a message that is wanted; that message."""
        deadline = time.monotonic() + seconds
        while time.monotonic() < deadline:
            if self._beat.trigger():
                self.link.mav.heartbeat_send(
                    mavlink.MAV_TYPE_GCS, mavlink.MAV_AUTOPILOT_INVALID, 0, 0, 0
                )
            msg = self.link.recv_match(blocking=True, timeout=0.5)
            if msg is not None:
                self._watch(msg)
                if wanted(msg):
                    return msg
        raise TimeoutError(f"{what}: not within {seconds:.0f} s")

    def _watch(self, msg: Any) -> None:
        if msg.get_type() == "STATUSTEXT":
            self.view.say(f"  vehicle says: {msg.text}")
        elif msg.get_type() == "VFR_HUD":
            self.fastest = max(self.fastest, msg.groundspeed)
        elif msg.get_type() == "GLOBAL_POSITION_INT":
            self.highest = max(self.highest, msg.relative_alt / 1e3)
        self.view.show(self.link)

    def command(self, number: int, *params: float, done: Callable[[], bool]) -> None:
        """COMMAND_LONG, sent again while it is lost or the vehicle is not ready for it. It may be the
        answer that is lost, and what was done is refused then: `done` tells that it was.
        """
        name = mavlink.enums["MAV_CMD"][number].name
        padded = [*params, *[0.0] * (7 - len(params))]
        deadline, result = time.monotonic() + WAIT, mavlink.MAV_RESULT_FAILED
        while result in LATER and not done() and time.monotonic() < deadline:
            self.link.mav.command_long_send(
                self.link.target_system, mavlink.MAV_COMP_ID_AUTOPILOT1, number, 0, *padded
            )
            try:
                result = self.until(lambda msg: is_ack(msg, number), name, seconds=AGAIN).result
            except TimeoutError:
                continue
            if result in LATER:
                time.sleep(0.5)
        if result != mavlink.MAV_RESULT_ACCEPTED and not done():
            raise RuntimeError(f"{name}: {mavlink.enums['MAV_RESULT'][result].name}")

    def repeat(
        self, send: Callable[[], object], wanted: Callable[[Any], object], what: str
    ) -> None:
        """Send now, and again as it may be lost, until there is a message that is wanted."""
        deadline = time.monotonic() + WAIT
        while time.monotonic() < deadline:
            send()
            try:
                self.until(wanted, what, seconds=AGAIN)
            except TimeoutError:
                continue
            return
        raise TimeoutError(f"{what}: not within {WAIT:.0f} s")

    def mode(self, name: str) -> None:
        """Change the flight mode."""
        self.repeat(
            lambda: self.link.set_mode(name),
            lambda _: self.link.flightmode == name,
            f"mode {name}",
        )

    def go_to(self, north: float, east: float) -> None:
        """Fly to a point, in metres from where the vehicle was switched on."""
        self.repeat(
            lambda: self.link.mav.set_position_target_local_ned_send(
                0, self.link.target_system, mavlink.MAV_COMP_ID_AUTOPILOT1,
                mavlink.MAV_FRAME_LOCAL_NED, ONLY_POSITION, north, east, -HEIGHT, *[0.0] * 8,
            ),
            lambda msg: (
                msg.get_type() == "LOCAL_POSITION_NED"
                and math.hypot(msg.x - north, msg.y - east) < 2.5
            ),
            f"the corner {north:.0f} m north, {east:.0f} m east",
        )  # fmt: skip


def is_ack(msg: Any, number: int) -> bool:
    """Whether a message answers a command."""
    return bool(msg.get_type() == "COMMAND_ACK" and msg.command == number)


def fly(link: Any, view: View) -> None:
    """The session, step by step."""
    session = Session(link, view)
    view.say("Waiting for a heartbeat ...")
    if link.wait_heartbeat(timeout=WAIT) is None:
        raise TimeoutError(f"no heartbeat within {WAIT:.0f} s")
    view.say(f"Vehicle {link.target_system} is there, in mode {link.flightmode}")
    session.until(
        lambda msg: msg.get_type() == "EKF_STATUS_REPORT" and msg.flags & POSITION_KNOWN,
        "a position",
    )
    view.say("It knows where it is: arming and taking off")
    session.mode("GUIDED")
    session.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1, done=link.motors_armed)
    session.command(
        mavlink.MAV_CMD_NAV_TAKEOFF, 0, 0, 0, 0, 0, 0, HEIGHT,
        done=lambda: session.highest > ON_THE_GROUND,
    )  # fmt: skip
    session.until(lambda _: session.highest > HEIGHT - 0.5, f"{HEIGHT:.0f} m of height")
    view.say(f"At {HEIGHT:.0f} m: flying a square of {SIDE:.0f} m")
    for north, east in CORNERS:
        session.go_to(north, east)
    view.say("Back home: landing")
    session.mode("LAND")
    session.until(lambda _: not link.motors_armed(), "landed and disarmed")
    view.say(f"Landed. Highest {session.highest:.1f} m, fastest {session.fastest:.1f} m/s")


def main() -> int:
    parser = argparse.ArgumentParser(description="Fly a copter up, around and down.")
    parser.add_argument("device", nargs="?", default="udpin:127.0.0.1:14550")
    parser.add_argument("--record", metavar="TLOG", help="keep what was received")
    args = parser.parse_args()
    with mavutil.mavlink_connection(args.device) as link:
        if args.record:
            link.setup_logfile(args.record)
        fly(link, View())
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
