#!/usr/bin/env python3
"""MAVLink over a device of one's own: no mavutil, only the dialect module and a socket.

A `MAVAPI` takes any object with `write`, `read` and `close`. One thread receives and feeds the
parser, one sends heartbeats; messages are told apart by their classes.

    python examples/mavapi.py drone --peer 127.0.0.1:14550          # for a ground station
    mavwire sim --autopilot px4 --out udpout:127.0.0.1:14540
    python examples/mavapi.py companion --listen 127.0.0.1:14540    # arms and flies that vehicle

With definitions of your own, make the module first: `mavwire gen --wire-protocol 2.0 my.xml`.
"""

# ruff: noqa: F403, F405
from __future__ import annotations

import argparse
import math
import socket
import threading
import time
from contextlib import suppress
from typing import Any, Protocol, Self

try:
    from mavlink import *  # type: ignore[import-not-found]
except ImportError:
    from mavwire.dialects.v20.common import *

Address = tuple[str, int]

WAIT = 30.0
# PX4's flight modes: the main mode AUTO in the third byte, what it does in the fourth.
CUSTOM_ARMED = MAV_MODE_FLAG_SAFETY_ARMED | MAV_MODE_FLAG_CUSTOM_MODE_ENABLED  # 129
TAKEOFF = 0x2040000
LOITER = 0x3040000
LAND = 0x6040000


class Device(Protocol):
    """A carrier of bytes, such as a socket or a serial port."""

    def write(self, data: bytes) -> Any: ...
    def read(self) -> bytes: ...
    def close(self) -> None: ...


class UdpDevice:
    """A UDP socket that talks to `peer`, or to whoever was heard last."""

    def __init__(self, listen: Address, peer: Address | None = None) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind(listen)
        self._socket.settimeout(0.2)
        self._fixed = peer is not None
        self._peer = peer

    def write(self, data: bytes) -> None:
        """Send one frame; nowhere, as long as nobody is known."""
        if self._peer is not None:
            self._socket.sendto(data, self._peer)

    def read(self) -> bytes:
        """The next datagram, or nothing after a moment."""
        try:
            data, sender = self._socket.recvfrom(65535)
        except (TimeoutError, ConnectionError):
            return b""  # nobody has sent, or nobody listens at the other end yet
        if not self._fixed:
            self._peer = sender
        return data

    def close(self) -> None:
        """Release the port."""
        self._socket.close()


class MAVAPI:
    """One MAVLink system on a device."""

    # The content of the heartbeats.
    type = MAV_TYPE_ONBOARD_CONTROLLER
    autopilot = MAV_AUTOPILOT_INVALID
    base_mode = 0
    custom_mode = 0
    status = MAV_STATE_ACTIVE

    def __init__(self, device: Device, sysid: int, compid: int) -> None:
        self.device = device
        self.mav = MAVLink(device, srcSystem=sysid, srcComponent=compid)
        self.mav.robust_parsing = True  # noise is a BAD_DATA message, not an exception
        self._changed = threading.Condition()
        self._sending = threading.Lock()
        self._ended = threading.Event()
        self._threads = [
            threading.Thread(target=run, name=run.__name__)
            for run in (self._receive, self._send_heartbeats)
        ]
        for thread in self._threads:
            thread.start()

    def close(self) -> None:
        """End the threads, then the device."""
        self._ended.set()
        for thread in self._threads:
            thread.join()
        self.device.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    # -- the threads

    def _receive(self) -> None:
        while not self._ended.is_set():
            msg = self.mav.parse_char(self.device.read())
            while msg is not None:  # a datagram may hold several frames
                with self._changed:
                    self.handle(msg)
                    self._changed.notify_all()
                msg = self.mav.parse_char(b"")

    def _send_heartbeats(self) -> None:
        while True:
            self.send(
                MAVLink_heartbeat_message(
                    self.type, self.autopilot, self.base_mode, self.custom_mode, self.status, 3
                )
            )
            if self._ended.wait(1.0):
                return

    # -- messages

    def send(self, msg: MAVLink_message) -> None:
        """Send from any thread."""
        with self._sending:
            self.mav.send(msg)

    def handle(self, msg: MAVLink_message) -> None:
        """Called for each message, in the receiving thread."""

    def wait(self, condition: Any, what: str) -> None:
        """Until messages have made `condition()` true."""
        with self._changed:
            if not self._changed.wait_for(condition, WAIT):
                raise TimeoutError(f"{what}: not within {WAIT:.0f} s")


class Companion(MAVAPI):
    """A companion computer that commands the autopilot of its vehicle."""

    def __init__(self, device: Device) -> None:
        self.heartbeat: MAVLink_heartbeat_message | None = None
        self.attitude: MAVLink_attitude_message | None = None
        super().__init__(device, 1, MAV_COMP_ID_ONBOARD_COMPUTER)

    def handle(self, msg: MAVLink_message) -> None:
        """Remember what the autopilot says."""
        if msg.get_srcComponent() != MAV_COMP_ID_AUTOPILOT1:
            return
        if isinstance(msg, MAVLink_heartbeat_message):
            self.heartbeat = msg
        elif isinstance(msg, MAVLink_attitude_message):
            self.attitude = msg

    @property
    def armed(self) -> bool:
        """Whether the vehicle's motors may turn."""
        beat = self.heartbeat
        return beat is not None and bool(beat.base_mode & MAV_MODE_FLAG_SAFETY_ARMED)

    @property
    def mode(self) -> int | None:
        """The number of the flight mode."""
        return None if self.heartbeat is None else self.heartbeat.custom_mode

    @property
    def heading(self) -> float:
        """Degrees clockwise from north."""
        attitude = self.attitude
        return math.nan if attitude is None else math.degrees(attitude.yaw) % 360

    def arm(self, arm: bool = True) -> None:
        """Start the motors, again and again until they run: a vehicle needs its time at first."""
        deadline = time.monotonic() + WAIT
        while self.armed is not arm:
            self.send(
                MAVLink_command_long_message(
                    1, MAV_COMP_ID_AUTOPILOT1, MAV_CMD_COMPONENT_ARM_DISARM,
                    0, float(arm), 0, 0, 0, 0, 0, 0,
                )
            )  # fmt: skip
            with self._changed:
                self._changed.wait_for(lambda: self.armed is arm, 1.0)
            if time.monotonic() > deadline:
                raise TimeoutError("the vehicle refuses")

    def disarm(self) -> None:
        """Stop the motors."""
        self.arm(False)

    def take_off(self) -> None:
        """Climb to the usual height and stay there."""
        self.send(MAVLink_set_mode_message(1, CUSTOM_ARMED, TAKEOFF))
        self.wait(lambda: self.mode == TAKEOFF, "taking off")
        self.wait(lambda: self.mode == LOITER, "at its height")

    def land(self) -> None:
        """Come down; the vehicle disarms by itself."""
        self.send(MAVLink_set_mode_message(1, CUSTOM_ARMED, LAND))
        self.wait(lambda: self.mode == LAND, "landing")
        self.wait(lambda: not self.armed, "landed")


class Drone(MAVAPI):
    """A vehicle as a ground station sees it: it reports its attitude and can be armed."""

    type = MAV_TYPE_QUADROTOR
    autopilot = MAV_AUTOPILOT_PX4
    custom_mode = LOITER
    status = MAV_STATE_STANDBY

    def __init__(self, device: Device) -> None:
        self.stations: set[int] = set()
        super().__init__(device, 1, MAV_COMP_ID_AUTOPILOT1)

    def handle(self, msg: MAVLink_message) -> None:
        """Do what a ground station asks for."""
        if isinstance(msg, MAVLink_heartbeat_message):
            self.stations.add(msg.get_srcSystem())
        elif isinstance(msg, MAVLink_set_mode_message):
            self.custom_mode = msg.custom_mode
        elif isinstance(msg, MAVLink_command_long_message):
            self.send(MAVLink_command_ack_message(msg.command, self.obey(msg)))

    def obey(self, msg: MAVLink_command_long_message) -> int:
        """Carry out a command; the result for its acknowledgement."""
        if msg.command != MAV_CMD_COMPONENT_ARM_DISARM:
            return MAV_RESULT_UNSUPPORTED
        armed = MAV_MODE_FLAG_SAFETY_ARMED if msg.param1 else 0
        self.base_mode = MAV_MODE_FLAG_CUSTOM_MODE_ENABLED | armed
        return MAV_RESULT_ACCEPTED

    def fly(self, seconds: float) -> None:
        """Sway a little, and tell so ten times a second."""
        began = time.monotonic()
        while (now := time.monotonic() - began) < seconds:
            roll, rate = 0.1 * math.sin(now), 0.1 * math.cos(now)
            self.send(MAVLink_attitude_message(int(now * 1e3), roll, 0, 0, rate, 0, 0))
            time.sleep(0.1)


def play_companion(device: Device) -> None:
    """Arm, fly up, look around, land."""
    with Companion(device) as companion:
        companion.wait(lambda: companion.heartbeat and companion.attitude, "a vehicle")
        print("the vehicle is there, with the messages of", MAVLink.__module__)
        companion.arm()
        print("armed")
        companion.take_off()
        print(f"in the air, heading {companion.heading:.0f}")
        companion.land()
        print("landed, disarmed")


def play_drone(device: Device, seconds: float) -> None:
    """Be there for some time, or until Ctrl-C."""
    with Drone(device) as drone:
        with suppress(KeyboardInterrupt):
            drone.fly(seconds)
        print(f"seen by {len(drone.stations)} ground station(s)")


def address(text: str) -> Address:
    """HOST:PORT."""
    host, _, port = text.rpartition(":")
    return host, int(port)


def main() -> None:
    parser = argparse.ArgumentParser(description="MAVLink over a device of one's own.")
    parser.add_argument("role", choices=["drone", "companion"])
    parser.add_argument("--listen", type=address, default=("127.0.0.1", 0), metavar="HOST:PORT")
    parser.add_argument("--peer", type=address, metavar="HOST:PORT")
    parser.add_argument("--seconds", type=float, default=60.0, help="how long the drone flies")
    args = parser.parse_args()
    device = UdpDevice(args.listen, args.peer)
    if args.role == "drone":
        play_drone(device, args.seconds)
    else:
        play_companion(device)


if __name__ == "__main__":
    main()
