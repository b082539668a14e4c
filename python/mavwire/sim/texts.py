"""STATUSTEXT: what a vehicle says, in as many chunks as it takes."""

from __future__ import annotations

from mavwire.dialects.v20 import all as mavlink

CHUNK = 50


class Texts:
    """Cuts texts into messages; chunks of one text share an id that is not 0."""

    def __init__(self) -> None:
        self._id = 0

    def messages(self, severity: int, text: str) -> list[mavlink.MAVLink_statustext_message]:
        """The messages that carry a text."""
        data = text.encode()
        if len(data) <= CHUNK:
            return [mavlink.MAVLink_statustext_message(severity, data)]
        self._id = self._id % 65535 + 1
        # A text that ends with its last chunk full is closed by an empty one.
        chunks = [data[at : at + CHUNK] for at in range(0, len(data) + 1, CHUNK)]
        return [
            mavlink.MAVLink_statustext_message(severity, chunk, self._id, number)
            for number, chunk in enumerate(chunks)
        ]
