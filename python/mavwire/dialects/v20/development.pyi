"""Dialect development for wire protocol 2.0. Written by tools/generate_stubs.py."""

from mavwire.dialects import _dialect
from mavwire.dialects._dialect import *
from mavwire.dialects.v20 import common as _common
from mavwire.dialects.v20._own import development as _own_development
from mavwire.dialects.v20._own.common import *
from mavwire.dialects.v20._own.common_replaced import *
from mavwire.dialects.v20._own.development import *
from mavwire.dialects.v20._own.minimal import *
from mavwire.dialects.v20._own.minimal_replaced import *
from mavwire.dialects.v20._own.standard import *

class MAVLink(
    _own_development._Methods,
    _common.MAVLink,
): ...
