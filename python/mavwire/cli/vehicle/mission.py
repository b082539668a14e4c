"""The mission in a log, written as a waypoint file (mavmission.py)."""

from __future__ import annotations

import os
from argparse import ArgumentParser, Namespace
from typing import Any

from mavwire.cli._errors import tell
from mavwire.cli._output import refuse_log
from mavwire.cli._reading import Reading, read_each
from mavwire.cli._shared_arguments import add_shared

TYPES = ("MISSION_ITEM", "MISSION_ITEM_INT", "CMD", "WAYPOINT")

# The MAV_MISSION_TYPE of what is flown; fences and rally points have others.
MISSION = 0
# The frame of a dataflash log that does not tell it.
GLOBAL_RELATIVE = 3


def add_arguments(parser: ArgumentParser) -> None:
    add_shared(parser, "logs")
    parser.add_argument("--output", default="mission.txt", help="(default: %(default)s)")


def main(args: Namespace) -> int:
    """Run the subcommand. Of several logs the last one's mission stays in the file, and a log without
    a mission leaves what is there.
    """
    refuse_log(args.output, args.logs)
    read_each("mission", args, lambda log: _save(log, args.output), title="")
    return 0


def _save(log: Reading, output: str) -> None:
    from mavwire import mavwp

    mission = mavwp.MAVWPLoader()
    for msg in log.messages(TYPES):
        if getattr(msg, "mission_type", MISSION) == MISSION:
            _put(mission, _item(msg))
    if not mission.count() and os.path.exists(output):
        tell(f"mavwire mission: no mission in {log.path}, {output} is left as it is")
        return
    mission.save(output)
    print(f"Saved {mission.count()} waypoints to {output}")


def _put(mission: Any, item: Any) -> None:
    """Replace an item, or append it; one that skips some takes the place of the first skipped."""
    if item.seq < mission.count():
        mission.set(item, item.seq)
        return
    if item.seq > mission.count():
        print(f"Adding dummy WP {mission.count()}")
    mission.add(item)


def _item(msg: Any) -> Any:
    """A MISSION_ITEM of any message that holds an item of a mission."""
    from mavwire import mavutil

    make = mavutil.mavlink.MAVLink_mission_item_message
    kind = msg.get_type()
    if kind == "MISSION_ITEM_INT":
        return make(
            msg.target_system, msg.target_component, msg.seq, msg.frame, msg.command,
            msg.current, msg.autocontinue, msg.param1, msg.param2, msg.param3, msg.param4,
            msg.x * 1.0e-7, msg.y * 1.0e-7, msg.z,
        )  # fmt: skip
    if kind == "CMD":
        frame = getattr(msg, "Frame", None)
        if frame is None:
            print("Warning: assuming frame is GLOBAL_RELATIVE_ALT")
            frame = GLOBAL_RELATIVE
        return make(
            0, 0, msg.CNum, frame, msg.CId, 0, 1,
            msg.Prm1, msg.Prm2, msg.Prm3, msg.Prm4, msg.Lat, msg.Lng, msg.Alt,
        )  # fmt: skip
    return msg
