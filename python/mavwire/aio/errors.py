"""The errors of a link. A time-out is a plain `TimeoutError`."""

from __future__ import annotations

from typing import Any


class LinkClosedError(ConnectionError):
    """Nothing will come any more: the link was closed, or its other end has gone for good.

    `__cause__` is the error of the operating system, if there was one.
    """


def again(error: LinkClosedError) -> LinkClosedError:
    """An error like `error`, for one more who meets it: an error grows whenever it is raised."""
    same = type(error)(*error.args)
    same.__cause__ = error.__cause__
    return same


class EndOfLogError(LinkClosedError):
    """The log has been read."""


class NoVehicleError(RuntimeError):
    """Something is to be sent to the target, and no vehicle was heard that could be it."""


class CommandError(Exception):
    """A vehicle did not accept a command. `ack` is its COMMAND_ACK, `result` its MAV_RESULT."""

    def __init__(self, command: str, result: str, ack: Any) -> None:
        super().__init__(f"{command}: {result}")
        self.ack = ack
        self.result: int = ack.result


class ParameterError(Exception):
    """A vehicle answered to a new value of a parameter with another: `value` is the one it has."""

    def __init__(self, name: str, wanted: float, value: float) -> None:
        super().__init__(f"{name} was not set to {wanted} and is {value}")
        self.name = name
        self.value = value
