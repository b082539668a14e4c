"""Dialect upstream for wire protocol 2.0. Written by tools/generate_stubs.py."""

from mavwire.dialects import _dialect
from mavwire.dialects._dialect import *
from mavwire.dialects.v20._own import upstream as _own_upstream
from mavwire.dialects.v20._own.upstream import *

class MAVLink(
    _own_upstream._Methods,
    _dialect._Link,
): ...
