"""The types of mavutil, as far as a type checker can know them. Only the running program tells which
dialect is current, and whether there is a link or a log behind a name.
"""

from collections.abc import Iterable
from typing import Any, Literal, overload

from mavwire import _native
from mavwire.dialects import _dialect
from mavwire.links.mavfile import mavfile

class ReceivedMessage(_dialect.MAVLink_message):
    """A message of the current dialect. Its fields are Any; `isinstance` with a message class of a
    dialect module makes them those of the class.
    """

    def __getattr__(self, name: str, /) -> Any: ...

class CurrentMAVLink(_dialect._Link):
    """`mav` of a link: the `MAVLink` of the current dialect, with its `<message>_send`."""

    def parse_char(self, c: _native._BytesLike) -> ReceivedMessage | None: ...
    # Nobody puts other messages into the list.
    def parse_buffer(self, s: _native._BytesLike) -> list[ReceivedMessage] | None: ...  # type: ignore[override]
    def decode(self, msgbuf: bytearray) -> ReceivedMessage: ...
    def __getattr__(self, name: str, /) -> Any: ...

class Connection(mavfile):
    """The result of `mavlink_connection`: the attributes of all links, and as Any those that only some
    kinds of links and logs have.

    A call without a time limit returns None at the end of a log alone: callers need not check for it.
    """

    @overload
    def recv_match(
        self,
        condition: str | None = None,
        type: str | Iterable[str] | None = None,
        *,
        blocking: Literal[True],
        timeout: None = None,
    ) -> ReceivedMessage | Any: ...
    @overload
    def recv_match(
        self,
        condition: str | None = None,
        type: str | Iterable[str] | None = None,
        blocking: bool = False,
        timeout: float | None = None,
    ) -> ReceivedMessage | None: ...
    @overload
    def wait_heartbeat(
        self, blocking: Literal[True] = True, timeout: None = None
    ) -> ReceivedMessage | Any: ...
    @overload
    def wait_heartbeat(
        self, blocking: bool = True, timeout: float | None = None
    ) -> ReceivedMessage | None: ...
    def __getattr__(self, name: str, /) -> Any: ...
