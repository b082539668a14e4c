"""What dialect ASLUAV itself defines. Written by tools/generate_stubs.py."""

from collections.abc import Sequence as _Sequence

from mavwire.dialects import _dialect

MAVLINK_MSG_ID_COMMAND_INT_STAMPED: int = 223
MAVLINK_MSG_ID_COMMAND_LONG_STAMPED: int = 224
MAVLINK_MSG_ID_SENS_POWER: int = 8002
MAVLINK_MSG_ID_SENS_MPPT: int = 8003
MAVLINK_MSG_ID_ASLCTRL_DATA: int = 8004
MAVLINK_MSG_ID_ASLCTRL_DEBUG: int = 8005
MAVLINK_MSG_ID_ASLUAV_STATUS: int = 8006
MAVLINK_MSG_ID_EKF_EXT: int = 8007
MAVLINK_MSG_ID_ASL_OBCTRL: int = 8008
MAVLINK_MSG_ID_SENS_ATMOS: int = 8009
MAVLINK_MSG_ID_SENS_BATMON: int = 8010
MAVLINK_MSG_ID_FW_SOARING_DATA: int = 8011
MAVLINK_MSG_ID_SENSORPOD_STATUS: int = 8012
MAVLINK_MSG_ID_SENS_POWER_BOARD: int = 8013
MAVLINK_MSG_ID_GSM_LINK_STATUS: int = 8014
MAVLINK_MSG_ID_SATCOM_LINK_STATUS: int = 8015
MAVLINK_MSG_ID_SENSOR_AIRFLOW_ANGLES: int = 8016
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

class MAVLink_sens_power_message(_dialect.MAVLink_message):  # 8002
    adc121_vspb_volt: float  # V
    adc121_cspb_amp: float  # A
    adc121_cs1_amp: float  # A
    adc121_cs2_amp: float  # A
    def __init__(self, adc121_vspb_volt: float, adc121_cspb_amp: float, adc121_cs1_amp: float,
        adc121_cs2_amp: float) -> None: ...

class MAVLink_sens_mppt_message(_dialect.MAVLink_message):  # 8003
    mppt_timestamp: int  # us
    mppt1_volt: float  # V
    mppt1_amp: float  # A
    mppt1_pwm: int  # us
    mppt1_status: int
    mppt2_volt: float  # V
    mppt2_amp: float  # A
    mppt2_pwm: int  # us
    mppt2_status: int
    mppt3_volt: float  # V
    mppt3_amp: float  # A
    mppt3_pwm: int  # us
    mppt3_status: int
    def __init__(self, mppt_timestamp: int, mppt1_volt: float, mppt1_amp: float, mppt1_pwm: int,
        mppt1_status: int, mppt2_volt: float, mppt2_amp: float, mppt2_pwm: int, mppt2_status: int,
        mppt3_volt: float, mppt3_amp: float, mppt3_pwm: int, mppt3_status: int) -> None: ...

class MAVLink_aslctrl_data_message(_dialect.MAVLink_message):  # 8004
    timestamp: int  # us
    aslctrl_mode: int
    h: float
    hRef: float
    hRef_t: float
    PitchAngle: float  # deg
    PitchAngleRef: float  # deg
    q: float
    qRef: float
    uElev: float
    uThrot: float
    uThrot2: float
    nZ: float
    AirspeedRef: float  # m/s
    SpoilersEngaged: int
    YawAngle: float  # deg
    YawAngleRef: float  # deg
    RollAngle: float  # deg
    RollAngleRef: float  # deg
    p: float
    pRef: float
    r: float
    rRef: float
    uAil: float
    uRud: float
    def __init__(self, timestamp: int, aslctrl_mode: int, h: float, hRef: float, hRef_t: float,
        PitchAngle: float, PitchAngleRef: float, q: float, qRef: float, uElev: float, uThrot: float,
        uThrot2: float, nZ: float, AirspeedRef: float, SpoilersEngaged: int, YawAngle: float,
        YawAngleRef: float, RollAngle: float, RollAngleRef: float, p: float, pRef: float, r: float,
        rRef: float, uAil: float, uRud: float) -> None: ...

class MAVLink_aslctrl_debug_message(_dialect.MAVLink_message):  # 8005
    i32_1: int
    i8_1: int
    i8_2: int
    f_1: float
    f_2: float
    f_3: float
    f_4: float
    f_5: float
    f_6: float
    f_7: float
    f_8: float
    def __init__(self, i32_1: int, i8_1: int, i8_2: int, f_1: float, f_2: float, f_3: float, f_4: float,
        f_5: float, f_6: float, f_7: float, f_8: float) -> None: ...

class MAVLink_asluav_status_message(_dialect.MAVLink_message):  # 8006
    LED_status: int
    SATCOM_status: int
    Servo_status: list[int]
    Motor_rpm: float
    def __init__(self, LED_status: int, SATCOM_status: int, Servo_status: _Sequence[int],
        Motor_rpm: float) -> None: ...

class MAVLink_ekf_ext_message(_dialect.MAVLink_message):  # 8007
    timestamp: int  # us
    Windspeed: float  # m/s
    WindDir: float  # rad
    WindZ: float  # m/s
    Airspeed: float  # m/s
    beta: float  # rad
    alpha: float  # rad
    def __init__(self, timestamp: int, Windspeed: float, WindDir: float, WindZ: float, Airspeed: float,
        beta: float, alpha: float) -> None: ...

class MAVLink_asl_obctrl_message(_dialect.MAVLink_message):  # 8008
    timestamp: int  # us
    uElev: float
    uThrot: float
    uThrot2: float
    uAilL: float
    uAilR: float
    uRud: float
    obctrl_status: int
    def __init__(self, timestamp: int, uElev: float, uThrot: float, uThrot2: float, uAilL: float,
        uAilR: float, uRud: float, obctrl_status: int) -> None: ...

class MAVLink_sens_atmos_message(_dialect.MAVLink_message):  # 8009
    timestamp: int  # us
    TempAmbient: float  # degC
    Humidity: float  # %
    def __init__(self, timestamp: int, TempAmbient: float, Humidity: float) -> None: ...

class MAVLink_sens_batmon_message(_dialect.MAVLink_message):  # 8010
    batmon_timestamp: int  # us
    temperature: float  # degC
    voltage: int  # mV
    current: int  # mA
    SoC: int
    batterystatus: int
    serialnumber: int
    safetystatus: int
    operationstatus: int
    cellvoltage1: int  # mV
    cellvoltage2: int  # mV
    cellvoltage3: int  # mV
    cellvoltage4: int  # mV
    cellvoltage5: int  # mV
    cellvoltage6: int  # mV
    def __init__(self, batmon_timestamp: int, temperature: float, voltage: int, current: int, SoC: int,
        batterystatus: int, serialnumber: int, safetystatus: int, operationstatus: int, cellvoltage1: int,
        cellvoltage2: int, cellvoltage3: int, cellvoltage4: int, cellvoltage5: int,
        cellvoltage6: int) -> None: ...

class MAVLink_fw_soaring_data_message(_dialect.MAVLink_message):  # 8011
    timestamp: int  # ms
    timestampModeChanged: int  # ms
    xW: float  # m/s
    xR: float  # m
    xLat: float  # deg
    xLon: float  # deg
    VarW: float
    VarR: float
    VarLat: float
    VarLon: float
    LoiterRadius: float  # m
    LoiterDirection: float
    DistToSoarPoint: float  # m
    vSinkExp: float  # m/s
    z1_LocalUpdraftSpeed: float  # m/s
    z2_DeltaRoll: float  # deg
    z1_exp: float
    z2_exp: float
    ThermalGSNorth: float  # m/s
    ThermalGSEast: float  # m/s
    TSE_dot: float  # m/s
    DebugVar1: float
    DebugVar2: float
    ControlMode: int
    valid: int
    def __init__(self, timestamp: int, timestampModeChanged: int, xW: float, xR: float, xLat: float,
        xLon: float, VarW: float, VarR: float, VarLat: float, VarLon: float, LoiterRadius: float,
        LoiterDirection: float, DistToSoarPoint: float, vSinkExp: float, z1_LocalUpdraftSpeed: float,
        z2_DeltaRoll: float, z1_exp: float, z2_exp: float, ThermalGSNorth: float, ThermalGSEast: float,
        TSE_dot: float, DebugVar1: float, DebugVar2: float, ControlMode: int, valid: int) -> None: ...

class MAVLink_sensorpod_status_message(_dialect.MAVLink_message):  # 8012
    timestamp: int  # ms
    visensor_rate_1: int
    visensor_rate_2: int
    visensor_rate_3: int
    visensor_rate_4: int
    recording_nodes_count: int
    cpu_temp: int  # degC
    free_space: int
    def __init__(self, timestamp: int, visensor_rate_1: int, visensor_rate_2: int, visensor_rate_3: int,
        visensor_rate_4: int, recording_nodes_count: int, cpu_temp: int, free_space: int) -> None: ...

class MAVLink_sens_power_board_message(_dialect.MAVLink_message):  # 8013
    timestamp: int  # us
    pwr_brd_status: int
    pwr_brd_led_status: int
    pwr_brd_system_volt: float  # V
    pwr_brd_servo_volt: float  # V
    pwr_brd_digital_volt: float  # V
    pwr_brd_mot_l_amp: float  # A
    pwr_brd_mot_r_amp: float  # A
    pwr_brd_analog_amp: float  # A
    pwr_brd_digital_amp: float  # A
    pwr_brd_ext_amp: float  # A
    pwr_brd_aux_amp: float  # A
    def __init__(self, timestamp: int, pwr_brd_status: int, pwr_brd_led_status: int,
        pwr_brd_system_volt: float, pwr_brd_servo_volt: float, pwr_brd_digital_volt: float,
        pwr_brd_mot_l_amp: float, pwr_brd_mot_r_amp: float, pwr_brd_analog_amp: float,
        pwr_brd_digital_amp: float, pwr_brd_ext_amp: float, pwr_brd_aux_amp: float) -> None: ...

class MAVLink_gsm_link_status_message(_dialect.MAVLink_message):  # 8014
    timestamp: int  # us
    gsm_modem_type: int  # GSM_MODEM_TYPE
    gsm_link_type: int  # GSM_LINK_TYPE
    rssi: int
    rsrp_rscp: int
    sinr_ecio: int
    rsrq: int
    def __init__(self, timestamp: int, gsm_modem_type: int, gsm_link_type: int, rssi: int, rsrp_rscp: int,
        sinr_ecio: int, rsrq: int) -> None: ...

class MAVLink_satcom_link_status_message(_dialect.MAVLink_message):  # 8015
    timestamp: int  # us
    last_heartbeat: int  # us
    failed_sessions: int
    successful_sessions: int
    signal_quality: int
    ring_pending: int
    tx_session_pending: int
    rx_session_pending: int
    def __init__(self, timestamp: int, last_heartbeat: int, failed_sessions: int, successful_sessions: int,
        signal_quality: int, ring_pending: int, tx_session_pending: int, rx_session_pending: int) -> None: ...

class MAVLink_sensor_airflow_angles_message(_dialect.MAVLink_message):  # 8016
    timestamp: int  # us
    angleofattack: float  # deg
    angleofattack_valid: int
    sideslip: float  # deg
    sideslip_valid: int
    def __init__(self, timestamp: int, angleofattack: float, angleofattack_valid: int, sideslip: float,
        sideslip_valid: int) -> None: ...

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
    def sens_power_encode(self, adc121_vspb_volt: float, adc121_cspb_amp: float, adc121_cs1_amp: float,
        adc121_cs2_amp: float) -> MAVLink_sens_power_message: ...
    def sens_power_send(self, adc121_vspb_volt: float, adc121_cspb_amp: float, adc121_cs1_amp: float,
        adc121_cs2_amp: float, force_mavlink1: bool = False) -> None: ...
    def sens_mppt_encode(self, mppt_timestamp: int, mppt1_volt: float, mppt1_amp: float, mppt1_pwm: int,
        mppt1_status: int, mppt2_volt: float, mppt2_amp: float, mppt2_pwm: int, mppt2_status: int,
        mppt3_volt: float, mppt3_amp: float, mppt3_pwm: int,
        mppt3_status: int) -> MAVLink_sens_mppt_message: ...
    def sens_mppt_send(self, mppt_timestamp: int, mppt1_volt: float, mppt1_amp: float, mppt1_pwm: int,
        mppt1_status: int, mppt2_volt: float, mppt2_amp: float, mppt2_pwm: int, mppt2_status: int,
        mppt3_volt: float, mppt3_amp: float, mppt3_pwm: int, mppt3_status: int,
        force_mavlink1: bool = False) -> None: ...
    def aslctrl_data_encode(self, timestamp: int, aslctrl_mode: int, h: float, hRef: float, hRef_t: float,
        PitchAngle: float, PitchAngleRef: float, q: float, qRef: float, uElev: float, uThrot: float,
        uThrot2: float, nZ: float, AirspeedRef: float, SpoilersEngaged: int, YawAngle: float,
        YawAngleRef: float, RollAngle: float, RollAngleRef: float, p: float, pRef: float, r: float,
        rRef: float, uAil: float, uRud: float) -> MAVLink_aslctrl_data_message: ...
    def aslctrl_data_send(self, timestamp: int, aslctrl_mode: int, h: float, hRef: float, hRef_t: float,
        PitchAngle: float, PitchAngleRef: float, q: float, qRef: float, uElev: float, uThrot: float,
        uThrot2: float, nZ: float, AirspeedRef: float, SpoilersEngaged: int, YawAngle: float,
        YawAngleRef: float, RollAngle: float, RollAngleRef: float, p: float, pRef: float, r: float,
        rRef: float, uAil: float, uRud: float, force_mavlink1: bool = False) -> None: ...
    def aslctrl_debug_encode(self, i32_1: int, i8_1: int, i8_2: int, f_1: float, f_2: float, f_3: float,
        f_4: float, f_5: float, f_6: float, f_7: float, f_8: float) -> MAVLink_aslctrl_debug_message: ...
    def aslctrl_debug_send(self, i32_1: int, i8_1: int, i8_2: int, f_1: float, f_2: float, f_3: float,
        f_4: float, f_5: float, f_6: float, f_7: float, f_8: float, force_mavlink1: bool = False) -> None: ...
    def asluav_status_encode(self, LED_status: int, SATCOM_status: int, Servo_status: _Sequence[int],
        Motor_rpm: float) -> MAVLink_asluav_status_message: ...
    def asluav_status_send(self, LED_status: int, SATCOM_status: int, Servo_status: _Sequence[int],
        Motor_rpm: float, force_mavlink1: bool = False) -> None: ...
    def ekf_ext_encode(self, timestamp: int, Windspeed: float, WindDir: float, WindZ: float, Airspeed: float,
        beta: float, alpha: float) -> MAVLink_ekf_ext_message: ...
    def ekf_ext_send(self, timestamp: int, Windspeed: float, WindDir: float, WindZ: float, Airspeed: float,
        beta: float, alpha: float, force_mavlink1: bool = False) -> None: ...
    def asl_obctrl_encode(self, timestamp: int, uElev: float, uThrot: float, uThrot2: float, uAilL: float,
        uAilR: float, uRud: float, obctrl_status: int) -> MAVLink_asl_obctrl_message: ...
    def asl_obctrl_send(self, timestamp: int, uElev: float, uThrot: float, uThrot2: float, uAilL: float,
        uAilR: float, uRud: float, obctrl_status: int, force_mavlink1: bool = False) -> None: ...
    def sens_atmos_encode(self, timestamp: int, TempAmbient: float,
        Humidity: float) -> MAVLink_sens_atmos_message: ...
    def sens_atmos_send(self, timestamp: int, TempAmbient: float, Humidity: float,
        force_mavlink1: bool = False) -> None: ...
    def sens_batmon_encode(self, batmon_timestamp: int, temperature: float, voltage: int, current: int,
        SoC: int, batterystatus: int, serialnumber: int, safetystatus: int, operationstatus: int,
        cellvoltage1: int, cellvoltage2: int, cellvoltage3: int, cellvoltage4: int, cellvoltage5: int,
        cellvoltage6: int) -> MAVLink_sens_batmon_message: ...
    def sens_batmon_send(self, batmon_timestamp: int, temperature: float, voltage: int, current: int,
        SoC: int, batterystatus: int, serialnumber: int, safetystatus: int, operationstatus: int,
        cellvoltage1: int, cellvoltage2: int, cellvoltage3: int, cellvoltage4: int, cellvoltage5: int,
        cellvoltage6: int, force_mavlink1: bool = False) -> None: ...
    def fw_soaring_data_encode(self, timestamp: int, timestampModeChanged: int, xW: float, xR: float,
        xLat: float, xLon: float, VarW: float, VarR: float, VarLat: float, VarLon: float, LoiterRadius: float,
        LoiterDirection: float, DistToSoarPoint: float, vSinkExp: float, z1_LocalUpdraftSpeed: float,
        z2_DeltaRoll: float, z1_exp: float, z2_exp: float, ThermalGSNorth: float, ThermalGSEast: float,
        TSE_dot: float, DebugVar1: float, DebugVar2: float, ControlMode: int,
        valid: int) -> MAVLink_fw_soaring_data_message: ...
    def fw_soaring_data_send(self, timestamp: int, timestampModeChanged: int, xW: float, xR: float,
        xLat: float, xLon: float, VarW: float, VarR: float, VarLat: float, VarLon: float, LoiterRadius: float,
        LoiterDirection: float, DistToSoarPoint: float, vSinkExp: float, z1_LocalUpdraftSpeed: float,
        z2_DeltaRoll: float, z1_exp: float, z2_exp: float, ThermalGSNorth: float, ThermalGSEast: float,
        TSE_dot: float, DebugVar1: float, DebugVar2: float, ControlMode: int, valid: int,
        force_mavlink1: bool = False) -> None: ...
    def sensorpod_status_encode(self, timestamp: int, visensor_rate_1: int, visensor_rate_2: int,
        visensor_rate_3: int, visensor_rate_4: int, recording_nodes_count: int, cpu_temp: int,
        free_space: int) -> MAVLink_sensorpod_status_message: ...
    def sensorpod_status_send(self, timestamp: int, visensor_rate_1: int, visensor_rate_2: int,
        visensor_rate_3: int, visensor_rate_4: int, recording_nodes_count: int, cpu_temp: int,
        free_space: int, force_mavlink1: bool = False) -> None: ...
    def sens_power_board_encode(self, timestamp: int, pwr_brd_status: int, pwr_brd_led_status: int,
        pwr_brd_system_volt: float, pwr_brd_servo_volt: float, pwr_brd_digital_volt: float,
        pwr_brd_mot_l_amp: float, pwr_brd_mot_r_amp: float, pwr_brd_analog_amp: float,
        pwr_brd_digital_amp: float, pwr_brd_ext_amp: float,
        pwr_brd_aux_amp: float) -> MAVLink_sens_power_board_message: ...
    def sens_power_board_send(self, timestamp: int, pwr_brd_status: int, pwr_brd_led_status: int,
        pwr_brd_system_volt: float, pwr_brd_servo_volt: float, pwr_brd_digital_volt: float,
        pwr_brd_mot_l_amp: float, pwr_brd_mot_r_amp: float, pwr_brd_analog_amp: float,
        pwr_brd_digital_amp: float, pwr_brd_ext_amp: float, pwr_brd_aux_amp: float,
        force_mavlink1: bool = False) -> None: ...
    def gsm_link_status_encode(self, timestamp: int, gsm_modem_type: int, gsm_link_type: int, rssi: int,
        rsrp_rscp: int, sinr_ecio: int, rsrq: int) -> MAVLink_gsm_link_status_message: ...
    def gsm_link_status_send(self, timestamp: int, gsm_modem_type: int, gsm_link_type: int, rssi: int,
        rsrp_rscp: int, sinr_ecio: int, rsrq: int, force_mavlink1: bool = False) -> None: ...
    def satcom_link_status_encode(self, timestamp: int, last_heartbeat: int, failed_sessions: int,
        successful_sessions: int, signal_quality: int, ring_pending: int, tx_session_pending: int,
        rx_session_pending: int) -> MAVLink_satcom_link_status_message: ...
    def satcom_link_status_send(self, timestamp: int, last_heartbeat: int, failed_sessions: int,
        successful_sessions: int, signal_quality: int, ring_pending: int, tx_session_pending: int,
        rx_session_pending: int, force_mavlink1: bool = False) -> None: ...
    def sensor_airflow_angles_encode(self, timestamp: int, angleofattack: float, angleofattack_valid: int,
        sideslip: float, sideslip_valid: int) -> MAVLink_sensor_airflow_angles_message: ...
    def sensor_airflow_angles_send(self, timestamp: int, angleofattack: float, angleofattack_valid: int,
        sideslip: float, sideslip_valid: int, force_mavlink1: bool = False) -> None: ...
