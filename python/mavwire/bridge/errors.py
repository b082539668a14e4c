"""What can go wrong with a bridge besides an OSError."""

from __future__ import annotations

from mavwire import _native


class ConfigError(ValueError):
    """An option that is wrong; the text says which one and where. `option` is its name, if it has one."""

    def __init__(self, text: str, option: str = "") -> None:
        super().__init__(text)
        self.option = option

    def within(self, option: str) -> ConfigError:
        """The same about a part of an option."""
        return ConfigError(f"{option}: {self}", option)

    def at(self, place: str) -> ConfigError:
        """The same with where it stands in front."""
        return ConfigError(f"{place}: {self}", self.option)


# Where the system has no bridge the name must be there all the same, for `except`.
BridgeError: type[RuntimeError] = getattr(_native, "BridgeError", RuntimeError)
"""A bridge that cannot do what it was asked for: a name twice, no such link, stopped."""
