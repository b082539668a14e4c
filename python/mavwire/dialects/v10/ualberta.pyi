"""Dialect ualberta for wire protocol 1.0. Written by tools/generate_stubs.py."""

from mavwire.dialects import _dialect
from mavwire.dialects._dialect import *
from mavwire.dialects.v10 import common as _common
from mavwire.dialects.v10._own import ualberta as _own_ualberta
from mavwire.dialects.v10._own.common import *
from mavwire.dialects.v10._own.common_replaced import *
from mavwire.dialects.v10._own.minimal import *
from mavwire.dialects.v10._own.minimal_replaced import *
from mavwire.dialects.v10._own.standard import *
from mavwire.dialects.v10._own.ualberta import *

class MAVLink(
    _own_ualberta._Methods,
    _common.MAVLink,
): ...
