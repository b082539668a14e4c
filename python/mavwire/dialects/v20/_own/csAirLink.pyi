"""What dialect csAirLink itself defines. Written by tools/generate_stubs.py."""

from collections.abc import Sequence as _Sequence

from mavwire.dialects import _dialect

MAVLINK_MSG_ID_AIRLINK_AUTH: int = 52000
MAVLINK_MSG_ID_AIRLINK_AUTH_RESPONSE: int = 52001
AIRLINK_ERROR_LOGIN_OR_PASS: int = 0
AIRLINK_AUTH_OK: int = 1
AIRLINK_AUTH_RESPONSE_TYPE_ENUM_END: int

class MAVLink_airlink_auth_message(_dialect.MAVLink_message):  # 52000
    login: str
    _login_raw: bytes
    password: str
    _password_raw: bytes
    def __init__(self, login: bytes, password: bytes) -> None: ...

class MAVLink_airlink_auth_response_message(_dialect.MAVLink_message):  # 52001
    resp_type: int  # AIRLINK_AUTH_RESPONSE_TYPE
    def __init__(self, resp_type: int) -> None: ...

class _Methods:
    def airlink_auth_encode(self, login: bytes, password: bytes) -> MAVLink_airlink_auth_message: ...
    def airlink_auth_send(self, login: bytes, password: bytes, force_mavlink1: bool = False) -> None: ...
    def airlink_auth_response_encode(self, resp_type: int) -> MAVLink_airlink_auth_response_message: ...
    def airlink_auth_response_send(self, resp_type: int, force_mavlink1: bool = False) -> None: ...
