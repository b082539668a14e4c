"""Unix domain socket client links."""

from __future__ import annotations

from . import Any
from .tcp import CONNECT_TIMEOUT, mavtcp


class mavuds(mavtcp):
    """`device` is the path of a listening stream socket; the rest is as with `mavtcp`."""

    _socket_kind = "Unix domain"

    def __init__(
        self,
        device: str,
        autoreconnect: bool = False,
        source_system: int = 255,
        source_component: int = 0,
        retries: int = 6,
        use_native: bool = False,
        reconnect_delay: float = 1,
    ) -> None:
        if not device:
            raise ValueError("Unix domain socket path must be specified")
        self.destination_addr = device
        self._open(f"uds:{device}", autoreconnect, retries, reconnect_delay,
                   source_system, source_component)  # fmt: skip

    def _connect(self) -> Any:
        import socket

        port = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        try:
            port.settimeout(CONNECT_TIMEOUT)
            port.connect(self.destination_addr)
        except OSError:
            port.close()
            raise
        return port
