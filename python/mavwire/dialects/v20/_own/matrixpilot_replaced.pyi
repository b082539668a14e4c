"""What dialect matrixpilot_replaced itself defines. Written by tools/generate_stubs.py."""

from collections.abc import Sequence as _Sequence

from mavwire.dialects import _dialect

MAVLINK_MSG_ID_FLEXIFUNCTION_SET: int = 150
MAVLINK_MSG_ID_FLEXIFUNCTION_READ_REQ: int = 151
MAVLINK_MSG_ID_FLEXIFUNCTION_BUFFER_FUNCTION: int = 152
MAVLINK_MSG_ID_FLEXIFUNCTION_BUFFER_FUNCTION_ACK: int = 153
MAVLINK_MSG_ID_FLEXIFUNCTION_DIRECTORY: int = 155
MAVLINK_MSG_ID_FLEXIFUNCTION_DIRECTORY_ACK: int = 156
MAVLINK_MSG_ID_FLEXIFUNCTION_COMMAND: int = 157
MAVLINK_MSG_ID_FLEXIFUNCTION_COMMAND_ACK: int = 158
MAVLINK_MSG_ID_SERIAL_UDB_EXTRA_F2_A: int = 170
MAVLINK_MSG_ID_SERIAL_UDB_EXTRA_F2_B: int = 171
MAVLINK_MSG_ID_SERIAL_UDB_EXTRA_F4: int = 172
MAVLINK_MSG_ID_SERIAL_UDB_EXTRA_F5: int = 173
MAVLINK_MSG_ID_SERIAL_UDB_EXTRA_F6: int = 174
MAVLINK_MSG_ID_SERIAL_UDB_EXTRA_F7: int = 175
MAVLINK_MSG_ID_SERIAL_UDB_EXTRA_F8: int = 176
MAVLINK_MSG_ID_SERIAL_UDB_EXTRA_F13: int = 177
MAVLINK_MSG_ID_SERIAL_UDB_EXTRA_F14: int = 178
MAVLINK_MSG_ID_SERIAL_UDB_EXTRA_F15: int = 179
MAVLINK_MSG_ID_SERIAL_UDB_EXTRA_F16: int = 180
MAVLINK_MSG_ID_ALTITUDES: int = 181
MAVLINK_MSG_ID_AIRSPEEDS: int = 182
MAVLINK_MSG_ID_SERIAL_UDB_EXTRA_F17: int = 183
MAVLINK_MSG_ID_SERIAL_UDB_EXTRA_F18: int = 184
MAVLINK_MSG_ID_SERIAL_UDB_EXTRA_F19: int = 185
MAVLINK_MSG_ID_SERIAL_UDB_EXTRA_F20: int = 186

class MAVLink_flexifunction_set_message(_dialect.MAVLink_message):  # 150
    target_system: int
    target_component: int
    def __init__(self, target_system: int, target_component: int) -> None: ...

class MAVLink_flexifunction_read_req_message(_dialect.MAVLink_message):  # 151
    target_system: int
    target_component: int
    read_req_type: int
    data_index: int
    def __init__(self, target_system: int, target_component: int, read_req_type: int,
        data_index: int) -> None: ...

class MAVLink_flexifunction_buffer_function_message(_dialect.MAVLink_message):  # 152
    target_system: int
    target_component: int
    func_index: int
    func_count: int
    data_address: int
    data_size: int
    data: list[int]
    def __init__(self, target_system: int, target_component: int, func_index: int, func_count: int,
        data_address: int, data_size: int, data: _Sequence[int]) -> None: ...

class MAVLink_flexifunction_buffer_function_ack_message(_dialect.MAVLink_message):  # 153
    target_system: int
    target_component: int
    func_index: int
    result: int
    def __init__(self, target_system: int, target_component: int, func_index: int, result: int) -> None: ...

class MAVLink_flexifunction_directory_message(_dialect.MAVLink_message):  # 155
    target_system: int
    target_component: int
    directory_type: int
    start_index: int
    count: int
    directory_data: list[int]
    def __init__(self, target_system: int, target_component: int, directory_type: int, start_index: int,
        count: int, directory_data: _Sequence[int]) -> None: ...

class MAVLink_flexifunction_directory_ack_message(_dialect.MAVLink_message):  # 156
    target_system: int
    target_component: int
    directory_type: int
    start_index: int
    count: int
    result: int
    def __init__(self, target_system: int, target_component: int, directory_type: int, start_index: int,
        count: int, result: int) -> None: ...

class MAVLink_flexifunction_command_message(_dialect.MAVLink_message):  # 157
    target_system: int
    target_component: int
    command_type: int
    def __init__(self, target_system: int, target_component: int, command_type: int) -> None: ...

class MAVLink_flexifunction_command_ack_message(_dialect.MAVLink_message):  # 158
    command_type: int
    result: int
    def __init__(self, command_type: int, result: int) -> None: ...

class MAVLink_serial_udb_extra_f2_a_message(_dialect.MAVLink_message):  # 170
    sue_time: int
    sue_status: int
    sue_latitude: int
    sue_longitude: int
    sue_altitude: int
    sue_waypoint_index: int
    sue_rmat0: int
    sue_rmat1: int
    sue_rmat2: int
    sue_rmat3: int
    sue_rmat4: int
    sue_rmat5: int
    sue_rmat6: int
    sue_rmat7: int
    sue_rmat8: int
    sue_cog: int
    sue_sog: int
    sue_cpu_load: int
    sue_air_speed_3DIMU: int
    sue_estimated_wind_0: int
    sue_estimated_wind_1: int
    sue_estimated_wind_2: int
    sue_magFieldEarth0: int
    sue_magFieldEarth1: int
    sue_magFieldEarth2: int
    sue_svs: int
    sue_hdop: int
    def __init__(self, sue_time: int, sue_status: int, sue_latitude: int, sue_longitude: int,
        sue_altitude: int, sue_waypoint_index: int, sue_rmat0: int, sue_rmat1: int, sue_rmat2: int,
        sue_rmat3: int, sue_rmat4: int, sue_rmat5: int, sue_rmat6: int, sue_rmat7: int, sue_rmat8: int,
        sue_cog: int, sue_sog: int, sue_cpu_load: int, sue_air_speed_3DIMU: int, sue_estimated_wind_0: int,
        sue_estimated_wind_1: int, sue_estimated_wind_2: int, sue_magFieldEarth0: int,
        sue_magFieldEarth1: int, sue_magFieldEarth2: int, sue_svs: int, sue_hdop: int) -> None: ...

class MAVLink_serial_udb_extra_f2_b_message(_dialect.MAVLink_message):  # 171
    sue_time: int
    sue_pwm_input_1: int
    sue_pwm_input_2: int
    sue_pwm_input_3: int
    sue_pwm_input_4: int
    sue_pwm_input_5: int
    sue_pwm_input_6: int
    sue_pwm_input_7: int
    sue_pwm_input_8: int
    sue_pwm_input_9: int
    sue_pwm_input_10: int
    sue_pwm_input_11: int
    sue_pwm_input_12: int
    sue_pwm_output_1: int
    sue_pwm_output_2: int
    sue_pwm_output_3: int
    sue_pwm_output_4: int
    sue_pwm_output_5: int
    sue_pwm_output_6: int
    sue_pwm_output_7: int
    sue_pwm_output_8: int
    sue_pwm_output_9: int
    sue_pwm_output_10: int
    sue_pwm_output_11: int
    sue_pwm_output_12: int
    sue_imu_location_x: int
    sue_imu_location_y: int
    sue_imu_location_z: int
    sue_location_error_earth_x: int
    sue_location_error_earth_y: int
    sue_location_error_earth_z: int
    sue_flags: int
    sue_osc_fails: int
    sue_imu_velocity_x: int
    sue_imu_velocity_y: int
    sue_imu_velocity_z: int
    sue_waypoint_goal_x: int
    sue_waypoint_goal_y: int
    sue_waypoint_goal_z: int
    sue_aero_x: int
    sue_aero_y: int
    sue_aero_z: int
    sue_barom_temp: int
    sue_barom_press: int
    sue_barom_alt: int
    sue_bat_volt: int
    sue_bat_amp: int
    sue_bat_amp_hours: int
    sue_desired_height: int
    sue_memory_stack_free: int
    def __init__(self, sue_time: int, sue_pwm_input_1: int, sue_pwm_input_2: int, sue_pwm_input_3: int,
        sue_pwm_input_4: int, sue_pwm_input_5: int, sue_pwm_input_6: int, sue_pwm_input_7: int,
        sue_pwm_input_8: int, sue_pwm_input_9: int, sue_pwm_input_10: int, sue_pwm_input_11: int,
        sue_pwm_input_12: int, sue_pwm_output_1: int, sue_pwm_output_2: int, sue_pwm_output_3: int,
        sue_pwm_output_4: int, sue_pwm_output_5: int, sue_pwm_output_6: int, sue_pwm_output_7: int,
        sue_pwm_output_8: int, sue_pwm_output_9: int, sue_pwm_output_10: int, sue_pwm_output_11: int,
        sue_pwm_output_12: int, sue_imu_location_x: int, sue_imu_location_y: int, sue_imu_location_z: int,
        sue_location_error_earth_x: int, sue_location_error_earth_y: int, sue_location_error_earth_z: int,
        sue_flags: int, sue_osc_fails: int, sue_imu_velocity_x: int, sue_imu_velocity_y: int,
        sue_imu_velocity_z: int, sue_waypoint_goal_x: int, sue_waypoint_goal_y: int, sue_waypoint_goal_z: int,
        sue_aero_x: int, sue_aero_y: int, sue_aero_z: int, sue_barom_temp: int, sue_barom_press: int,
        sue_barom_alt: int, sue_bat_volt: int, sue_bat_amp: int, sue_bat_amp_hours: int,
        sue_desired_height: int, sue_memory_stack_free: int) -> None: ...

class MAVLink_serial_udb_extra_f4_message(_dialect.MAVLink_message):  # 172
    sue_ROLL_STABILIZATION_AILERONS: int
    sue_ROLL_STABILIZATION_RUDDER: int
    sue_PITCH_STABILIZATION: int
    sue_YAW_STABILIZATION_RUDDER: int
    sue_YAW_STABILIZATION_AILERON: int
    sue_AILERON_NAVIGATION: int
    sue_RUDDER_NAVIGATION: int
    sue_ALTITUDEHOLD_STABILIZED: int
    sue_ALTITUDEHOLD_WAYPOINT: int
    sue_RACING_MODE: int
    def __init__(self, sue_ROLL_STABILIZATION_AILERONS: int, sue_ROLL_STABILIZATION_RUDDER: int,
        sue_PITCH_STABILIZATION: int, sue_YAW_STABILIZATION_RUDDER: int, sue_YAW_STABILIZATION_AILERON: int,
        sue_AILERON_NAVIGATION: int, sue_RUDDER_NAVIGATION: int, sue_ALTITUDEHOLD_STABILIZED: int,
        sue_ALTITUDEHOLD_WAYPOINT: int, sue_RACING_MODE: int) -> None: ...

class MAVLink_serial_udb_extra_f5_message(_dialect.MAVLink_message):  # 173
    sue_YAWKP_AILERON: float
    sue_YAWKD_AILERON: float
    sue_ROLLKP: float
    sue_ROLLKD: float
    def __init__(self, sue_YAWKP_AILERON: float, sue_YAWKD_AILERON: float, sue_ROLLKP: float,
        sue_ROLLKD: float) -> None: ...

class MAVLink_serial_udb_extra_f6_message(_dialect.MAVLink_message):  # 174
    sue_PITCHGAIN: float
    sue_PITCHKD: float
    sue_RUDDER_ELEV_MIX: float
    sue_ROLL_ELEV_MIX: float
    sue_ELEVATOR_BOOST: float
    def __init__(self, sue_PITCHGAIN: float, sue_PITCHKD: float, sue_RUDDER_ELEV_MIX: float,
        sue_ROLL_ELEV_MIX: float, sue_ELEVATOR_BOOST: float) -> None: ...

class MAVLink_serial_udb_extra_f7_message(_dialect.MAVLink_message):  # 175
    sue_YAWKP_RUDDER: float
    sue_YAWKD_RUDDER: float
    sue_ROLLKP_RUDDER: float
    sue_ROLLKD_RUDDER: float
    sue_RUDDER_BOOST: float
    sue_RTL_PITCH_DOWN: float
    def __init__(self, sue_YAWKP_RUDDER: float, sue_YAWKD_RUDDER: float, sue_ROLLKP_RUDDER: float,
        sue_ROLLKD_RUDDER: float, sue_RUDDER_BOOST: float, sue_RTL_PITCH_DOWN: float) -> None: ...

class MAVLink_serial_udb_extra_f8_message(_dialect.MAVLink_message):  # 176
    sue_HEIGHT_TARGET_MAX: float
    sue_HEIGHT_TARGET_MIN: float
    sue_ALT_HOLD_THROTTLE_MIN: float
    sue_ALT_HOLD_THROTTLE_MAX: float
    sue_ALT_HOLD_PITCH_MIN: float
    sue_ALT_HOLD_PITCH_MAX: float
    sue_ALT_HOLD_PITCH_HIGH: float
    def __init__(self, sue_HEIGHT_TARGET_MAX: float, sue_HEIGHT_TARGET_MIN: float,
        sue_ALT_HOLD_THROTTLE_MIN: float, sue_ALT_HOLD_THROTTLE_MAX: float, sue_ALT_HOLD_PITCH_MIN: float,
        sue_ALT_HOLD_PITCH_MAX: float, sue_ALT_HOLD_PITCH_HIGH: float) -> None: ...

class MAVLink_serial_udb_extra_f13_message(_dialect.MAVLink_message):  # 177
    sue_week_no: int
    sue_lat_origin: int
    sue_lon_origin: int
    sue_alt_origin: int
    def __init__(self, sue_week_no: int, sue_lat_origin: int, sue_lon_origin: int,
        sue_alt_origin: int) -> None: ...

class MAVLink_serial_udb_extra_f14_message(_dialect.MAVLink_message):  # 178
    sue_WIND_ESTIMATION: int
    sue_GPS_TYPE: int
    sue_DR: int
    sue_BOARD_TYPE: int
    sue_AIRFRAME: int
    sue_RCON: int
    sue_TRAP_FLAGS: int
    sue_TRAP_SOURCE: int
    sue_osc_fail_count: int
    sue_CLOCK_CONFIG: int
    sue_FLIGHT_PLAN_TYPE: int
    def __init__(self, sue_WIND_ESTIMATION: int, sue_GPS_TYPE: int, sue_DR: int, sue_BOARD_TYPE: int,
        sue_AIRFRAME: int, sue_RCON: int, sue_TRAP_FLAGS: int, sue_TRAP_SOURCE: int, sue_osc_fail_count: int,
        sue_CLOCK_CONFIG: int, sue_FLIGHT_PLAN_TYPE: int) -> None: ...

class MAVLink_serial_udb_extra_f15_message(_dialect.MAVLink_message):  # 179
    sue_ID_VEHICLE_MODEL_NAME: list[int]
    sue_ID_VEHICLE_REGISTRATION: list[int]
    def __init__(self, sue_ID_VEHICLE_MODEL_NAME: _Sequence[int],
        sue_ID_VEHICLE_REGISTRATION: _Sequence[int]) -> None: ...

class MAVLink_serial_udb_extra_f16_message(_dialect.MAVLink_message):  # 180
    sue_ID_LEAD_PILOT: list[int]
    sue_ID_DIY_DRONES_URL: list[int]
    def __init__(self, sue_ID_LEAD_PILOT: _Sequence[int], sue_ID_DIY_DRONES_URL: _Sequence[int]) -> None: ...

class MAVLink_altitudes_message(_dialect.MAVLink_message):  # 181
    time_boot_ms: int
    alt_gps: int
    alt_imu: int
    alt_barometric: int
    alt_optical_flow: int
    alt_range_finder: int
    alt_extra: int
    def __init__(self, time_boot_ms: int, alt_gps: int, alt_imu: int, alt_barometric: int,
        alt_optical_flow: int, alt_range_finder: int, alt_extra: int) -> None: ...

class MAVLink_airspeeds_message(_dialect.MAVLink_message):  # 182
    time_boot_ms: int
    airspeed_imu: int
    airspeed_pitot: int
    airspeed_hot_wire: int
    airspeed_ultrasonic: int
    aoa: int
    aoy: int
    def __init__(self, time_boot_ms: int, airspeed_imu: int, airspeed_pitot: int, airspeed_hot_wire: int,
        airspeed_ultrasonic: int, aoa: int, aoy: int) -> None: ...

class MAVLink_serial_udb_extra_f17_message(_dialect.MAVLink_message):  # 183
    sue_feed_forward: float
    sue_turn_rate_nav: float
    sue_turn_rate_fbw: float
    def __init__(self, sue_feed_forward: float, sue_turn_rate_nav: float,
        sue_turn_rate_fbw: float) -> None: ...

class MAVLink_serial_udb_extra_f18_message(_dialect.MAVLink_message):  # 184
    angle_of_attack_normal: float
    angle_of_attack_inverted: float
    elevator_trim_normal: float
    elevator_trim_inverted: float
    reference_speed: float
    def __init__(self, angle_of_attack_normal: float, angle_of_attack_inverted: float,
        elevator_trim_normal: float, elevator_trim_inverted: float, reference_speed: float) -> None: ...

class MAVLink_serial_udb_extra_f19_message(_dialect.MAVLink_message):  # 185
    sue_aileron_output_channel: int
    sue_aileron_reversed: int
    sue_elevator_output_channel: int
    sue_elevator_reversed: int
    sue_throttle_output_channel: int
    sue_throttle_reversed: int
    sue_rudder_output_channel: int
    sue_rudder_reversed: int
    def __init__(self, sue_aileron_output_channel: int, sue_aileron_reversed: int,
        sue_elevator_output_channel: int, sue_elevator_reversed: int, sue_throttle_output_channel: int,
        sue_throttle_reversed: int, sue_rudder_output_channel: int, sue_rudder_reversed: int) -> None: ...

class MAVLink_serial_udb_extra_f20_message(_dialect.MAVLink_message):  # 186
    sue_number_of_inputs: int
    sue_trim_value_input_1: int
    sue_trim_value_input_2: int
    sue_trim_value_input_3: int
    sue_trim_value_input_4: int
    sue_trim_value_input_5: int
    sue_trim_value_input_6: int
    sue_trim_value_input_7: int
    sue_trim_value_input_8: int
    sue_trim_value_input_9: int
    sue_trim_value_input_10: int
    sue_trim_value_input_11: int
    sue_trim_value_input_12: int
    def __init__(self, sue_number_of_inputs: int, sue_trim_value_input_1: int, sue_trim_value_input_2: int,
        sue_trim_value_input_3: int, sue_trim_value_input_4: int, sue_trim_value_input_5: int,
        sue_trim_value_input_6: int, sue_trim_value_input_7: int, sue_trim_value_input_8: int,
        sue_trim_value_input_9: int, sue_trim_value_input_10: int, sue_trim_value_input_11: int,
        sue_trim_value_input_12: int) -> None: ...

class _Methods:
    def flexifunction_set_encode(self, target_system: int,
        target_component: int) -> MAVLink_flexifunction_set_message: ...
    def flexifunction_set_send(self, target_system: int, target_component: int,
        force_mavlink1: bool = False) -> None: ...
    def flexifunction_read_req_encode(self, target_system: int, target_component: int, read_req_type: int,
        data_index: int) -> MAVLink_flexifunction_read_req_message: ...
    def flexifunction_read_req_send(self, target_system: int, target_component: int, read_req_type: int,
        data_index: int, force_mavlink1: bool = False) -> None: ...
    def flexifunction_buffer_function_encode(self, target_system: int, target_component: int, func_index: int,
        func_count: int, data_address: int, data_size: int,
        data: _Sequence[int]) -> MAVLink_flexifunction_buffer_function_message: ...
    def flexifunction_buffer_function_send(self, target_system: int, target_component: int, func_index: int,
        func_count: int, data_address: int, data_size: int, data: _Sequence[int],
        force_mavlink1: bool = False) -> None: ...
    def flexifunction_buffer_function_ack_encode(self, target_system: int, target_component: int,
        func_index: int, result: int) -> MAVLink_flexifunction_buffer_function_ack_message: ...
    def flexifunction_buffer_function_ack_send(self, target_system: int, target_component: int,
        func_index: int, result: int, force_mavlink1: bool = False) -> None: ...
    def flexifunction_directory_encode(self, target_system: int, target_component: int, directory_type: int,
        start_index: int, count: int,
        directory_data: _Sequence[int]) -> MAVLink_flexifunction_directory_message: ...
    def flexifunction_directory_send(self, target_system: int, target_component: int, directory_type: int,
        start_index: int, count: int, directory_data: _Sequence[int],
        force_mavlink1: bool = False) -> None: ...
    def flexifunction_directory_ack_encode(self, target_system: int, target_component: int,
        directory_type: int, start_index: int, count: int,
        result: int) -> MAVLink_flexifunction_directory_ack_message: ...
    def flexifunction_directory_ack_send(self, target_system: int, target_component: int, directory_type: int,
        start_index: int, count: int, result: int, force_mavlink1: bool = False) -> None: ...
    def flexifunction_command_encode(self, target_system: int, target_component: int,
        command_type: int) -> MAVLink_flexifunction_command_message: ...
    def flexifunction_command_send(self, target_system: int, target_component: int, command_type: int,
        force_mavlink1: bool = False) -> None: ...
    def flexifunction_command_ack_encode(self, command_type: int,
        result: int) -> MAVLink_flexifunction_command_ack_message: ...
    def flexifunction_command_ack_send(self, command_type: int, result: int,
        force_mavlink1: bool = False) -> None: ...
    def serial_udb_extra_f2_a_encode(self, sue_time: int, sue_status: int, sue_latitude: int,
        sue_longitude: int, sue_altitude: int, sue_waypoint_index: int, sue_rmat0: int, sue_rmat1: int,
        sue_rmat2: int, sue_rmat3: int, sue_rmat4: int, sue_rmat5: int, sue_rmat6: int, sue_rmat7: int,
        sue_rmat8: int, sue_cog: int, sue_sog: int, sue_cpu_load: int, sue_air_speed_3DIMU: int,
        sue_estimated_wind_0: int, sue_estimated_wind_1: int, sue_estimated_wind_2: int,
        sue_magFieldEarth0: int, sue_magFieldEarth1: int, sue_magFieldEarth2: int, sue_svs: int,
        sue_hdop: int) -> MAVLink_serial_udb_extra_f2_a_message: ...
    def serial_udb_extra_f2_a_send(self, sue_time: int, sue_status: int, sue_latitude: int,
        sue_longitude: int, sue_altitude: int, sue_waypoint_index: int, sue_rmat0: int, sue_rmat1: int,
        sue_rmat2: int, sue_rmat3: int, sue_rmat4: int, sue_rmat5: int, sue_rmat6: int, sue_rmat7: int,
        sue_rmat8: int, sue_cog: int, sue_sog: int, sue_cpu_load: int, sue_air_speed_3DIMU: int,
        sue_estimated_wind_0: int, sue_estimated_wind_1: int, sue_estimated_wind_2: int,
        sue_magFieldEarth0: int, sue_magFieldEarth1: int, sue_magFieldEarth2: int, sue_svs: int,
        sue_hdop: int, force_mavlink1: bool = False) -> None: ...
    def serial_udb_extra_f2_b_encode(self, sue_time: int, sue_pwm_input_1: int, sue_pwm_input_2: int,
        sue_pwm_input_3: int, sue_pwm_input_4: int, sue_pwm_input_5: int, sue_pwm_input_6: int,
        sue_pwm_input_7: int, sue_pwm_input_8: int, sue_pwm_input_9: int, sue_pwm_input_10: int,
        sue_pwm_input_11: int, sue_pwm_input_12: int, sue_pwm_output_1: int, sue_pwm_output_2: int,
        sue_pwm_output_3: int, sue_pwm_output_4: int, sue_pwm_output_5: int, sue_pwm_output_6: int,
        sue_pwm_output_7: int, sue_pwm_output_8: int, sue_pwm_output_9: int, sue_pwm_output_10: int,
        sue_pwm_output_11: int, sue_pwm_output_12: int, sue_imu_location_x: int, sue_imu_location_y: int,
        sue_imu_location_z: int, sue_location_error_earth_x: int, sue_location_error_earth_y: int,
        sue_location_error_earth_z: int, sue_flags: int, sue_osc_fails: int, sue_imu_velocity_x: int,
        sue_imu_velocity_y: int, sue_imu_velocity_z: int, sue_waypoint_goal_x: int, sue_waypoint_goal_y: int,
        sue_waypoint_goal_z: int, sue_aero_x: int, sue_aero_y: int, sue_aero_z: int, sue_barom_temp: int,
        sue_barom_press: int, sue_barom_alt: int, sue_bat_volt: int, sue_bat_amp: int, sue_bat_amp_hours: int,
        sue_desired_height: int, sue_memory_stack_free: int) -> MAVLink_serial_udb_extra_f2_b_message: ...
    def serial_udb_extra_f2_b_send(self, sue_time: int, sue_pwm_input_1: int, sue_pwm_input_2: int,
        sue_pwm_input_3: int, sue_pwm_input_4: int, sue_pwm_input_5: int, sue_pwm_input_6: int,
        sue_pwm_input_7: int, sue_pwm_input_8: int, sue_pwm_input_9: int, sue_pwm_input_10: int,
        sue_pwm_input_11: int, sue_pwm_input_12: int, sue_pwm_output_1: int, sue_pwm_output_2: int,
        sue_pwm_output_3: int, sue_pwm_output_4: int, sue_pwm_output_5: int, sue_pwm_output_6: int,
        sue_pwm_output_7: int, sue_pwm_output_8: int, sue_pwm_output_9: int, sue_pwm_output_10: int,
        sue_pwm_output_11: int, sue_pwm_output_12: int, sue_imu_location_x: int, sue_imu_location_y: int,
        sue_imu_location_z: int, sue_location_error_earth_x: int, sue_location_error_earth_y: int,
        sue_location_error_earth_z: int, sue_flags: int, sue_osc_fails: int, sue_imu_velocity_x: int,
        sue_imu_velocity_y: int, sue_imu_velocity_z: int, sue_waypoint_goal_x: int, sue_waypoint_goal_y: int,
        sue_waypoint_goal_z: int, sue_aero_x: int, sue_aero_y: int, sue_aero_z: int, sue_barom_temp: int,
        sue_barom_press: int, sue_barom_alt: int, sue_bat_volt: int, sue_bat_amp: int, sue_bat_amp_hours: int,
        sue_desired_height: int, sue_memory_stack_free: int, force_mavlink1: bool = False) -> None: ...
    def serial_udb_extra_f4_encode(self, sue_ROLL_STABILIZATION_AILERONS: int,
        sue_ROLL_STABILIZATION_RUDDER: int, sue_PITCH_STABILIZATION: int, sue_YAW_STABILIZATION_RUDDER: int,
        sue_YAW_STABILIZATION_AILERON: int, sue_AILERON_NAVIGATION: int, sue_RUDDER_NAVIGATION: int,
        sue_ALTITUDEHOLD_STABILIZED: int, sue_ALTITUDEHOLD_WAYPOINT: int,
        sue_RACING_MODE: int) -> MAVLink_serial_udb_extra_f4_message: ...
    def serial_udb_extra_f4_send(self, sue_ROLL_STABILIZATION_AILERONS: int,
        sue_ROLL_STABILIZATION_RUDDER: int, sue_PITCH_STABILIZATION: int, sue_YAW_STABILIZATION_RUDDER: int,
        sue_YAW_STABILIZATION_AILERON: int, sue_AILERON_NAVIGATION: int, sue_RUDDER_NAVIGATION: int,
        sue_ALTITUDEHOLD_STABILIZED: int, sue_ALTITUDEHOLD_WAYPOINT: int, sue_RACING_MODE: int,
        force_mavlink1: bool = False) -> None: ...
    def serial_udb_extra_f5_encode(self, sue_YAWKP_AILERON: float, sue_YAWKD_AILERON: float,
        sue_ROLLKP: float, sue_ROLLKD: float) -> MAVLink_serial_udb_extra_f5_message: ...
    def serial_udb_extra_f5_send(self, sue_YAWKP_AILERON: float, sue_YAWKD_AILERON: float, sue_ROLLKP: float,
        sue_ROLLKD: float, force_mavlink1: bool = False) -> None: ...
    def serial_udb_extra_f6_encode(self, sue_PITCHGAIN: float, sue_PITCHKD: float, sue_RUDDER_ELEV_MIX: float,
        sue_ROLL_ELEV_MIX: float, sue_ELEVATOR_BOOST: float) -> MAVLink_serial_udb_extra_f6_message: ...
    def serial_udb_extra_f6_send(self, sue_PITCHGAIN: float, sue_PITCHKD: float, sue_RUDDER_ELEV_MIX: float,
        sue_ROLL_ELEV_MIX: float, sue_ELEVATOR_BOOST: float, force_mavlink1: bool = False) -> None: ...
    def serial_udb_extra_f7_encode(self, sue_YAWKP_RUDDER: float, sue_YAWKD_RUDDER: float,
        sue_ROLLKP_RUDDER: float, sue_ROLLKD_RUDDER: float, sue_RUDDER_BOOST: float,
        sue_RTL_PITCH_DOWN: float) -> MAVLink_serial_udb_extra_f7_message: ...
    def serial_udb_extra_f7_send(self, sue_YAWKP_RUDDER: float, sue_YAWKD_RUDDER: float,
        sue_ROLLKP_RUDDER: float, sue_ROLLKD_RUDDER: float, sue_RUDDER_BOOST: float,
        sue_RTL_PITCH_DOWN: float, force_mavlink1: bool = False) -> None: ...
    def serial_udb_extra_f8_encode(self, sue_HEIGHT_TARGET_MAX: float, sue_HEIGHT_TARGET_MIN: float,
        sue_ALT_HOLD_THROTTLE_MIN: float, sue_ALT_HOLD_THROTTLE_MAX: float, sue_ALT_HOLD_PITCH_MIN: float,
        sue_ALT_HOLD_PITCH_MAX: float,
        sue_ALT_HOLD_PITCH_HIGH: float) -> MAVLink_serial_udb_extra_f8_message: ...
    def serial_udb_extra_f8_send(self, sue_HEIGHT_TARGET_MAX: float, sue_HEIGHT_TARGET_MIN: float,
        sue_ALT_HOLD_THROTTLE_MIN: float, sue_ALT_HOLD_THROTTLE_MAX: float, sue_ALT_HOLD_PITCH_MIN: float,
        sue_ALT_HOLD_PITCH_MAX: float, sue_ALT_HOLD_PITCH_HIGH: float,
        force_mavlink1: bool = False) -> None: ...
    def serial_udb_extra_f13_encode(self, sue_week_no: int, sue_lat_origin: int, sue_lon_origin: int,
        sue_alt_origin: int) -> MAVLink_serial_udb_extra_f13_message: ...
    def serial_udb_extra_f13_send(self, sue_week_no: int, sue_lat_origin: int, sue_lon_origin: int,
        sue_alt_origin: int, force_mavlink1: bool = False) -> None: ...
    def serial_udb_extra_f14_encode(self, sue_WIND_ESTIMATION: int, sue_GPS_TYPE: int, sue_DR: int,
        sue_BOARD_TYPE: int, sue_AIRFRAME: int, sue_RCON: int, sue_TRAP_FLAGS: int, sue_TRAP_SOURCE: int,
        sue_osc_fail_count: int, sue_CLOCK_CONFIG: int,
        sue_FLIGHT_PLAN_TYPE: int) -> MAVLink_serial_udb_extra_f14_message: ...
    def serial_udb_extra_f14_send(self, sue_WIND_ESTIMATION: int, sue_GPS_TYPE: int, sue_DR: int,
        sue_BOARD_TYPE: int, sue_AIRFRAME: int, sue_RCON: int, sue_TRAP_FLAGS: int, sue_TRAP_SOURCE: int,
        sue_osc_fail_count: int, sue_CLOCK_CONFIG: int, sue_FLIGHT_PLAN_TYPE: int,
        force_mavlink1: bool = False) -> None: ...
    def serial_udb_extra_f15_encode(self, sue_ID_VEHICLE_MODEL_NAME: _Sequence[int],
        sue_ID_VEHICLE_REGISTRATION: _Sequence[int]) -> MAVLink_serial_udb_extra_f15_message: ...
    def serial_udb_extra_f15_send(self, sue_ID_VEHICLE_MODEL_NAME: _Sequence[int],
        sue_ID_VEHICLE_REGISTRATION: _Sequence[int], force_mavlink1: bool = False) -> None: ...
    def serial_udb_extra_f16_encode(self, sue_ID_LEAD_PILOT: _Sequence[int],
        sue_ID_DIY_DRONES_URL: _Sequence[int]) -> MAVLink_serial_udb_extra_f16_message: ...
    def serial_udb_extra_f16_send(self, sue_ID_LEAD_PILOT: _Sequence[int],
        sue_ID_DIY_DRONES_URL: _Sequence[int], force_mavlink1: bool = False) -> None: ...
    def altitudes_encode(self, time_boot_ms: int, alt_gps: int, alt_imu: int, alt_barometric: int,
        alt_optical_flow: int, alt_range_finder: int, alt_extra: int) -> MAVLink_altitudes_message: ...
    def altitudes_send(self, time_boot_ms: int, alt_gps: int, alt_imu: int, alt_barometric: int,
        alt_optical_flow: int, alt_range_finder: int, alt_extra: int,
        force_mavlink1: bool = False) -> None: ...
    def airspeeds_encode(self, time_boot_ms: int, airspeed_imu: int, airspeed_pitot: int,
        airspeed_hot_wire: int, airspeed_ultrasonic: int, aoa: int,
        aoy: int) -> MAVLink_airspeeds_message: ...
    def airspeeds_send(self, time_boot_ms: int, airspeed_imu: int, airspeed_pitot: int,
        airspeed_hot_wire: int, airspeed_ultrasonic: int, aoa: int, aoy: int,
        force_mavlink1: bool = False) -> None: ...
    def serial_udb_extra_f17_encode(self, sue_feed_forward: float, sue_turn_rate_nav: float,
        sue_turn_rate_fbw: float) -> MAVLink_serial_udb_extra_f17_message: ...
    def serial_udb_extra_f17_send(self, sue_feed_forward: float, sue_turn_rate_nav: float,
        sue_turn_rate_fbw: float, force_mavlink1: bool = False) -> None: ...
    def serial_udb_extra_f18_encode(self, angle_of_attack_normal: float, angle_of_attack_inverted: float,
        elevator_trim_normal: float, elevator_trim_inverted: float,
        reference_speed: float) -> MAVLink_serial_udb_extra_f18_message: ...
    def serial_udb_extra_f18_send(self, angle_of_attack_normal: float, angle_of_attack_inverted: float,
        elevator_trim_normal: float, elevator_trim_inverted: float, reference_speed: float,
        force_mavlink1: bool = False) -> None: ...
    def serial_udb_extra_f19_encode(self, sue_aileron_output_channel: int, sue_aileron_reversed: int,
        sue_elevator_output_channel: int, sue_elevator_reversed: int, sue_throttle_output_channel: int,
        sue_throttle_reversed: int, sue_rudder_output_channel: int,
        sue_rudder_reversed: int) -> MAVLink_serial_udb_extra_f19_message: ...
    def serial_udb_extra_f19_send(self, sue_aileron_output_channel: int, sue_aileron_reversed: int,
        sue_elevator_output_channel: int, sue_elevator_reversed: int, sue_throttle_output_channel: int,
        sue_throttle_reversed: int, sue_rudder_output_channel: int, sue_rudder_reversed: int,
        force_mavlink1: bool = False) -> None: ...
    def serial_udb_extra_f20_encode(self, sue_number_of_inputs: int, sue_trim_value_input_1: int,
        sue_trim_value_input_2: int, sue_trim_value_input_3: int, sue_trim_value_input_4: int,
        sue_trim_value_input_5: int, sue_trim_value_input_6: int, sue_trim_value_input_7: int,
        sue_trim_value_input_8: int, sue_trim_value_input_9: int, sue_trim_value_input_10: int,
        sue_trim_value_input_11: int,
        sue_trim_value_input_12: int) -> MAVLink_serial_udb_extra_f20_message: ...
    def serial_udb_extra_f20_send(self, sue_number_of_inputs: int, sue_trim_value_input_1: int,
        sue_trim_value_input_2: int, sue_trim_value_input_3: int, sue_trim_value_input_4: int,
        sue_trim_value_input_5: int, sue_trim_value_input_6: int, sue_trim_value_input_7: int,
        sue_trim_value_input_8: int, sue_trim_value_input_9: int, sue_trim_value_input_10: int,
        sue_trim_value_input_11: int, sue_trim_value_input_12: int, force_mavlink1: bool = False) -> None: ...
