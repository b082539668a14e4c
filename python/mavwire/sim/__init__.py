"""Simulated vehicles for tests and demonstrations, ArduPilot-like and PX4-like.

`Vehicle` is one vehicle as a protocol: bytes and time in, bytes out. `Swarm` is several of them on
one link. `Runner` ties either to links of mavutil and to real time; `mavwire sim` is a command for
it. docs/sim.md says what they can do.
"""

from .impairment import Impairment
from .runner import Runner, serve
from .swarm import Swarm
from .vehicle import Vehicle

__all__ = ["Impairment", "Runner", "Swarm", "Vehicle", "serve"]
