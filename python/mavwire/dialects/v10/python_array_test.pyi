"""Dialect python_array_test for wire protocol 1.0. Written by tools/generate_stubs.py."""

from mavwire.dialects import _dialect
from mavwire.dialects._dialect import *
from mavwire.dialects.v10 import common as _common
from mavwire.dialects.v10._own import python_array_test as _own_python_array_test
from mavwire.dialects.v10._own.common import *
from mavwire.dialects.v10._own.common_replaced import *
from mavwire.dialects.v10._own.minimal import *
from mavwire.dialects.v10._own.minimal_replaced import *
from mavwire.dialects.v10._own.python_array_test import *
from mavwire.dialects.v10._own.standard import *

class MAVLink(
    _own_python_array_test._Methods,
    _common.MAVLink,
): ...
