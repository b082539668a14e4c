"""What dialect stemstudios itself defines. Written by tools/generate_stubs.py."""

LED_CONFIG_MODE_ALL: int = 0
LED_CONFIG_MODE_INDEX: int = 1
LED_CONFIG_MODE_FOLLOW_FLIGHT_MODE: int = 2
LED_CONFIG_MODE_CLEAR: int = 3
LED_CONFIG_MODE_ENUM_END: int

class _Methods:
    pass
