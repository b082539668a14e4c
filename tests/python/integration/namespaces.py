"""Hosts in network namespaces of their own, with cables between them that can be pulled."""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
import threading
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from unit.bridge_tools import LIMIT, wait_until

CLONE_NEWNET = 0x4000_0000
NO_CARD = "02:00:00:00:00:99"


class Host:
    """A network namespace, which a sleeping process holds."""

    def __init__(self) -> None:
        self._holder = subprocess.Popen(
            ["unshare", "--net", "sleep", "1000"], stderr=subprocess.DEVNULL
        )
        own = os.readlink("/proc/self/ns/net")
        try:
            wait_until("it", lambda: self._holder.poll() is not None or self._path_leads_from(own))
            if self._holder.poll() is not None:
                pytest.skip("network namespaces need more rights than there are here")
            self._file = os.open(f"/proc/{self.pid}/ns/net", os.O_RDONLY)
        except BaseException:
            self.close()
            raise

    def _path_leads_from(self, own: str) -> bool:
        return os.readlink(f"/proc/{self.pid}/ns/net") != own

    @property
    def pid(self) -> int:
        return self._holder.pid

    @contextmanager
    def inside(self) -> Iterator[None]:
        """Sockets that this thread opens belong to the host."""
        libc = ctypes.CDLL(None, use_errno=True)
        own = os.open(f"/proc/self/task/{threading.get_native_id()}/ns/net", os.O_RDONLY)
        try:
            assert libc.setns(self._file, CLONE_NEWNET) == 0, os.strerror(ctypes.get_errno())
            try:
                yield
            finally:
                assert libc.setns(own, CLONE_NEWNET) == 0
        finally:
            os.close(own)

    def run(self, *command: str) -> None:
        """Run a command on the host."""
        with self.inside():
            subprocess.run(command, check=True, capture_output=True)

    def close(self) -> None:
        self._holder.kill()
        self._holder.wait(LIMIT)


@contextmanager
def hosts(count: int) -> Iterator[list[Host]]:
    """So many hosts without cables."""
    if os.name != "posix" or not hasattr(os, "geteuid") or os.geteuid() != 0:
        pytest.skip("network namespaces need root")
    for tool in ("ip", "unshare"):
        if shutil.which(tool) is None:
            pytest.skip(f"no {tool}: apt-get install iproute2 util-linux")
    made: list[Host] = []
    try:
        for _ in range(count):
            made.append(Host())
            made[-1].run("ip", "link", "set", "lo", "up")
        yield made
    finally:
        for host in made:
            host.close()


class Cable:
    """Between two hosts, which are 10.`net`.0.1 and 10.`net`.0.2 on it."""

    def __init__(self, left: Host, right: Host, net: int) -> None:
        self._name = f"c{net}"
        self.left, self.right = f"10.{net}.0.1", f"10.{net}.0.2"
        self._ends = ((left, self.right), (right, self.left))
        ends = ["ip", "link", "add", self._name, "netns", str(left.pid), "type", "veth",
                "peer", "name", self._name, "netns", str(right.pid)]  # fmt: skip
        done = subprocess.run(ends, capture_output=True, text=True, check=False)
        if done.returncode:
            pytest.skip(f"no cables here: {done.stderr.strip()}")
        for host, address in ((left, self.left), (right, self.right)):
            host.run("ip", "address", "add", f"{address}/24", "dev", self._name)
            host.run("ip", "link", "set", self._name, "up")

    def pull(self) -> None:
        """Nothing passes any more, and neither host is told: what it sends is for a card that is not there."""
        for host, other in self._ends:
            host.run("ip", "neighbour", "replace", other, "lladdr", NO_CARD, "dev", self._name,
                     "nud", "permanent")  # fmt: skip

    def plug(self) -> None:
        """As before."""
        for host, other in self._ends:
            host.run("ip", "neighbour", "del", other, "dev", self._name)
