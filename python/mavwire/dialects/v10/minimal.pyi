"""Dialect minimal for wire protocol 1.0. Written by tools/generate_stubs.py."""

from mavwire.dialects import _dialect
from mavwire.dialects._dialect import *
from mavwire.dialects.v10._own import minimal as _own_minimal
from mavwire.dialects.v10._own import minimal_replaced as _own_minimal_replaced
from mavwire.dialects.v10._own.minimal import *
from mavwire.dialects.v10._own.minimal_replaced import *

class MAVLink(
    _own_minimal._Methods,
    _own_minimal_replaced._Methods,
    _dialect._Link,
): ...
