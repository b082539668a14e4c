"""What dialect loweheiser itself defines. Written by tools/generate_stubs.py."""

from collections.abc import Sequence as _Sequence

from mavwire.dialects import _dialect

MAVLINK_MSG_ID_LOWEHEISER_GOV_EFI: int = 10151
MAV_CMD_LOWEHEISER_SET_STATE: int = 10151
MAV_CMD_ENUM_END: int

class MAVLink_loweheiser_gov_efi_message(_dialect.MAVLink_message):  # 10151
    volt_batt: float  # V
    curr_batt: float  # A
    curr_gen: float  # A
    curr_rot: float  # A
    fuel_level: float  # l
    throttle: float  # %
    runtime: int  # s
    until_maintenance: int  # s
    rectifier_temp: float  # degC
    generator_temp: float  # degC
    efi_batt: float  # V
    efi_rpm: float  # rpm
    efi_pw: float  # ms
    efi_fuel_flow: float
    efi_fuel_consumed: float  # l
    efi_baro: float  # kPa
    efi_mat: float  # degC
    efi_clt: float  # degC
    efi_tps: float  # %
    efi_exhaust_gas_temperature: float  # degC
    efi_index: int
    generator_status: int
    efi_status: int
    def __init__(self, volt_batt: float, curr_batt: float, curr_gen: float, curr_rot: float,
        fuel_level: float, throttle: float, runtime: int, until_maintenance: int, rectifier_temp: float,
        generator_temp: float, efi_batt: float, efi_rpm: float, efi_pw: float, efi_fuel_flow: float,
        efi_fuel_consumed: float, efi_baro: float, efi_mat: float, efi_clt: float, efi_tps: float,
        efi_exhaust_gas_temperature: float, efi_index: int, generator_status: int,
        efi_status: int) -> None: ...

class _Methods:
    def loweheiser_gov_efi_encode(self, volt_batt: float, curr_batt: float, curr_gen: float, curr_rot: float,
        fuel_level: float, throttle: float, runtime: int, until_maintenance: int, rectifier_temp: float,
        generator_temp: float, efi_batt: float, efi_rpm: float, efi_pw: float, efi_fuel_flow: float,
        efi_fuel_consumed: float, efi_baro: float, efi_mat: float, efi_clt: float, efi_tps: float,
        efi_exhaust_gas_temperature: float, efi_index: int, generator_status: int,
        efi_status: int) -> MAVLink_loweheiser_gov_efi_message: ...
    def loweheiser_gov_efi_send(self, volt_batt: float, curr_batt: float, curr_gen: float, curr_rot: float,
        fuel_level: float, throttle: float, runtime: int, until_maintenance: int, rectifier_temp: float,
        generator_temp: float, efi_batt: float, efi_rpm: float, efi_pw: float, efi_fuel_flow: float,
        efi_fuel_consumed: float, efi_baro: float, efi_mat: float, efi_clt: float, efi_tps: float,
        efi_exhaust_gas_temperature: float, efi_index: int, generator_status: int, efi_status: int,
        force_mavlink1: bool = False) -> None: ...
