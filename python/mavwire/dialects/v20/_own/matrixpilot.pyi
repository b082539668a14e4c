"""What dialect matrixpilot itself defines. Written by tools/generate_stubs.py."""

from collections.abc import Sequence as _Sequence

from mavwire.dialects import _dialect

MAVLINK_MSG_ID_SERIAL_UDB_EXTRA_F21: int = 187
MAVLINK_MSG_ID_SERIAL_UDB_EXTRA_F22: int = 188
MAV_PFS_CMD_READ_ALL: int = 0
MAV_PFS_CMD_WRITE_ALL: int = 1
MAV_PFS_CMD_CLEAR_ALL: int = 2
MAV_PFS_CMD_READ_SPECIFIC: int = 3
MAV_PFS_CMD_WRITE_SPECIFIC: int = 4
MAV_PFS_CMD_CLEAR_SPECIFIC: int = 5
MAV_PFS_CMD_DO_NOTHING: int = 6
MAV_PREFLIGHT_STORAGE_ACTION_ENUM_END: int
MAV_CMD_PREFLIGHT_STORAGE_ADVANCED: int = 0

class MAVLink_serial_udb_extra_f21_message(_dialect.MAVLink_message):  # 187
    sue_accel_x_offset: int
    sue_accel_y_offset: int
    sue_accel_z_offset: int
    sue_gyro_x_offset: int
    sue_gyro_y_offset: int
    sue_gyro_z_offset: int
    def __init__(self, sue_accel_x_offset: int, sue_accel_y_offset: int, sue_accel_z_offset: int,
        sue_gyro_x_offset: int, sue_gyro_y_offset: int, sue_gyro_z_offset: int) -> None: ...

class MAVLink_serial_udb_extra_f22_message(_dialect.MAVLink_message):  # 188
    sue_accel_x_at_calibration: int
    sue_accel_y_at_calibration: int
    sue_accel_z_at_calibration: int
    sue_gyro_x_at_calibration: int
    sue_gyro_y_at_calibration: int
    sue_gyro_z_at_calibration: int
    def __init__(self, sue_accel_x_at_calibration: int, sue_accel_y_at_calibration: int,
        sue_accel_z_at_calibration: int, sue_gyro_x_at_calibration: int, sue_gyro_y_at_calibration: int,
        sue_gyro_z_at_calibration: int) -> None: ...

class _Methods:
    def serial_udb_extra_f21_encode(self, sue_accel_x_offset: int, sue_accel_y_offset: int,
        sue_accel_z_offset: int, sue_gyro_x_offset: int, sue_gyro_y_offset: int,
        sue_gyro_z_offset: int) -> MAVLink_serial_udb_extra_f21_message: ...
    def serial_udb_extra_f21_send(self, sue_accel_x_offset: int, sue_accel_y_offset: int,
        sue_accel_z_offset: int, sue_gyro_x_offset: int, sue_gyro_y_offset: int, sue_gyro_z_offset: int,
        force_mavlink1: bool = False) -> None: ...
    def serial_udb_extra_f22_encode(self, sue_accel_x_at_calibration: int, sue_accel_y_at_calibration: int,
        sue_accel_z_at_calibration: int, sue_gyro_x_at_calibration: int, sue_gyro_y_at_calibration: int,
        sue_gyro_z_at_calibration: int) -> MAVLink_serial_udb_extra_f22_message: ...
    def serial_udb_extra_f22_send(self, sue_accel_x_at_calibration: int, sue_accel_y_at_calibration: int,
        sue_accel_z_at_calibration: int, sue_gyro_x_at_calibration: int, sue_gyro_y_at_calibration: int,
        sue_gyro_z_at_calibration: int, force_mavlink1: bool = False) -> None: ...
