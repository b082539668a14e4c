"""Dialect upstream for wire protocol 1.0. Written by tools/generate_stubs.py."""

from mavwire.dialects import _dialect
from mavwire.dialects._dialect import *
from mavwire.dialects.v10._own import upstream as _own_upstream
from mavwire.dialects.v10._own.upstream import *

class MAVLink(
    _own_upstream._Methods,
    _dialect._Link,
): ...
