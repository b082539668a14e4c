"""Dialect loweheiser for wire protocol 2.0. Written by tools/generate_stubs.py."""

from mavwire.dialects import _dialect
from mavwire.dialects._dialect import *
from mavwire.dialects.v20 import minimal as _minimal
from mavwire.dialects.v20._own import loweheiser as _own_loweheiser
from mavwire.dialects.v20._own.loweheiser import *
from mavwire.dialects.v20._own.minimal import *
from mavwire.dialects.v20._own.minimal_replaced import *

class MAVLink(
    _own_loweheiser._Methods,
    _minimal.MAVLink,
): ...
