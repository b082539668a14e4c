"""A MAVLink router inside your program: links of any kind, filters, limits, recording, statistics.

`Bridge` runs on a thread that never holds the interpreter's lock. See docs/bridge.md.
"""

from .bridge import Bridge, Kind
from .config_file import load_config
from .endpoints import parse_endpoint
from .errors import BridgeError, ConfigError
from .frames import FrameBatches
from .options import Config, Endpoint, EndpointOptions, Recording

__all__ = [
    "Bridge",
    "BridgeError",
    "Config",
    "ConfigError",
    "Endpoint",
    "EndpointOptions",
    "FrameBatches",
    "Kind",
    "Recording",
    "load_config",
    "parse_endpoint",
]
