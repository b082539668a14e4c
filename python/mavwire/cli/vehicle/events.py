"""`mavwire events LOG`: the events of PX4 vehicles in words.

LOG is a telemetry log or a link that mavutil opens (`udpin:0.0.0.0:14550`). The texts are in the
vehicle's component metadata: --event-definitions names a file with them, such as all_events.json.xz of a
PX4 release. A vehicle on a link is asked for its own; --save keeps them.
"""

from __future__ import annotations

import os
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import chain
from typing import Any

from mavwire._atomic_file import replacing
from mavwire.cli._errors import CommandError, tell
from mavwire.cli._reading import definitions, reading
from mavwire.cli._shared_arguments import add_shared
from mavwire.component_metadata import Kind, fetch
from mavwire.dialects import UPSTREAM
from mavwire.events import EventDefinitions
from mavwire.links.inspect_message import local_stamp

HEARTBEAT_TIMEOUT = 10.0


def add_arguments(parser: ArgumentParser) -> None:
    parser.add_argument("log", metavar="LOG", help="telemetry log, or a link")
    add_shared(parser, "event_definitions")
    parser.add_argument("--save", metavar="FILE", help="write the vehicle's definitions to a file")
    parser.add_argument(
        "--protocol", action="store_true", help="show events between programs, which are hidden"
    )


def main(args: Namespace) -> int:
    is_link = not os.path.isfile(args.log)
    if args.save and not is_link:
        raise CommandError("--save: a log has no definitions; give a link to the vehicle")
    described = args.event_definitions
    meanwhile: list[Any] = []
    with definitions(UPSTREAM), reading("events", args.log) as log:
        if is_link and (described is None or args.save):
            with _keeping_events(log.link, meanwhile):
                described = _of_vehicle(log.link, args.save)
        if described is None:
            tell("mavwire events: the texts are in --event-definitions FILE; these are numbers")
            described = EventDefinitions(b'{"components": {}}')
        for message in chain(meanwhile, log.messages(["EVENT"], blocking=is_link)):
            event = described.event(message)
            if args.protocol or event.level not in ("protocol", "disabled"):
                sender = f"{message.get_srcSystem()}/{message.get_srcComponent()}"
                stamp = local_stamp(message._timestamp)
                print(f"{stamp}: {sender} {event.level}: {event.text}", flush=is_link)
    return 0


@contextmanager
def _keeping_events(link: Any, events: list[Any]) -> Iterator[None]:
    """Add the events that arrive in the meantime, which those who wait for other messages would drop."""

    def keep(_: Any, message: Any) -> None:
        if message.get_type() == "EVENT":
            events.append(message)

    link.message_hooks.append(keep)
    try:
        yield
    finally:
        link.message_hooks.remove(keep)


def _of_vehicle(link: Any, save: str | None) -> EventDefinitions | None:
    """The vehicle's event definitions. None, and a line on standard error, if it offers none."""
    try:
        if link.wait_heartbeat(timeout=HEARTBEAT_TIMEOUT) is None:
            raise TimeoutError(f"no heartbeat within {HEARTBEAT_TIMEOUT:.0f} s")
        data = fetch(link, Kind.EVENTS)
        found = EventDefinitions(data, "the vehicle's event definitions")
    except (TimeoutError, LookupError, ValueError) as error:
        if save:
            raise CommandError(str(error)) from error
        tell(f"mavwire events: {error}")
        return None
    if save:
        with replacing(save) as file:
            file.write(data)
    return found
