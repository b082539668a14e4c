"""What dialect csAirLink itself defines. Written by tools/generate_stubs.py."""

AIRLINK_ERROR_LOGIN_OR_PASS: int = 0
AIRLINK_AUTH_OK: int = 1
AIRLINK_AUTH_RESPONSE_TYPE_ENUM_END: int

class _Methods:
    pass
