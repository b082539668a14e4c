"""What dialect loweheiser itself defines. Written by tools/generate_stubs.py."""

MAV_CMD_LOWEHEISER_SET_STATE: int = 10151
MAV_CMD_ENUM_END: int

class _Methods:
    pass
