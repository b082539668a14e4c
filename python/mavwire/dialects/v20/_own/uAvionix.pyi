"""What dialect uAvionix itself defines. Written by tools/generate_stubs.py."""

from collections.abc import Sequence as _Sequence

from mavwire.dialects import _dialect

MAVLINK_MSG_ID_UAVIONIX_ADSB_OUT_CFG: int = 10001
MAVLINK_MSG_ID_UAVIONIX_ADSB_OUT_DYNAMIC: int = 10002
MAVLINK_MSG_ID_UAVIONIX_ADSB_TRANSCEIVER_HEALTH_REPORT: int = 10003
MAVLINK_MSG_ID_UAVIONIX_ADSB_OUT_CFG_REGISTRATION: int = 10004
MAVLINK_MSG_ID_UAVIONIX_ADSB_OUT_CFG_FLIGHTID: int = 10005
MAVLINK_MSG_ID_UAVIONIX_ADSB_GET: int = 10006
MAVLINK_MSG_ID_UAVIONIX_ADSB_OUT_CONTROL: int = 10007
MAVLINK_MSG_ID_UAVIONIX_ADSB_OUT_STATUS: int = 10008
UAVIONIX_ADSB_OUT_DYNAMIC_STATE_INTENT_CHANGE: int = 1
UAVIONIX_ADSB_OUT_DYNAMIC_STATE_AUTOPILOT_ENABLED: int = 2
UAVIONIX_ADSB_OUT_DYNAMIC_STATE_NICBARO_CROSSCHECKED: int = 4
UAVIONIX_ADSB_OUT_DYNAMIC_STATE_ON_GROUND: int = 8
UAVIONIX_ADSB_OUT_DYNAMIC_STATE_IDENT: int = 16
UAVIONIX_ADSB_OUT_DYNAMIC_STATE_ENUM_END: int
UAVIONIX_ADSB_OUT_RF_SELECT_RX_ENABLED: int = 1
UAVIONIX_ADSB_OUT_RF_SELECT_TX_ENABLED: int = 2
UAVIONIX_ADSB_OUT_RF_SELECT_ENUM_END: int
UAVIONIX_ADSB_OUT_DYNAMIC_GPS_FIX_NONE_0: int = 0
UAVIONIX_ADSB_OUT_DYNAMIC_GPS_FIX_NONE_1: int = 1
UAVIONIX_ADSB_OUT_DYNAMIC_GPS_FIX_2D: int = 2
UAVIONIX_ADSB_OUT_DYNAMIC_GPS_FIX_3D: int = 3
UAVIONIX_ADSB_OUT_DYNAMIC_GPS_FIX_DGPS: int = 4
UAVIONIX_ADSB_OUT_DYNAMIC_GPS_FIX_RTK: int = 5
UAVIONIX_ADSB_OUT_DYNAMIC_GPS_FIX_ENUM_END: int
UAVIONIX_ADSB_RF_HEALTH_OK: int = 1
UAVIONIX_ADSB_RF_HEALTH_FAIL_TX: int = 2
UAVIONIX_ADSB_RF_HEALTH_FAIL_RX: int = 16
UAVIONIX_ADSB_RF_HEALTH_ENUM_END: int
UAVIONIX_ADSB_OUT_CFG_AIRCRAFT_SIZE_NO_DATA: int = 0
UAVIONIX_ADSB_OUT_CFG_AIRCRAFT_SIZE_L15M_W23M: int = 1
UAVIONIX_ADSB_OUT_CFG_AIRCRAFT_SIZE_L25M_W28P5M: int = 2
UAVIONIX_ADSB_OUT_CFG_AIRCRAFT_SIZE_L25_34M: int = 3
UAVIONIX_ADSB_OUT_CFG_AIRCRAFT_SIZE_L35_33M: int = 4
UAVIONIX_ADSB_OUT_CFG_AIRCRAFT_SIZE_L35_38M: int = 5
UAVIONIX_ADSB_OUT_CFG_AIRCRAFT_SIZE_L45_39P5M: int = 6
UAVIONIX_ADSB_OUT_CFG_AIRCRAFT_SIZE_L45_45M: int = 7
UAVIONIX_ADSB_OUT_CFG_AIRCRAFT_SIZE_L55_45M: int = 8
UAVIONIX_ADSB_OUT_CFG_AIRCRAFT_SIZE_L55_52M: int = 9
UAVIONIX_ADSB_OUT_CFG_AIRCRAFT_SIZE_L65_59P5M: int = 10
UAVIONIX_ADSB_OUT_CFG_AIRCRAFT_SIZE_L65_67M: int = 11
UAVIONIX_ADSB_OUT_CFG_AIRCRAFT_SIZE_L75_W72P5M: int = 12
UAVIONIX_ADSB_OUT_CFG_AIRCRAFT_SIZE_L75_W80M: int = 13
UAVIONIX_ADSB_OUT_CFG_AIRCRAFT_SIZE_L85_W80M: int = 14
UAVIONIX_ADSB_OUT_CFG_AIRCRAFT_SIZE_L85_W90M: int = 15
UAVIONIX_ADSB_OUT_CFG_AIRCRAFT_SIZE_ENUM_END: int
UAVIONIX_ADSB_OUT_CFG_GPS_OFFSET_LAT_NO_DATA: int = 0
UAVIONIX_ADSB_OUT_CFG_GPS_OFFSET_LAT_LEFT_2M: int = 1
UAVIONIX_ADSB_OUT_CFG_GPS_OFFSET_LAT_LEFT_4M: int = 2
UAVIONIX_ADSB_OUT_CFG_GPS_OFFSET_LAT_LEFT_6M: int = 3
UAVIONIX_ADSB_OUT_CFG_GPS_OFFSET_LAT_RIGHT_0M: int = 4
UAVIONIX_ADSB_OUT_CFG_GPS_OFFSET_LAT_RIGHT_2M: int = 5
UAVIONIX_ADSB_OUT_CFG_GPS_OFFSET_LAT_RIGHT_4M: int = 6
UAVIONIX_ADSB_OUT_CFG_GPS_OFFSET_LAT_RIGHT_6M: int = 7
UAVIONIX_ADSB_OUT_CFG_GPS_OFFSET_LAT_ENUM_END: int
UAVIONIX_ADSB_OUT_CFG_GPS_OFFSET_LON_NO_DATA: int = 0
UAVIONIX_ADSB_OUT_CFG_GPS_OFFSET_LON_APPLIED_BY_SENSOR: int = 1
UAVIONIX_ADSB_OUT_CFG_GPS_OFFSET_LON_ENUM_END: int
UAVIONIX_ADSB_OUT_NO_EMERGENCY: int = 0
UAVIONIX_ADSB_OUT_GENERAL_EMERGENCY: int = 1
UAVIONIX_ADSB_OUT_LIFEGUARD_EMERGENCY: int = 2
UAVIONIX_ADSB_OUT_MINIMUM_FUEL_EMERGENCY: int = 3
UAVIONIX_ADSB_OUT_NO_COMM_EMERGENCY: int = 4
UAVIONIX_ADSB_OUT_UNLAWFUL_INTERFERANCE_EMERGENCY: int = 5
UAVIONIX_ADSB_OUT_DOWNED_AIRCRAFT_EMERGENCY: int = 6
UAVIONIX_ADSB_OUT_RESERVED: int = 7
UAVIONIX_ADSB_EMERGENCY_STATUS_ENUM_END: int
UAVIONIX_ADSB_OUT_CONTROL_STATE_EXTERNAL_BARO_CROSSCHECKED: int = 1
UAVIONIX_ADSB_OUT_CONTROL_STATE_ON_GROUND: int = 4
UAVIONIX_ADSB_OUT_CONTROL_STATE_IDENT_BUTTON_ACTIVE: int = 8
UAVIONIX_ADSB_OUT_CONTROL_STATE_MODE_A_ENABLED: int = 16
UAVIONIX_ADSB_OUT_CONTROL_STATE_MODE_C_ENABLED: int = 32
UAVIONIX_ADSB_OUT_CONTROL_STATE_MODE_S_ENABLED: int = 64
UAVIONIX_ADSB_OUT_CONTROL_STATE_1090ES_TX_ENABLED: int = 128
UAVIONIX_ADSB_OUT_CONTROL_STATE_ENUM_END: int
UAVIONIX_ADSB_XBIT_ENABLED: int = 128
UAVIONIX_ADSB_XBIT_ENUM_END: int
UAVIONIX_ADSB_OUT_STATUS_STATE_ON_GROUND: int = 1
UAVIONIX_ADSB_OUT_STATUS_STATE_INTERROGATED_SINCE_LAST: int = 2
UAVIONIX_ADSB_OUT_STATUS_STATE_XBIT_ENABLED: int = 4
UAVIONIX_ADSB_OUT_STATUS_STATE_IDENT_ACTIVE: int = 8
UAVIONIX_ADSB_OUT_STATUS_STATE_MODE_A_ENABLED: int = 16
UAVIONIX_ADSB_OUT_STATUS_STATE_MODE_C_ENABLED: int = 32
UAVIONIX_ADSB_OUT_STATUS_STATE_MODE_S_ENABLED: int = 64
UAVIONIX_ADSB_OUT_STATUS_STATE_1090ES_TX_ENABLED: int = 128
UAVIONIX_ADSB_OUT_STATUS_STATE_ENUM_END: int
UAVIONIX_ADSB_NIC_CR_20_NM: int = 1
UAVIONIX_ADSB_NIC_CR_8_NM: int = 2
UAVIONIX_ADSB_NIC_CR_4_NM: int = 3
UAVIONIX_ADSB_NIC_CR_2_NM: int = 4
UAVIONIX_ADSB_NIC_CR_1_NM: int = 5
UAVIONIX_ADSB_NIC_CR_0_3_NM: int = 6
UAVIONIX_ADSB_NIC_CR_0_2_NM: int = 7
UAVIONIX_ADSB_NIC_CR_0_1_NM: int = 8
UAVIONIX_ADSB_NIC_CR_75_M: int = 9
UAVIONIX_ADSB_NIC_CR_25_M: int = 10
UAVIONIX_ADSB_NIC_CR_7_5_M: int = 11
UAVIONIX_ADSB_NACP_EPU_10_NM: int = 16
UAVIONIX_ADSB_NACP_EPU_4_NM: int = 32
UAVIONIX_ADSB_NACP_EPU_2_NM: int = 48
UAVIONIX_ADSB_NACP_EPU_1_NM: int = 64
UAVIONIX_ADSB_NACP_EPU_0_5_NM: int = 80
UAVIONIX_ADSB_NACP_EPU_0_3_NM: int = 96
UAVIONIX_ADSB_NACP_EPU_0_1_NM: int = 112
UAVIONIX_ADSB_NACP_EPU_0_05_NM: int = 128
UAVIONIX_ADSB_NACP_EPU_30_M: int = 144
UAVIONIX_ADSB_NACP_EPU_10_M: int = 160
UAVIONIX_ADSB_NACP_EPU_3_M: int = 176
UAVIONIX_ADSB_OUT_STATUS_NIC_NACP_ENUM_END: int
UAVIONIX_ADSB_OUT_STATUS_FAULT_STATUS_MESSAGE_UNAVAIL: int = 8
UAVIONIX_ADSB_OUT_STATUS_FAULT_GPS_NO_POS: int = 16
UAVIONIX_ADSB_OUT_STATUS_FAULT_GPS_UNAVAIL: int = 32
UAVIONIX_ADSB_OUT_STATUS_FAULT_TX_SYSTEM_FAIL: int = 64
UAVIONIX_ADSB_OUT_STATUS_FAULT_MAINT_REQ: int = 128
UAVIONIX_ADSB_OUT_STATUS_FAULT_ENUM_END: int

class MAVLink_uavionix_adsb_out_cfg_message(_dialect.MAVLink_message):  # 10001
    ICAO: int
    callsign: str
    _callsign_raw: bytes
    emitterType: int  # ADSB_EMITTER_TYPE
    aircraftSize: int  # UAVIONIX_ADSB_OUT_CFG_AIRCRAFT_SIZE
    gpsOffsetLat: int  # UAVIONIX_ADSB_OUT_CFG_GPS_OFFSET_LAT
    gpsOffsetLon: int  # UAVIONIX_ADSB_OUT_CFG_GPS_OFFSET_LON
    stallSpeed: int  # cm/s
    rfSelect: int  # UAVIONIX_ADSB_OUT_RF_SELECT
    def __init__(self, ICAO: int, callsign: bytes, emitterType: int, aircraftSize: int, gpsOffsetLat: int,
        gpsOffsetLon: int, stallSpeed: int, rfSelect: int) -> None: ...

class MAVLink_uavionix_adsb_out_dynamic_message(_dialect.MAVLink_message):  # 10002
    utcTime: int  # s
    gpsLat: int  # degE7
    gpsLon: int  # degE7
    gpsAlt: int  # mm
    gpsFix: int  # UAVIONIX_ADSB_OUT_DYNAMIC_GPS_FIX
    numSats: int
    baroAltMSL: int  # mbar
    accuracyHor: int  # mm
    accuracyVert: int  # cm
    accuracyVel: int  # mm/s
    velVert: int  # cm/s
    velNS: int  # cm/s
    VelEW: int  # cm/s
    emergencyStatus: int  # UAVIONIX_ADSB_EMERGENCY_STATUS
    state: int  # UAVIONIX_ADSB_OUT_DYNAMIC_STATE
    squawk: int
    def __init__(self, utcTime: int, gpsLat: int, gpsLon: int, gpsAlt: int, gpsFix: int, numSats: int,
        baroAltMSL: int, accuracyHor: int, accuracyVert: int, accuracyVel: int, velVert: int, velNS: int,
        VelEW: int, emergencyStatus: int, state: int, squawk: int) -> None: ...

class MAVLink_uavionix_adsb_transceiver_health_report_message(_dialect.MAVLink_message):  # 10003
    rfHealth: int  # UAVIONIX_ADSB_RF_HEALTH
    def __init__(self, rfHealth: int) -> None: ...

class MAVLink_uavionix_adsb_out_cfg_registration_message(_dialect.MAVLink_message):  # 10004
    registration: str
    _registration_raw: bytes
    def __init__(self, registration: bytes) -> None: ...

class MAVLink_uavionix_adsb_out_cfg_flightid_message(_dialect.MAVLink_message):  # 10005
    flight_id: str
    _flight_id_raw: bytes
    def __init__(self, flight_id: bytes) -> None: ...

class MAVLink_uavionix_adsb_get_message(_dialect.MAVLink_message):  # 10006
    ReqMessageId: int
    def __init__(self, ReqMessageId: int) -> None: ...

class MAVLink_uavionix_adsb_out_control_message(_dialect.MAVLink_message):  # 10007
    state: int  # UAVIONIX_ADSB_OUT_CONTROL_STATE
    baroAltMSL: int  # mbar
    squawk: int
    emergencyStatus: int  # UAVIONIX_ADSB_EMERGENCY_STATUS
    flight_id: str
    _flight_id_raw: bytes
    x_bit: int  # UAVIONIX_ADSB_XBIT
    def __init__(self, state: int, baroAltMSL: int, squawk: int, emergencyStatus: int, flight_id: bytes,
        x_bit: int) -> None: ...

class MAVLink_uavionix_adsb_out_status_message(_dialect.MAVLink_message):  # 10008
    state: int  # UAVIONIX_ADSB_OUT_STATUS_STATE
    squawk: int
    NIC_NACp: int  # UAVIONIX_ADSB_OUT_STATUS_NIC_NACP
    boardTemp: int
    fault: int  # UAVIONIX_ADSB_OUT_STATUS_FAULT
    flight_id: str
    _flight_id_raw: bytes
    def __init__(self, state: int, squawk: int, NIC_NACp: int, boardTemp: int, fault: int,
        flight_id: bytes) -> None: ...

class _Methods:
    def uavionix_adsb_out_cfg_encode(self, ICAO: int, callsign: bytes, emitterType: int, aircraftSize: int,
        gpsOffsetLat: int, gpsOffsetLon: int, stallSpeed: int,
        rfSelect: int) -> MAVLink_uavionix_adsb_out_cfg_message: ...
    def uavionix_adsb_out_cfg_send(self, ICAO: int, callsign: bytes, emitterType: int, aircraftSize: int,
        gpsOffsetLat: int, gpsOffsetLon: int, stallSpeed: int, rfSelect: int,
        force_mavlink1: bool = False) -> None: ...
    def uavionix_adsb_out_dynamic_encode(self, utcTime: int, gpsLat: int, gpsLon: int, gpsAlt: int,
        gpsFix: int, numSats: int, baroAltMSL: int, accuracyHor: int, accuracyVert: int, accuracyVel: int,
        velVert: int, velNS: int, VelEW: int, emergencyStatus: int, state: int,
        squawk: int) -> MAVLink_uavionix_adsb_out_dynamic_message: ...
    def uavionix_adsb_out_dynamic_send(self, utcTime: int, gpsLat: int, gpsLon: int, gpsAlt: int, gpsFix: int,
        numSats: int, baroAltMSL: int, accuracyHor: int, accuracyVert: int, accuracyVel: int, velVert: int,
        velNS: int, VelEW: int, emergencyStatus: int, state: int, squawk: int,
        force_mavlink1: bool = False) -> None: ...
    def uavionix_adsb_transceiver_health_report_encode(self,
        rfHealth: int) -> MAVLink_uavionix_adsb_transceiver_health_report_message: ...
    def uavionix_adsb_transceiver_health_report_send(self, rfHealth: int,
        force_mavlink1: bool = False) -> None: ...
    def uavionix_adsb_out_cfg_registration_encode(self,
        registration: bytes) -> MAVLink_uavionix_adsb_out_cfg_registration_message: ...
    def uavionix_adsb_out_cfg_registration_send(self, registration: bytes,
        force_mavlink1: bool = False) -> None: ...
    def uavionix_adsb_out_cfg_flightid_encode(self,
        flight_id: bytes) -> MAVLink_uavionix_adsb_out_cfg_flightid_message: ...
    def uavionix_adsb_out_cfg_flightid_send(self, flight_id: bytes, force_mavlink1: bool = False) -> None: ...
    def uavionix_adsb_get_encode(self, ReqMessageId: int) -> MAVLink_uavionix_adsb_get_message: ...
    def uavionix_adsb_get_send(self, ReqMessageId: int, force_mavlink1: bool = False) -> None: ...
    def uavionix_adsb_out_control_encode(self, state: int, baroAltMSL: int, squawk: int, emergencyStatus: int,
        flight_id: bytes, x_bit: int) -> MAVLink_uavionix_adsb_out_control_message: ...
    def uavionix_adsb_out_control_send(self, state: int, baroAltMSL: int, squawk: int, emergencyStatus: int,
        flight_id: bytes, x_bit: int, force_mavlink1: bool = False) -> None: ...
    def uavionix_adsb_out_status_encode(self, state: int, squawk: int, NIC_NACp: int, boardTemp: int,
        fault: int, flight_id: bytes) -> MAVLink_uavionix_adsb_out_status_message: ...
    def uavionix_adsb_out_status_send(self, state: int, squawk: int, NIC_NACp: int, boardTemp: int,
        fault: int, flight_id: bytes, force_mavlink1: bool = False) -> None: ...
