"""One transport endpoint per link: sockets, serial ports, telemetry logs, child processes.

`mavwire.mavutil` is the public face of this package; user code imports from there. The modules
here are cut by concern so that a program which opens one UDP port never pays for websockets.
"""

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable as Callable
    from typing import Any as Any
else:
    # For annotations alone. `typing` takes longer to load than all of mavutil.
    Any = Callable = object


def warn(text: str, *arguments: object) -> None:
    """Log a warning. `logging` loads with the first one."""
    import logging

    logging.getLogger("mavwire.mavutil").warning(text, *arguments)
