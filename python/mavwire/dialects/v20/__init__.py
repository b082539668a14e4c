"""Dialects laid out for MAVLink 2."""

TYPE_CHECKING = False
if not TYPE_CHECKING:

    def __getattr__(name: str) -> object:
        from mavwire.dialects import module_within

        return module_within(__name__, name)
