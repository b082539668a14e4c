"""Definitions in, Python out: the part of mavwire that reads dialect XML for people who generate
modules.

Message objects never need this package: the native core reads definitions itself. It exists for
``mavgen`` and for the tools that look into definitions through ``mavparse.MAVXML``.
"""

TYPE_CHECKING = False
if TYPE_CHECKING:
    from mavwire.generator import mavcrc, mavparse

__all__ = ["mavcrc", "mavparse"]


def __getattr__(name: str) -> object:
    """The modules that are here as soon as pymavlink's mavutil was imported."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return __import__(f"{__name__}.{name}", fromlist=[name])
