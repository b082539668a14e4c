"""What can go wrong with a bridge besides an OSError."""

from __future__ import annotations

from mavwire import _native


class ConfigError(ValueError):
    """An option that is wrong; the text says which one and where."""


# Where the system has no bridge the name must be there all the same, for `except`.
BridgeError: type[RuntimeError] = getattr(_native, "BridgeError", RuntimeError)
"""A bridge that cannot do what it was asked for: a name twice, no such link, stopped."""
