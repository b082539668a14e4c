"""Fly simulated vehicles and send their telemetry to a ground station.

They answer like an ArduCopter or a PX4 multicopter: parameters, missions, commands, modes, files.
Connect QGroundControl, Mission Planner, MAVProxy, MAVSDK or a script of your own, and fly.

examples:
  mavwire sim                                    one ArduCopter to 127.0.0.1:14550
  mavwire sim --autopilot px4 --count 3          three PX4 vehicles, ids 1 to 3
  mavwire sim --out tcpin:0.0.0.0:5760           wait for a ground station on TCP
  mavwire sim --loss 5% --delay 200ms            over a bad radio
  mavwire sim --fly                              take off and fly circuits by itself
"""

from __future__ import annotations

import math
import time
from argparse import ArgumentParser, ArgumentTypeError, Namespace
from typing import TYPE_CHECKING, Any

from mavwire.cli._errors import CommandError, refused, tell
from mavwire.cli._values import duration, fraction

if TYPE_CHECKING:
    from mavwire.sim import Runner, Vehicle

DEFAULT_OUT = "udpout:127.0.0.1:14550"
MAX_COUNT = 200


def add_arguments(parser: ArgumentParser) -> None:
    # fmt: off
    add = parser.add_argument_group("the vehicles").add_argument
    add(
        "--autopilot", choices=["ardupilot", "px4"], default="ardupilot",
        help="whose ways they have [default: %(default)s]",
    )
    add("--count", type=int, default=1, metavar="N", help="how many [default: 1]")
    add("--sysid", type=int, default=1, metavar="ID", help="id of the first [default: 1]")
    add("--home", type=place, metavar="LAT,LON[,ALT]", help="where they start")
    add("--heading", type=float, default=0.0, metavar="DEG", help="where they look")
    add("--wind", type=wind, default=(0.0, 0.0), metavar="DEG,SPEED", help="wind from there, m/s")
    add(
        "--param", type=setting, action="append", default=[], metavar="NAME=VALUE",
        help="set a parameter; may be repeated",
    )
    add("--seed", type=int, default=0, metavar="N", help="of noise and losses [default: 0]")
    add("--fly", action="store_true", help="take off and fly circuits")
    add = parser.add_argument_group("the link").add_argument
    add(
        "--out", metavar="DEVICE", action="append",
        help="connection string as for mavlink_connection: udpout:HOST:PORT, udpin:HOST:PORT, "
        f"tcpin:HOST:PORT, tcp:HOST:PORT, a serial port...; may be repeated [default: {DEFAULT_OUT}]",
    )
    share: dict[str, Any] = {"type": fraction, "default": 0.0, "metavar": "P"}
    period: dict[str, Any] = {"type": duration, "default": 0.0, "metavar": "T"}
    add("--loss", help="lose frames: 5%% or 0.05", **share)
    add("--corrupt", help="flip a bit in frames", **share)
    add("--duplicate", help="send frames twice", **share)
    add("--delay", help="delay frames: 200ms or 0.2s", **period)
    add("--jitter", help="delay them by up to this more", **period)
    add(
        "--signing-key", type=key_file, metavar="FILE",
        help="sign, and accept only what is signed; the file holds 32 bytes or 64 hexadecimal digits",
    )
    add("--mavlink1", action="store_true", help="send MAVLink 1")
    add = parser.add_argument_group("running").add_argument
    add("--speed", type=float, default=1.0, metavar="X", help="times real time [default: 1]")
    add("--duration", type=duration, metavar="T", help="end after this time: 90s or 5m")
    add("--quiet", action="store_true", help="no status line")
    # fmt: on


def main(args: Namespace) -> int:
    """Run until interrupted, or for `--duration`."""
    from mavwire import mavutil
    from mavwire.sim import Runner

    vehicles = _vehicles(args)
    links = _links(args.out or [DEFAULT_OUT], mavutil)
    with refused(ValueError):
        runner = Runner(vehicles, links, args.speed)
    if args.fly:
        from mavwire.sim.circuit import start_circuit

        for vehicle in vehicles:
            start_circuit(vehicle)
    tell(_announcement(vehicles, args))
    try:
        _run(runner, args)
    finally:
        runner.close()
    return 0


def _run(runner: Runner, args: Namespace) -> None:
    from mavwire.cli.vehicle._sim_status import StatusLine

    line = StatusLine(runner, enabled=not args.quiet)
    end = None if args.duration is None else time.monotonic() + args.duration
    try:
        while end is None or time.monotonic() < end:
            left = line.interval if end is None else min(line.interval, end - time.monotonic())
            runner.run(max(left, 0.0))
            line.draw()
    except KeyboardInterrupt:
        pass  # the usual way to end it
    finally:
        line.finish()


def _vehicles(args: Namespace) -> list[Vehicle]:
    from mavwire.sim import Impairment, Vehicle
    from mavwire.sim.geo import Place
    from mavwire.sim.personality import PERSONALITIES
    from mavwire.sim.vehicle import spread

    if not 1 <= args.count <= MAX_COUNT or not 1 <= args.sysid <= 255 - args.count:
        raise CommandError(
            f"--count and --sysid must give ids between 1 and 254, {MAX_COUNT} at most"
        )
    usual = PERSONALITIES[args.autopilot].home
    home = Place(*(args.home if args.home is not None else usual))
    try:
        impairment = Impairment(args.loss, args.corrupt, args.duplicate, args.delay, args.jitter)
        return [
            Vehicle(
                args.autopilot, args.sysid + index, seed=args.seed, home=spread(home, index),
                heading=args.heading, wind=args.wind, params=dict(args.param),
                impairment=impairment, signing_key=args.signing_key,
                version=1 if args.mavlink1 else 2,
            )
            for index in range(args.count)
        ]  # fmt: skip
    except (ValueError, KeyError) as error:
        raise CommandError(str(error.args[0])) from None


def _links(devices: list[str], mavutil: Any) -> list[Any]:
    """Open the links; the process speaks MAVLink 2 from the start."""
    mavutil.set_wire_protocol("2.0")
    mavutil.set_dialect("all")
    links: list[Any] = []
    for device in devices:
        try:
            links.append(mavutil.mavlink_connection(device, autoreconnect=True, retries=1))
            is_log = isinstance(links[-1], mavutil.mavlogfile)
            is_log |= not isinstance(links[-1], mavutil.mavfile)
            reason = f"{device} is a log, not a link" if is_log else ""
        except (OSError, ValueError, ImportError) as error:
            reason = str(error) if device in str(error) else f"{device}: {error}"
        if reason:
            for link in links:
                link.close()
            raise CommandError(reason)
    return links


def _announcement(vehicles: list[Vehicle], args: Namespace) -> str:
    first, last = vehicles[0].sysid, vehicles[-1].sysid
    who = f"vehicle {first}" if first == last else f"vehicles {first} to {last}"
    name = vehicles[0].personality.version_text
    return f"{name}: {who} on {', '.join(args.out or [DEFAULT_OUT])}; Ctrl-C ends it"


# -- values of options


def _numbers(text: str, counts: tuple[int, ...], form: str) -> list[float]:
    try:
        values = [float(part) for part in text.split(",")]
    except ValueError:
        values = []
    if len(values) not in counts or not all(map(math.isfinite, values)):
        raise ArgumentTypeError(f"not {form}: {text!r}")
    return values


def place(text: str) -> tuple[float, float, float]:
    """LAT,LON or LAT,LON,ALT."""
    from mavwire.sim.geo import MAX_LATITUDE

    lat, lon, *alt = _numbers(text, (2, 3), "LAT,LON[,ALT]")
    if not (abs(lat) < MAX_LATITUDE and abs(lon) <= 180):
        raise ArgumentTypeError(f"not a place where a copter could fly: {text!r}")
    return lat, lon, alt[0] if alt else 0.0


def wind(text: str) -> tuple[float, float]:
    """DEG,SPEED, where it comes from, as north and east components of where it goes."""
    direction, speed = _numbers(text, (2,), "DEG,SPEED")
    if not 0 <= speed <= 15:
        raise ArgumentTypeError(f"wind must be between 0 and 15 m/s: {text!r}")
    angle = math.radians(direction + 180)
    return speed * math.cos(angle), speed * math.sin(angle)


def setting(text: str) -> tuple[str, float]:
    """NAME=VALUE."""
    name, _, value = text.partition("=")
    try:
        return name.strip().upper(), float(value)
    except ValueError:
        raise ArgumentTypeError(f"not NAME=VALUE: {text!r}") from None


def key_file(path: str) -> bytes | None:
    """A signing key out of a file. Never on the command line, where everyone can read it."""
    from mavwire.bridge.border import signing_key
    from mavwire.bridge.errors import ConfigError

    try:
        return signing_key({"signing_key_file": path})
    except ConfigError as error:
        raise ArgumentTypeError(str(error)) from None
