"""Dialect matrixpilot for wire protocol 1.0. Written by tools/generate_stubs.py."""

from mavwire.dialects import _dialect
from mavwire.dialects._dialect import *
from mavwire.dialects.v10 import common as _common
from mavwire.dialects.v10._own import matrixpilot as _own_matrixpilot
from mavwire.dialects.v10._own import matrixpilot_replaced as _own_matrixpilot_replaced
from mavwire.dialects.v10._own.common import *
from mavwire.dialects.v10._own.common_replaced import *
from mavwire.dialects.v10._own.matrixpilot import *
from mavwire.dialects.v10._own.matrixpilot_replaced import *
from mavwire.dialects.v10._own.minimal import *
from mavwire.dialects.v10._own.minimal_replaced import *
from mavwire.dialects.v10._own.standard import *

class MAVLink(
    _own_matrixpilot._Methods,
    _own_matrixpilot_replaced._Methods,
    _common.MAVLink,
): ...
