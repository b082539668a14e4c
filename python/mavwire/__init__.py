"""mavwire: MAVLink for Python at wire speed, compatible with pymavlink 2.4.50.

Importing the package is nearly free; each name below is fetched when it is first used.
"""

TYPE_CHECKING = False
if TYPE_CHECKING:
    from mavwire import aio as aio
    from mavwire import bridge as bridge
    from mavwire import dialects as dialects
    from mavwire import expression as expression
    from mavwire import fleet as fleet
    from mavwire import generator as generator
    from mavwire import lake as lake
    from mavwire import logs as logs
    from mavwire import mavexpression as mavexpression
    from mavwire import mavextra as mavextra
    from mavwire import mavutil as mavutil
    from mavwire import plots as plots
    from mavwire import quaternion as quaternion
    from mavwire import rotmat as rotmat
    from mavwire import shadow as shadow
    from mavwire import sim as sim
    from mavwire import tools as tools
    from mavwire import traffic as traffic
    from mavwire._alias import install_as_pymavlink, uninstall_as_pymavlink
    from mavwire.bridge import Bridge
    from mavwire.logs import LogFormatError, open_log, read, scan, scan_polars

    __version__: str

__all__ = [
    "Bridge",
    "LogFormatError",
    "install_as_pymavlink",
    "open_log",
    "read",
    "scan",
    "scan_polars",
    "uninstall_as_pymavlink",
]

_LAZY = {
    "Bridge": "mavwire.bridge",
    "LogFormatError": "mavwire.logs",
    "open_log": "mavwire.logs",
    "read": "mavwire.logs",
    "scan": "mavwire.logs",
    "scan_polars": "mavwire.logs",
    "install_as_pymavlink": "mavwire._alias",
    "uninstall_as_pymavlink": "mavwire._alias",
}
"""Public name -> the module that has it."""
# mavwire's own, and what pymavlink's mavutil imports: programs find these in the package without an import.
_MODULES = frozenset(
    (
        "aio bridge expression fleet lake logs mavutil plots shadow sim tools traffic "
        "dialects generator mavexpression mavextra quaternion rotmat"
    ).split()
)


def __getattr__(name: str) -> object:
    if name == "__version__":
        value: object = _version()
    elif name in _MODULES:
        value = __import__(f"{__name__}.{name}", fromlist=[name])
    elif name in _LAZY:
        value = getattr(__import__(_LAZY[name], fromlist=[name]), name)
    else:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_LAZY, *_MODULES, "__version__"})


def _version() -> str:
    """The workspace's version: compiled into the native module, which has it from Cargo.toml."""
    from mavwire._native import __version__

    return __version__
