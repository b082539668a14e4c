"""Signing timestamps."""

# They count 10 us units since 2015-01-01 00:00 UTC.
EPOCH = 1420070400
UNITS_PER_SECOND = 100 * 1000
MAX_TIMESTAMP = (1 << 48) - 1
