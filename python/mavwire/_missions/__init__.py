"""Missions, fences and rally points on the ground: lists of them and the files they are kept in.

`mavwire.mavwp` offers all of it under pymavlink's names.
"""


class PlanError(ValueError):
    """`message` says what is wrong; the text of the error says where, too: (file:line)."""

    def __init__(self, msg: str, where: str = "") -> None:
        super().__init__(f"{msg} ({where})" if where else msg)
        self.message = msg


class MAVWPError(PlanError):
    """A mission, or its file, that is wrong."""


class MAVRallyError(PlanError):
    """A file of rally points that is wrong."""


class MAVFenceError(PlanError):
    """A file of fence points that is wrong."""
