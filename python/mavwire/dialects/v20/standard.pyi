"""Dialect standard for wire protocol 2.0. Written by tools/generate_stubs.py."""

from mavwire.dialects import _dialect
from mavwire.dialects._dialect import *
from mavwire.dialects.v20 import minimal as _minimal
from mavwire.dialects.v20._own import standard as _own_standard
from mavwire.dialects.v20._own.minimal import *
from mavwire.dialects.v20._own.minimal_replaced import *
from mavwire.dialects.v20._own.standard import *

class MAVLink(
    _own_standard._Methods,
    _minimal.MAVLink,
): ...
