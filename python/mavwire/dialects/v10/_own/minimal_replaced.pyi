"""What dialect minimal_replaced itself defines. Written by tools/generate_stubs.py."""

MAV_TYPE_VTOL_DUOROTOR: int = 19
MAV_TYPE_VTOL_QUADROTOR: int = 20
MAV_TYPE_VTOL_RESERVED2: int = 22
MAV_TYPE_VTOL_RESERVED3: int = 23
MAV_TYPE_VTOL_RESERVED4: int = 24

class _Methods:
    pass
