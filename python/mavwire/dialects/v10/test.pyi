"""Dialect test for wire protocol 1.0. Written by tools/generate_stubs.py."""

from mavwire.dialects import _dialect
from mavwire.dialects._dialect import *
from mavwire.dialects.v10._own import test as _own_test
from mavwire.dialects.v10._own.test import *

class MAVLink(
    _own_test._Methods,
    _dialect._Link,
): ...
