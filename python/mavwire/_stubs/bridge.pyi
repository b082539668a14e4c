"""The bridge, as `mavwire._native` has it."""

from collections.abc import Iterator
from typing import Any, final

from mavwire._native import Dialect, LogColumns, Message
from mavwire.bridge.options import EndpointOptions, Recording, Settings
from mavwire.logs.selection import Selection
from mavwire.logs.table import Table

class BridgeError(RuntimeError):
    """A bridge that cannot do what it was asked for: a name twice, no such link, stopped."""

@final
class BridgeCore:
    """A running bridge."""

    def __new__(
        cls, dialect: Dialect, settings: Settings, recording: Recording | None
    ) -> BridgeCore:
        """Starts one without links. OSError for the recording."""

    def add(self, link: EndpointOptions) -> None:
        """Adds a link. OSError with its name if it cannot be opened, BridgeError."""

    def remove(self, name: str) -> None:
        """Removes a link. BridgeError if there is none of that name."""

    def stats(self) -> dict[str, Any]:
        """Everything that is counted, as dictionaries and lists. BridgeError if it has stopped."""

    def write(self, frames: bytes) -> None:
        """Routes whole frames as if they came over a link of their own. BridgeError."""

    def latest(self, msgid: int, sysid: int | None, compid: int | None) -> Message | None:
        """The newest message of an id, from a system and a component or from any."""

    def latest_text(self, sysid: int, compid: int) -> bytes | None:
        """The last complete status text of a component."""

    def tap(self, messages: list[int] | None, systems: list[int] | None) -> BridgeTap:
        """The frames from now on, of some message ids and systems or of all. BridgeError in a fork."""

    def kinds(self, most: int) -> tuple[list[tuple[int, str, int, int, int, float, str]], int]:
        """The newest kinds of messages: id, name, system, component, how many, time and link of the
        last one; and how many kinds there are besides.
        """

    def stop(self) -> None:
        """Stops the bridge and waits for that."""

@final
class BridgeTap:
    """Frames of a bridge that come by."""

    def next(self, max_batch: int, max_latency: float, timeout: float | None) -> FrameBatch | None:
        """The next frames: empty after `timeout` seconds without any, None at the end."""

    @property
    def dropped(self) -> int:
        """Frames that nobody fetched in time."""

    def close(self) -> None:
        """Ends it."""

@final
class FrameBatch:
    """Frames in the order they came. Iterating gives messages."""

    def __len__(self) -> int: ...
    def __iter__(self) -> Iterator[Message]: ...
    @property
    def raw(self) -> bytes:
        """All frames, one behind the other."""

    @property
    def times(self) -> list[float]:
        """When each arrived; seconds since 1970."""

    @property
    def links(self) -> list[str]:
        """Name of the link that each came over; `program` for what `send` sent."""

    @property
    def ids(self) -> list[tuple[int, int, int]]:
        """`(system, component, message id)` of each."""

    def frames(self) -> list[bytes]:
        """The bytes of each frame."""

    def tables(
        self, *, units: str | None = None, enums: str | None = None, invalid: str | None = None
    ) -> dict[str, Table]:
        """A table for each message type, as `mavwire.read` gives of a log; ValueError for another
        word than its `units`, `enums` and `invalid` have. Parts of a long text stay rows of their own.
        """

    def columns(self, query: Selection) -> LogColumns:
        """The frames as a run over a log, for `tables`."""

    def messages(self) -> list[Message]:
        """A message object for each frame, its time in `_timestamp`."""
