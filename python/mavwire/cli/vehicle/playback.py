"""A log as if the vehicle flew again, for ground stations and for FlightGear (mavplayback.py).

Where there is a display a small window has the speed and a button for pauses; without one, and with
--headless, it plays from the start to the end.
"""

from __future__ import annotations

import os
import sys
import time
from argparse import ArgumentParser, Namespace
from collections import Counter
from collections.abc import Iterator
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

from mavwire.cli._errors import CommandError
from mavwire.cli._reading import Reading, definitions, link_options, reading
from mavwire.cli._shared_arguments import add_shared
from mavwire.cli._telemetry import require_telemetry
from mavwire.cli._values import factor
from mavwire.links.signing import SETUP_SIGNING

if TYPE_CHECKING:
    from mavwire.cli.vehicle._player import Player

OUT = "127.0.0.1:14550"
FLIGHTGEAR = "127.0.0.1:5503"
# Seconds between looks at the window's controls, at most.
LONGEST_WAIT = 0.1


def add_arguments(parser: ArgumentParser) -> None:
    parser.add_argument("log", metavar="LOG", help="telemetry log")
    add_shared(parser, "planner", "condition")
    add = parser.add_argument
    add("--gpsalt", action="store_true", help="altitude of GPS in place of the autopilot's")
    add("--mav10", action="store_true", help="read the log with MAVLink 1 definitions")
    add("--out", action="append", metavar="ENDPOINT", help=f"for MAVLink, repeatable [{OUT}]")
    add("--fgout", action="append", metavar="IP:PORT", help=f"for FlightGear [{FLIGHTGEAR}]")
    add("--baudrate", type=int, default=57600, help="of serial ports (default: %(default)s)")
    add("--speed", type=factor, default=1.0, metavar="X", help="times real time (default: 1)")
    add("--headless", action="store_true", help="no window")


def main(args: Namespace) -> int:
    from mavwire.cli.vehicle._player import Flight, Player

    protocol = "1.0" if args.mav10 else None
    with (
        definitions(wire_protocol=protocol),
        ExitStack() as stack,
        reading("playback", args.log, **link_options(args)) as log,
    ):
        require_telemetry(log)
        outs = _links(args.out or [OUT], args.baudrate, stack)
        flights = _links(args.fgout or [FLIGHTGEAR], args.baudrate, stack)

        def send(frame: bytes) -> None:
            for link in outs:
                link.write(frame)

        def fly(packet: bytes) -> None:
            for link in flights:
                link.write(packet)

        keys = Counter[str]()
        messages = _messages(log, args, keys)
        player = Player(messages, send, fly, Flight(args.gpsalt), args.speed)
        if args.headless or not _show(player, args.log):
            play(player)
    left_out = f", {keys.total()} with a signing key left out" if keys else ""
    print(f"{player.sent} messages{left_out}", file=sys.stderr)
    return 0


def _messages(log: Reading, args: Namespace, keys: Counter[str]) -> Iterator[Any]:
    """The messages to send: all but BAD_DATA and messages with a signing key, which `keys` counts."""
    for msg in log.messages(None, args.condition):
        if msg.get_msgId() == SETUP_SIGNING:
            keys[msg.get_type()] += 1
        elif msg.get_type() != "BAD_DATA":
            yield msg


def _links(endpoints: list[str], baudrate: int, stack: ExitStack) -> list[Any]:
    """Links to endpoints: IP:PORT for UDP, or any that mavutil opens."""
    from mavwire import mavutil
    from mavwire.links.connection import PREFIXES

    links = []
    for endpoint in endpoints:
        known = f"{endpoint.partition(':')[0]}:" in PREFIXES
        name = f"udpout:{endpoint}" if endpoint.count(":") == 1 and not known else endpoint
        try:
            link = mavutil.mavlink_connection(name, baud=baudrate, input=False)
        except (OSError, ValueError, ImportError) as error:
            raise CommandError(f"cannot open {endpoint}: {error}") from error
        stack.callback(link.close)
        links.append(link)
    return links


def play(player: Player) -> None:
    """Play to the end of the log."""
    while not player.done:
        time.sleep(min(player.step(), LONGEST_WAIT))


def _show(player: Player, path: str) -> bool:
    """Play beside a window until it is closed; False where there can be none."""
    try:
        import tkinter
    except ImportError:
        return False
    try:
        root = tkinter.Tk()
    except tkinter.TclError:  # no display
        return False
    window(player, tkinter, root, os.path.basename(path))
    root.mainloop()
    return True


def window(player: Player, tkinter: Any, root: Any, name: str) -> None:
    """Fill a window: the log's clock, the speed, a button for pauses."""
    root.title(f"mavwire playback: {name}")
    clock = tkinter.Label(root, width=24)
    clock.pack(side="left")
    speed = tkinter.DoubleVar(value=player.speed)
    tkinter.Spinbox(root, from_=0.1, to=100, increment=0.1, textvariable=speed, width=6).pack(
        side="left"
    )
    button = tkinter.Button(root, text="Pause")
    button.pack(side="left")

    def toggle() -> None:
        player.paused = not player.paused
        button.config(text="Play" if player.paused else "Pause")

    def tick() -> None:
        try:
            player.speed = max(0.001, float(speed.get()))
        except (ValueError, tkinter.TclError):  # half a number is typed
            pass
        wait = player.step()
        if player.stamp is not None:
            clock.config(text=time.ctime(player.stamp))
        if player.done:
            root.destroy()
            return
        root.after(int(min(wait, LONGEST_WAIT) * 1000) + 1, tick)

    button.config(command=toggle)
    tick()
