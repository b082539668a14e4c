"""Dialect ualberta for wire protocol 2.0. Written by tools/generate_stubs.py."""

from mavwire.dialects import _dialect
from mavwire.dialects._dialect import *
from mavwire.dialects.v20 import common as _common
from mavwire.dialects.v20._own import ualberta as _own_ualberta
from mavwire.dialects.v20._own.common import *
from mavwire.dialects.v20._own.common_replaced import *
from mavwire.dialects.v20._own.minimal import *
from mavwire.dialects.v20._own.minimal_replaced import *
from mavwire.dialects.v20._own.standard import *
from mavwire.dialects.v20._own.ualberta import *

class MAVLink(
    _own_ualberta._Methods,
    _common.MAVLink,
): ...
