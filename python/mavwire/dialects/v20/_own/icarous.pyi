"""What dialect icarous itself defines. Written by tools/generate_stubs.py."""

from collections.abc import Sequence as _Sequence

from mavwire.dialects import _dialect

MAVLINK_MSG_ID_ICAROUS_HEARTBEAT: int = 42000
MAVLINK_MSG_ID_ICAROUS_KINEMATIC_BANDS: int = 42001
ICAROUS_TRACK_BAND_TYPE_NONE: int = 0
ICAROUS_TRACK_BAND_TYPE_NEAR: int = 1
ICAROUS_TRACK_BAND_TYPE_RECOVERY: int = 2
ICAROUS_TRACK_BAND_TYPES_ENUM_END: int
ICAROUS_FMS_STATE_IDLE: int = 0
ICAROUS_FMS_STATE_TAKEOFF: int = 1
ICAROUS_FMS_STATE_CLIMB: int = 2
ICAROUS_FMS_STATE_CRUISE: int = 3
ICAROUS_FMS_STATE_APPROACH: int = 4
ICAROUS_FMS_STATE_LAND: int = 5
ICAROUS_FMS_STATE_ENUM_END: int

class MAVLink_icarous_heartbeat_message(_dialect.MAVLink_message):  # 42000
    status: int  # ICAROUS_FMS_STATE
    def __init__(self, status: int) -> None: ...

class MAVLink_icarous_kinematic_bands_message(_dialect.MAVLink_message):  # 42001
    numBands: int
    type1: int  # ICAROUS_TRACK_BAND_TYPES
    min1: float  # deg
    max1: float  # deg
    type2: int  # ICAROUS_TRACK_BAND_TYPES
    min2: float  # deg
    max2: float  # deg
    type3: int  # ICAROUS_TRACK_BAND_TYPES
    min3: float  # deg
    max3: float  # deg
    type4: int  # ICAROUS_TRACK_BAND_TYPES
    min4: float  # deg
    max4: float  # deg
    type5: int  # ICAROUS_TRACK_BAND_TYPES
    min5: float  # deg
    max5: float  # deg
    def __init__(self, numBands: int, type1: int, min1: float, max1: float, type2: int, min2: float,
        max2: float, type3: int, min3: float, max3: float, type4: int, min4: float, max4: float, type5: int,
        min5: float, max5: float) -> None: ...

class _Methods:
    def icarous_heartbeat_encode(self, status: int) -> MAVLink_icarous_heartbeat_message: ...
    def icarous_heartbeat_send(self, status: int, force_mavlink1: bool = False) -> None: ...
    def icarous_kinematic_bands_encode(self, numBands: int, type1: int, min1: float, max1: float, type2: int,
        min2: float, max2: float, type3: int, min3: float, max3: float, type4: int, min4: float, max4: float,
        type5: int, min5: float, max5: float) -> MAVLink_icarous_kinematic_bands_message: ...
    def icarous_kinematic_bands_send(self, numBands: int, type1: int, min1: float, max1: float, type2: int,
        min2: float, max2: float, type3: int, min3: float, max3: float, type4: int, min4: float, max4: float,
        type5: int, min5: float, max5: float, force_mavlink1: bool = False) -> None: ...
