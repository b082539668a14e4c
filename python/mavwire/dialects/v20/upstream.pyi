"""Dialect upstream for wire protocol 2.0. Written by tools/generate_stubs.py."""

from mavwire.dialects import _dialect
from mavwire.dialects._dialect import *
from mavwire.dialects.v20._own import upstream as _own_upstream
from mavwire.dialects.v20._own import ASLUAV as _own_ASLUAV
from mavwire.dialects.v20._own import AVSSUAS as _own_AVSSUAS
from mavwire.dialects.v20._own import all as _own_all
from mavwire.dialects.v20._own import ardupilotmega as _own_ardupilotmega
from mavwire.dialects.v20._own import common as _own_common
from mavwire.dialects.v20._own import csAirLink as _own_csAirLink
from mavwire.dialects.v20._own import cubepilot as _own_cubepilot
from mavwire.dialects.v20._own import development as _own_development
from mavwire.dialects.v20._own import icarous as _own_icarous
from mavwire.dialects.v20._own import loweheiser as _own_loweheiser
from mavwire.dialects.v20._own import matrixpilot as _own_matrixpilot
from mavwire.dialects.v20._own import minimal as _own_minimal
from mavwire.dialects.v20._own import paparazzi as _own_paparazzi
from mavwire.dialects.v20._own import python_array_test as _own_python_array_test
from mavwire.dialects.v20._own import standard as _own_standard
from mavwire.dialects.v20._own import storm32 as _own_storm32
from mavwire.dialects.v20._own import test as _own_test
from mavwire.dialects.v20._own import uAvionix as _own_uAvionix
from mavwire.dialects.v20._own import ualberta as _own_ualberta
from mavwire.dialects.v20._own.ASLUAV import *
from mavwire.dialects.v20._own.AVSSUAS import *
from mavwire.dialects.v20._own.all import *
from mavwire.dialects.v20._own.ardupilotmega import *
from mavwire.dialects.v20._own.common import *
from mavwire.dialects.v20._own.csAirLink import *
from mavwire.dialects.v20._own.cubepilot import *
from mavwire.dialects.v20._own.development import *
from mavwire.dialects.v20._own.icarous import *
from mavwire.dialects.v20._own.loweheiser import *
from mavwire.dialects.v20._own.matrixpilot import *
from mavwire.dialects.v20._own.minimal import *
from mavwire.dialects.v20._own.paparazzi import *
from mavwire.dialects.v20._own.python_array_test import *
from mavwire.dialects.v20._own.standard import *
from mavwire.dialects.v20._own.storm32 import *
from mavwire.dialects.v20._own.test import *
from mavwire.dialects.v20._own.uAvionix import *
from mavwire.dialects.v20._own.ualberta import *
from mavwire.dialects.v20._own.upstream import *

class MAVLink(
    _own_upstream._Methods,
    _own_ASLUAV._Methods,
    _own_AVSSUAS._Methods,
    _own_all._Methods,
    _own_ardupilotmega._Methods,
    _own_common._Methods,
    _own_csAirLink._Methods,
    _own_cubepilot._Methods,
    _own_development._Methods,
    _own_icarous._Methods,
    _own_loweheiser._Methods,
    _own_matrixpilot._Methods,
    _own_minimal._Methods,
    _own_paparazzi._Methods,
    _own_python_array_test._Methods,
    _own_standard._Methods,
    _own_storm32._Methods,
    _own_test._Methods,
    _own_uAvionix._Methods,
    _own_ualberta._Methods,
    _dialect._Link,
): ...
