"""Dialect storm32 for wire protocol 1.0. Written by tools/generate_stubs.py."""

from mavwire.dialects import _dialect
from mavwire.dialects._dialect import *
from mavwire.dialects.v10 import ardupilotmega as _ardupilotmega
from mavwire.dialects.v10._own import storm32 as _own_storm32
from mavwire.dialects.v10._own.ardupilotmega import *
from mavwire.dialects.v10._own.common import *
from mavwire.dialects.v10._own.common_replaced import *
from mavwire.dialects.v10._own.csAirLink import *
from mavwire.dialects.v10._own.cubepilot import *
from mavwire.dialects.v10._own.icarous import *
from mavwire.dialects.v10._own.loweheiser import *
from mavwire.dialects.v10._own.minimal import *
from mavwire.dialects.v10._own.minimal_replaced import *
from mavwire.dialects.v10._own.standard import *
from mavwire.dialects.v10._own.storm32 import *
from mavwire.dialects.v10._own.uAvionix import *

class MAVLink(
    _own_storm32._Methods,
    _ardupilotmega.MAVLink,
): ...
