"""Dialect icarous for wire protocol 1.0. Written by tools/generate_stubs.py."""

from mavwire.dialects import _dialect
from mavwire.dialects._dialect import *
from mavwire.dialects.v10._own import icarous as _own_icarous
from mavwire.dialects.v10._own.icarous import *

class MAVLink(
    _own_icarous._Methods,
    _dialect._Link,
): ...
