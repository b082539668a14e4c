"""Dialect ardupilotmega for wire protocol 1.0. Written by tools/generate_stubs.py."""

from mavwire.dialects import _dialect
from mavwire.dialects._dialect import *
from mavwire.dialects.v10 import csAirLink as _csAirLink
from mavwire.dialects.v10 import cubepilot as _cubepilot
from mavwire.dialects.v10 import icarous as _icarous
from mavwire.dialects.v10 import loweheiser as _loweheiser
from mavwire.dialects.v10 import uAvionix as _uAvionix
from mavwire.dialects.v10._own import ardupilotmega as _own_ardupilotmega
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
from mavwire.dialects.v10._own.uAvionix import *

class MAVLink(
    _own_ardupilotmega._Methods,
    _uAvionix.MAVLink,
    _icarous.MAVLink,
    _loweheiser.MAVLink,
    _cubepilot.MAVLink,
    _csAirLink.MAVLink,
): ...
