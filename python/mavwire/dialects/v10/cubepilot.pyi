"""Dialect cubepilot for wire protocol 1.0. Written by tools/generate_stubs.py."""

from mavwire.dialects import _dialect
from mavwire.dialects._dialect import *
from mavwire.dialects.v10 import common as _common
from mavwire.dialects.v10._own import cubepilot as _own_cubepilot
from mavwire.dialects.v10._own.common import *
from mavwire.dialects.v10._own.common_replaced import *
from mavwire.dialects.v10._own.cubepilot import *
from mavwire.dialects.v10._own.minimal import *
from mavwire.dialects.v10._own.minimal_replaced import *
from mavwire.dialects.v10._own.standard import *

class MAVLink(
    _own_cubepilot._Methods,
    _common.MAVLink,
): ...
