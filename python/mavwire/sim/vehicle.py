"""A simulated vehicle as a protocol without I/O: bytes and time go in, bytes come out.

It never looks at a clock, opens nothing and starts no thread, so a test owns its time and its
bytes: the same seed and the same calls give the same bytes, however `step` is cut into pieces.
`mavwire.sim.Runner` ties it to a link and to real time.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from random import Random
from typing import Any

from mavwire.dialects.v20 import all as mavlink

from .actions import ACTIONS
from .answers import Answers
from .autopilot import Autopilot
from .commands import Commands
from .ftp import Ftp
from .geo import Local, Origin, Place, check_start, place_of
from .guided import Guided
from .impairment import PERFECT, Channel, Counters, Impairment, flip_bit
from .missions import FENCE, MISSION, RALLY, Missions
from .params import Parameters
from .personality import PERSONALITIES, Personality, px4_events
from .physics import Copter
from .plans import Plan
from .sensors import Battery, Sensors
from .service import Handler, Service
from .signing import Signing
from .steering import Tuning
from .streams import TICK, Streams
from .timesync import Timesync

COMPONENT = mavlink.MAV_COMP_ID_AUTOPILOT1
# A start time that does not depend on today.
EPOCH = 1_704_067_200.0
MAX_STEP = 3600.0
# Bytes of a text in one STATUSTEXT.
TEXT_CHUNK = 50
# Vehicles that start together do not start inside each other.
SPACING = 5.0


class Vehicle:
    """One simulated copter.

    `autopilot` is "ardupilot" or "px4"; `home` is latitude, longitude and metres above sea level;
    `heading` and `wind` (north, east) are degrees and m/s; `start` is the Unix time at power-on, by
    default the same for all runs, and the present for a vehicle that a `Runner` flies;
    `gps_delay` is how long the GPS needs for its first fix; `params` are set before power-on.
    `signing_key` of 32 bytes makes it sign, and reject what is not signed. `version` is the
    MAVLink version it sends.
    """

    def __init__(
        self,
        autopilot: str = "ardupilot",
        sysid: int = 1,
        *,
        seed: int = 0,
        home: tuple[float, float, float] | None = None,
        heading: float = 0.0,
        wind: tuple[float, float] = (0.0, 0.0),
        start: float | None = None,
        gps_delay: float = 2.0,
        params: Mapping[str, float] | None = None,
        impairment: Impairment = PERFECT,
        signing_key: bytes | None = None,
        version: int = 2,
    ) -> None:
        if autopilot not in PERSONALITIES:
            raise ValueError(f"autopilot must be one of {', '.join(PERSONALITIES)}: {autopilot}")
        if not 1 <= sysid <= 254:
            raise ValueError(f"sysid must be between 1 and 254: {sysid}")
        if not isinstance(impairment, Impairment):
            raise TypeError(f"impairment must be an Impairment: {impairment!r}")
        if version not in (1, 2):
            raise ValueError(f"version must be 1 or 2: {version}")
        if version == 1 and signing_key is not None:
            raise ValueError("MAVLink 1 has no signatures: a vehicle with a key speaks MAVLink 2")
        self.personality: Personality = PERSONALITIES[autopilot]()
        self.sysid = sysid
        self.version = version
        self.impairment = impairment
        self.start = EPOCH if start is None else start
        self._start_given = start is not None
        self.ticks = 0
        self._owed = 0.0
        self._random = Random(seed * 1000 + sysid)
        self._mav: Any = mavlink.MAVLink(None, srcSystem=sysid, srcComponent=COMPONENT)
        self._mav.robust_parsing = True
        self._outgoing: Channel[bytes] = Channel(impairment, self._random, flip_bit)
        self._incoming: Channel[Any] = Channel(impairment, self._random, lambda *_: None)
        self._frames: list[bytes] = []
        self._place = place_of(self.personality.home if home is None else home)
        check_start(self._place, heading)
        self._heading, self._wind, self._gps_delay = math.radians(heading), wind, gps_delay
        self.frames_sent = 0
        self.when_ready: Callable[[Vehicle], None] | None = None
        self.tuning = Tuning()
        self.params = Parameters(self, params or {})
        self.signing = Signing(self, self._mav)
        self._power_on()
        if signing_key is not None:
            self.signing.use(signing_key)

    def _power_on(self) -> None:
        """Everything that a reboot forgets."""
        self._booted = self.ticks
        self.copter = Copter(Origin(self._place), self._heading, self._wind)
        self.sensors = Sensors(self._random, self.copter, self._gps_delay)
        self.battery = Battery(self.tuning.battery_capacity)
        self.plans = {kind: Plan(kind) for kind in (MISSION, FENCE, RALLY)}
        self.servos: dict[int, int] = {}
        self.armed_unix_us = self.takeoff_unix_us = 0
        self._text_number = self._events_sent = 0
        self._load_tuning()
        self.guided = Guided(self)
        self.autopilot = Autopilot(self)
        self.streams = Streams(self)
        self.answers = Answers(self)
        self.ftp = Ftp(self)
        services: list[Service] = [
            self.params, Missions(self), Commands(self, ACTIONS), self.guided, self.streams, self.answers,
            self.ftp, Timesync(self), self.signing,
        ]  # fmt: skip
        self._handlers: dict[str, Handler] = {}
        for service in services:
            self._handlers.update(service.handlers())
        self._services = [s for s in services if type(s).step is not Service.step]

    # -- what it is doing

    @property
    def armed(self) -> bool:
        """Whether the motors may turn."""
        return self.autopilot.armed

    @property
    def landed(self) -> bool:
        """Whether it is on the ground."""
        return self.copter.landed

    @property
    def mode(self) -> str:
        """The name of its flight mode."""
        return self.autopilot.mode.name

    @property
    def place(self) -> Place:
        """Latitude, longitude, altitude above sea level."""
        return self.copter.place

    @property
    def height(self) -> float:
        """Metres above home."""
        return self.autopilot.height

    @property
    def mission(self) -> Plan:
        """Its mission."""
        return self.plans[MISSION]

    @property
    def time(self) -> float:
        """Seconds since it was made; a reboot does not change them."""
        return self.ticks * TICK

    @property
    def time_ms(self) -> int:
        """Milliseconds since boot, as messages carry them."""
        return (self.ticks - self._booted) * round(TICK * 1e3) & 0xFFFFFFFF

    @property
    def time_us(self) -> int:
        """Microseconds since boot."""
        return (self.ticks - self._booted) * round(TICK * 1e6)

    @property
    def unix_us(self) -> int:
        """Microseconds of Unix time."""
        return int(self.start * 1e6) + self.ticks * round(TICK * 1e6)

    @property
    def losses(self) -> tuple[Counters, Counters]:
        """The counters of a bad link for frames sent and messages received."""
        return self._outgoing.counters, self._incoming.counters

    def start_now(self, unix: float) -> None:
        """Set the clock, unless `start` was given: signatures and time are of the present then."""
        if not self._start_given:
            self.start = unix - self.time

    # -- bytes and time

    def step(self, dt: float, data: bytes = b"") -> bytes:
        """Receive `data`, let `dt` seconds pass, and return all that is sent meanwhile."""
        self.receive(data)
        self.advance(dt)
        return b"".join(self.take())

    def receive(self, data: bytes) -> None:
        """Bytes from a link, cut anywhere. Answers are there at once."""
        if data:
            for msg in self._mav.parse_buffer(data) or ():
                if msg.get_type() != "BAD_DATA":
                    self.handle(msg)

    def handle(self, msg: Any) -> None:
        """A message, for those who parse themselves."""
        if self.impairment.perfect:
            self._deliver(msg)
        else:
            self._incoming.put(msg, self.time)

    def advance(self, dt: float) -> None:
        """Let `dt` seconds pass, in ticks of 10 ms; what is left is owed to the next call."""
        if not 0 <= dt <= MAX_STEP:
            raise ValueError(f"dt must be between 0 and {MAX_STEP:.0f} seconds: {dt}")
        self._owed += dt
        count = int(self._owed / TICK + 1e-9)
        self._owed = max(self._owed - count * TICK, 0.0)
        for _ in range(count):
            self._tick()

    def take(self) -> list[bytes]:
        """Frames that are to be sent now, in order; each is given once."""
        if self.impairment.perfect:
            frames, self._frames = self._frames, []
            return frames
        return self._outgoing.take(self.time)

    @property
    def until_next(self) -> float:
        """Seconds until something is due: how long a loop may sleep if nothing arrives."""
        return max((self.streams.next_tick - self.ticks) * TICK - self._owed, 0.0)

    def _tick(self) -> None:
        self.ticks += 1
        if not self.impairment.perfect:
            for msg in self._incoming.take(self.time):
                self._deliver(msg)
        self.sensors.step(TICK)
        self.autopilot.step(TICK)
        for service in self._services:
            service.step()

    def _deliver(self, msg: Any) -> None:
        handler = self._handlers.get(msg.get_type())
        if handler is not None and self._is_for_me(msg):
            handler(msg)

    def _is_for_me(self, msg: Any) -> bool:
        """0 addresses everyone; MANUAL_CONTROL has a target of its own kind."""
        fields = msg.get_fieldnames()
        if "target" in fields:
            return msg.target in (0, self.sysid)
        if "target_system" in fields and msg.target_system not in (0, self.sysid):
            return False
        return "target_component" not in fields or msg.target_component in (0, COMPONENT)

    def send(self, msg: Any) -> None:
        """Send a message."""
        if self.version == 1 and msg.get_msgId() > 255:
            return
        self.signing.keep_time()
        frame = bytes(msg.pack(self._mav, force_mavlink1=self.version == 1))
        self._mav.seq = (self._mav.seq + 1) & 0xFF
        self.frames_sent += 1
        if self.impairment.perfect:
            self._frames.append(frame)
        else:
            self._outgoing.put(frame, self.time)

    # -- texts

    def text(self, severity: int, text: str) -> None:
        """Say something: STATUSTEXT with MAV_SEVERITY, in as many chunks as it takes."""
        data, number = text.encode(), 0
        chunks = [data]
        if len(data) > TEXT_CHUNK:
            number = self._text_number = self._text_number % 65535 + 1  # not 0
            # An empty chunk closes a text whose last chunk is full.
            starts = range(0, len(data) + 1, TEXT_CHUNK)
            chunks = [data[at : at + TEXT_CHUNK] for at in starts]
        for index, chunk in enumerate(chunks):
            self.send(mavlink.MAVLink_statustext_message(severity, chunk, number, index))

    def phrase(self, key: str, **values: Any) -> str:
        """A text in the words of the autopilot."""
        values |= {"volts": self.battery.voltage, "used": self.battery.used}
        return self.personality.phrases[key][1].format(**values)

    def say(self, key: str, **values: Any) -> None:
        """Say what the autopilot would say, if it says anything at all."""
        if key in self.personality.phrases:
            severity, text = self.personality.phrases[key]
            self.text(severity, self.phrase(key, **values))
            if self.personality.sends_events and px4_events.is_event(text):
                self._events_sent += 1
                self.send(px4_events.message(key, severity, self.time, self._events_sent))

    def introduce(self) -> None:
        """Say what it is."""
        for line in self.personality.banner(self):
            self.text(mavlink.MAV_SEVERITY_INFO, line)

    # -- events

    def params_changed(self, name: str) -> None:
        """A parameter has a new value. After a reset `name` is that of the system id."""
        self._load_tuning()
        if name.startswith("SR0_") or name == self.personality.sysid_param:
            self.streams.load_rates()

    def _load_tuning(self) -> None:
        self.personality.tuning(self.params, self.tuning)
        self.battery.capacity = self.tuning.battery_capacity

    def position_found(self) -> None:
        """It knows where it is: it may fly."""
        self.say("position_ok")
        if self.when_ready is not None:
            self.when_ready(self)

    def mission_changed(self) -> None:
        """There is another mission."""
        if self.autopilot.home is not None and self.personality.first_mission_item == 1:
            self.mission.set_home(self.autopilot.home)
        self.say("mission_new")
        self.autopilot.mission_changed()
        self.streams.send("MISSION_CURRENT")

    def mission_reached(self, seq: int) -> None:
        """A mission item was done."""
        self.send(mavlink.MAVLink_mission_item_reached_message(seq))
        self.say("mission_reached", seq=seq)

    def reboot(self) -> None:
        """Switch off and on again: where it is becomes where it starts; parameters stay."""
        self.say("rebooting")
        here = self.copter.place
        self._place = Place(here.lat, here.lon, self._place.alt)
        self._heading = self.copter.yaw
        self._power_on()


def spread(home: Place, index: int) -> Place:
    """Where vehicle `index` of several starts: in a row to the east of `home`."""
    return Origin(home).globe(Local(0.0, SPACING * index, 0.0))
