"""Missions, fences and rally points, and the files they are kept in: pymavlink's `mavwp`.

`MAVWPLoader` holds a mission; `MissionItemProtocol_Fence` and `MissionItemProtocol_Rally` hold fences
and rally points as mission items, `MAVFenceLoader` and `MAVRallyLoader` in the messages that
autopilots took before.
"""

import sys

from ._hooks import IN_STANDARD_MODULE, ReplaceableModule, make_replaceable
from ._missions import MAVFenceError, MAVRallyError, MAVWPError
from ._missions.files import get_first_line_from_file
from ._missions.items import (
    MAVWPLoader,
    MissionItemProtocol,
    MissionItemProtocol_Fence,
    MissionItemProtocol_Rally,
)
from ._missions.legacy import MAVFenceLoader, MAVRallyLoader

__all__ = [
    "HAVE_PROTOBUF",
    "MAVFenceError",
    "MAVFenceLoader",
    "MAVRallyError",
    "MAVRallyLoader",
    "MAVWPError",
    "MAVWPLoader",
    "MissionItemProtocol",
    "MissionItemProtocol_Fence",
    "MissionItemProtocol_Rally",
    "get_first_line_from_file",
]


class _Mavwp(ReplaceableModule):
    _users = ("mavwire._missions",)
    _not_called = {  # noqa: RUF012
        **dict.fromkeys(("copy", "time"), IN_STANDARD_MODULE),
        "mavutil": "replace the function in mavwire.mavutil itself",
    }


make_replaceable(sys.modules[__name__], _Mavwp)

HAVE_PROTOBUF = False
"""Always False: pymavlink's protobuf format of missions has no public definition."""
