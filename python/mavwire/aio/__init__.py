"""Links for asyncio: everything `mavutil.mavlink_connection` opens, awaited instead of polled.

`async with aio.connect("udpin:0.0.0.0:14550") as link: ...` opens a `Link`. docs/aio.md is the guide.
"""

from .connecting import Connecting, connect
from .errors import CommandError, LinkClosedError, NoVehicleError, ParameterError
from .link import Link
from .stream import Newest, Stream
from .texts import StatusText, Texts

__all__ = [
    "CommandError",
    "Connecting",
    "Link",
    "LinkClosedError",
    "Newest",
    "NoVehicleError",
    "ParameterError",
    "StatusText",
    "Stream",
    "Texts",
    "connect",
]
