"""A TLS connection as the non-blocking socket that links read and write."""

from __future__ import annotations

import errno
from _thread import RLock

from .forks import follow_forks

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class TlsPort:
    """Waiting for the peer is no error of its own kind, and several threads may use it, which OpenSSL does not allow."""

    # Another thread was inside OpenSSL when this process was forked: its state is of no use here.
    _is_torn = False

    def __init__(self, port: Any) -> None:
        self._port = port
        # A signal handler may write in the middle of a read.
        self._lock = RLock()
        self.fileno, self.close, self.setblocking = port.fileno, port.close, port.setblocking
        follow_forks(self, TlsPort._renew)

    def recv(self, n: int) -> bytes:
        data: bytes = self._do(self._port.recv, n)
        return data

    def send(self, data: bytes) -> int:
        sent: int = self._do(self._port.send, data)
        return sent

    def _do(self, act: Any, argument: Any) -> Any:
        from ssl import SSLWantReadError, SSLWantWriteError

        with self._lock:
            if self._is_torn:
                raise ConnectionAbortedError(
                    errno.ECONNABORTED, "the TLS connection is the parent process's"
                )
            try:
                return act(argument)
            except (SSLWantReadError, SSLWantWriteError) as error:
                raise BlockingIOError(errno.EAGAIN, "TLS waits for the peer") from error

    def _renew(self) -> None:
        if not self._lock.acquire(blocking=False):  # held by a thread that did not come along
            self._lock, self._is_torn = RLock(), True
        else:
            self._lock.release()
