"""Dialect all for wire protocol 1.0. Written by tools/generate_stubs.py."""

from mavwire.dialects import _dialect
from mavwire.dialects._dialect import *
from mavwire.dialects.v10 import ASLUAV as _ASLUAV
from mavwire.dialects.v10 import AVSSUAS as _AVSSUAS
from mavwire.dialects.v10 import development as _development
from mavwire.dialects.v10 import python_array_test as _python_array_test
from mavwire.dialects.v10 import storm32 as _storm32
from mavwire.dialects.v10 import test as _test
from mavwire.dialects.v10 import ualberta as _ualberta
from mavwire.dialects.v10._own import all as _own_all
from mavwire.dialects.v10._own.ASLUAV import *
from mavwire.dialects.v10._own.AVSSUAS import *
from mavwire.dialects.v10._own.all import *
from mavwire.dialects.v10._own.ardupilotmega import *
from mavwire.dialects.v10._own.common import *
from mavwire.dialects.v10._own.common_replaced import *
from mavwire.dialects.v10._own.csAirLink import *
from mavwire.dialects.v10._own.cubepilot import *
from mavwire.dialects.v10._own.development import *
from mavwire.dialects.v10._own.icarous import *
from mavwire.dialects.v10._own.loweheiser import *
from mavwire.dialects.v10._own.minimal import *
from mavwire.dialects.v10._own.minimal_replaced import *
from mavwire.dialects.v10._own.python_array_test import *
from mavwire.dialects.v10._own.standard import *
from mavwire.dialects.v10._own.storm32 import *
from mavwire.dialects.v10._own.test import *
from mavwire.dialects.v10._own.uAvionix import *
from mavwire.dialects.v10._own.ualberta import *

class MAVLink(
    _own_all._Methods,
    _ASLUAV.MAVLink,
    _development.MAVLink,
    _python_array_test.MAVLink,
    _test.MAVLink,
    _ualberta.MAVLink,
    _storm32.MAVLink,
    _AVSSUAS.MAVLink,
): ...
