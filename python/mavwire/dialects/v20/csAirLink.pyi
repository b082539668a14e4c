"""Dialect csAirLink for wire protocol 2.0. Written by tools/generate_stubs.py."""

from mavwire.dialects import _dialect
from mavwire.dialects._dialect import *
from mavwire.dialects.v20._own import csAirLink as _own_csAirLink
from mavwire.dialects.v20._own.csAirLink import *

class MAVLink(
    _own_csAirLink._Methods,
    _dialect._Link,
): ...
