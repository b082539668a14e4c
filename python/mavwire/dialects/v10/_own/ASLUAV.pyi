"""What dialect ASLUAV itself defines. Written by tools/generate_stubs.py."""

from collections.abc import Sequence as _Sequence

from mavwire.dialects import _dialect

MAVLINK_MSG_ID_COMMAND_INT_STAMPED: int = 223
MAVLINK_MSG_ID_COMMAND_LONG_STAMPED: int = 224
MAV_CMD_RESET_MPPT: int = 40001
MAV_CMD_PAYLOAD_CONTROL: int = 40002
GSM_LINK_TYPE_NONE: int = 0
GSM_LINK_TYPE_UNKNOWN: int = 1
GSM_LINK_TYPE_2G: int = 2
GSM_LINK_TYPE_3G: int = 3
GSM_LINK_TYPE_4G: int = 4
GSM_LINK_TYPE_ENUM_END: int
GSM_MODEM_TYPE_UNKNOWN: int = 0
GSM_MODEM_TYPE_HUAWEI_E3372: int = 1
GSM_MODEM_TYPE_ENUM_END: int

class MAVLink_command_int_stamped_message(_dialect.MAVLink_message):  # 223
    utc_time: int
    vehicle_timestamp: int
    target_system: int
    target_component: int
    frame: int  # MAV_FRAME
    command: int  # MAV_CMD
    current: int
    autocontinue: int
    param1: float
    param2: float
    param3: float
    param4: float
    x: int
    y: int
    z: float
    def __init__(self, utc_time: int, vehicle_timestamp: int, target_system: int, target_component: int,
        frame: int, command: int, current: int, autocontinue: int, param1: float, param2: float,
        param3: float, param4: float, x: int, y: int, z: float) -> None: ...

class MAVLink_command_long_stamped_message(_dialect.MAVLink_message):  # 224
    utc_time: int
    vehicle_timestamp: int
    target_system: int
    target_component: int
    command: int  # MAV_CMD
    confirmation: int
    param1: float
    param2: float
    param3: float
    param4: float
    param5: float
    param6: float
    param7: float
    def __init__(self, utc_time: int, vehicle_timestamp: int, target_system: int, target_component: int,
        command: int, confirmation: int, param1: float, param2: float, param3: float, param4: float,
        param5: float, param6: float, param7: float) -> None: ...

class _Methods:
    def command_int_stamped_encode(self, utc_time: int, vehicle_timestamp: int, target_system: int,
        target_component: int, frame: int, command: int, current: int, autocontinue: int, param1: float,
        param2: float, param3: float, param4: float, x: int, y: int,
        z: float) -> MAVLink_command_int_stamped_message: ...
    def command_int_stamped_send(self, utc_time: int, vehicle_timestamp: int, target_system: int,
        target_component: int, frame: int, command: int, current: int, autocontinue: int, param1: float,
        param2: float, param3: float, param4: float, x: int, y: int, z: float,
        force_mavlink1: bool = False) -> None: ...
    def command_long_stamped_encode(self, utc_time: int, vehicle_timestamp: int, target_system: int,
        target_component: int, command: int, confirmation: int, param1: float, param2: float, param3: float,
        param4: float, param5: float, param6: float,
        param7: float) -> MAVLink_command_long_stamped_message: ...
    def command_long_stamped_send(self, utc_time: int, vehicle_timestamp: int, target_system: int,
        target_component: int, command: int, confirmation: int, param1: float, param2: float, param3: float,
        param4: float, param5: float, param6: float, param7: float, force_mavlink1: bool = False) -> None: ...
