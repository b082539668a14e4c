"""Errors of a bridge, besides OSError."""

from __future__ import annotations

from mavwire import _native


class ConfigError(ValueError):
    """An option that is wrong; the text says which one and where."""

    def at(self, place: str) -> ConfigError:
        """The same with the file, table or option in front."""
        return ConfigError(f"{place}: {self}")


# Where the system has no bridge the name must be there all the same, for `except`.
BridgeError: type[RuntimeError] = getattr(_native, "BridgeError", RuntimeError)
"""A bridge that cannot do what it was asked for: a name twice, no such link, stopped."""
