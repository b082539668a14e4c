"""Dialect common for wire protocol 2.0. Written by tools/generate_stubs.py."""

from mavwire.dialects import _dialect
from mavwire.dialects._dialect import *
from mavwire.dialects.v20 import standard as _standard
from mavwire.dialects.v20._own import common as _own_common
from mavwire.dialects.v20._own import common_replaced as _own_common_replaced
from mavwire.dialects.v20._own.common import *
from mavwire.dialects.v20._own.common_replaced import *
from mavwire.dialects.v20._own.minimal import *
from mavwire.dialects.v20._own.minimal_replaced import *
from mavwire.dialects.v20._own.standard import *

class MAVLink(
    _own_common._Methods,
    _own_common_replaced._Methods,
    _standard.MAVLink,
): ...
