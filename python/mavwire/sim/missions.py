"""The mission protocol: upload with repeated requests, download, clear, current item.

For missions, fences and rally points alike. The vehicle asks for the items of an upload one by
one, repeats what is not answered, and keeps nothing of an upload that does not end well.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from mavwire.dialects.v20 import all as mavlink

from .geo import Place
from .personality.base import Role
from .personality.common import FENCE_COMMANDS, RALLY_COMMANDS
from .plans import MAX_ITEMS, MISSION_FRAMES, Item, Plan, scale_of
from .service import Address, Handler, Service, sender

if TYPE_CHECKING:
    from .vehicle import Vehicle

# Ticks of 10 ms between repeated requests, and how many go unanswered.
RETRY_TICKS = 50
RETRIES = 10
GUIDED_ITEM = 2
ALTITUDE_ITEM = 3
MISSION, FENCE, RALLY = 0, 1, 2
MAX_LATITUDE = 90 * 10**7
MAX_LONGITUDE = 180 * 10**7


@dataclass
class Upload:
    """An upload that is under way; items from `start` up to `end`, without it."""

    partner: Address
    plan: Plan
    start: int
    end: int
    whole: bool
    items: list[Item] = field(default_factory=list)
    due: int = 0
    retries: int = 0

    @property
    def wanted(self) -> int:
        """The item that comes next."""
        return self.start + len(self.items)


class Missions(Service):
    """Missions, fences and rally points of one vehicle."""

    def __init__(self, vehicle: Vehicle) -> None:
        super().__init__(vehicle)
        self._upload: Upload | None = None
        self._finished: Upload | None = None

    def handlers(self) -> Mapping[str, Handler]:
        return {
            "MISSION_COUNT": self._on_count,
            "MISSION_WRITE_PARTIAL_LIST": self._on_partial,
            "MISSION_ITEM": self._on_item,
            "MISSION_ITEM_INT": self._on_item,
            "MISSION_REQUEST_LIST": self._on_request_list,
            "MISSION_REQUEST": self._on_request,
            "MISSION_REQUEST_INT": self._on_request,
            "MISSION_CLEAR_ALL": self._on_clear,
            "MISSION_SET_CURRENT": self._on_set_current,
        }

    def _plan(self, msg: Any) -> Plan | None:
        """The plan that a message is about; one of an unknown type is refused."""
        plan: Plan | None = self.vehicle.plans.get(_type_of(msg))
        if plan is None:
            self._ack(sender(msg), mavlink.MAV_MISSION_UNSUPPORTED, _type_of(msg))
        return plan

    def _ack(self, to: Address, result: int, mission_type: int) -> None:
        self.vehicle.send(mavlink.MAVLink_mission_ack_message(*to, result, mission_type))

    # -- upload

    def _on_count(self, msg: Any) -> None:
        plan = self._plan(msg)
        if plan is None:
            return
        if msg.count > MAX_ITEMS:
            self._ack(sender(msg), mavlink.MAV_MISSION_NO_SPACE, plan.mission_type)
        elif self._free_for(sender(msg), plan):
            self._begin(Upload(sender(msg), plan, 0, msg.count, whole=True))

    def _on_partial(self, msg: Any) -> None:
        plan = self._plan(msg)
        if plan is None or not self._free_for(sender(msg), plan):
            return
        if not 0 <= msg.start_index <= msg.end_index < len(plan):
            self._ack(sender(msg), mavlink.MAV_MISSION_INVALID_SEQUENCE, plan.mission_type)
            return
        upload = Upload(sender(msg), plan, msg.start_index, msg.end_index + 1, whole=False)
        self._begin(upload)

    def _free_for(self, partner: Address, plan: Plan) -> bool:
        """An upload under way may only be begun anew by who began it."""
        free = self._upload is None or self._upload.partner == partner
        if not free:
            self._ack(partner, mavlink.MAV_MISSION_DENIED, plan.mission_type)
        return free

    def _begin(self, upload: Upload) -> None:
        self._upload = upload
        if upload.wanted == upload.end:
            self._complete(upload)
        else:
            self._ask(upload)

    def _ask(self, upload: Upload) -> None:
        """Request the next item, now and again until it comes."""
        upload.due = self.vehicle.ticks + RETRY_TICKS
        args = (*upload.partner, upload.wanted, upload.plan.mission_type)
        message: Any = mavlink.MAVLink_mission_request_message
        if self.vehicle.personality.mission_request_int:
            message = mavlink.MAVLink_mission_request_int_message
        self.vehicle.send(message(*args))

    def step(self) -> None:
        """Repeat a request that was not answered; give up in the end."""
        upload = self._upload
        if upload is None or self.vehicle.ticks < upload.due:
            return
        upload.retries += 1
        if upload.retries > RETRIES:
            self._abort(upload, mavlink.MAV_MISSION_OPERATION_CANCELLED)
        else:
            self._ask(upload)

    def _abort(self, upload: Upload, result: int) -> None:
        self._upload = None
        self._ack(upload.partner, result, upload.plan.mission_type)

    def _on_item(self, msg: Any) -> None:
        if msg.current in (GUIDED_ITEM, ALTITUDE_ITEM) and _type_of(msg) == MISSION:
            self._guided(msg)
            return
        upload, from_whom = self._upload, sender(msg)
        if upload is None or upload.partner != from_whom:
            self._repeated(msg)
            return
        if _type_of(msg) != upload.plan.mission_type:
            self._abort(upload, mavlink.MAV_MISSION_INVALID)
            return
        if msg.seq != upload.wanted:
            self._ask(upload)  # a repetition, or one that overtook another
            return
        item = Item.received(msg)
        result = self._check(item, upload.plan.mission_type)
        if result != mavlink.MAV_MISSION_ACCEPTED:
            self._abort(upload, result)
            return
        upload.items.append(item)
        upload.retries = 0
        if upload.wanted == upload.end:
            self._complete(upload)
        else:
            self._ask(upload)

    def _repeated(self, msg: Any) -> None:
        """The last item again: the acknowledgement was lost."""
        last = self._finished
        if last is not None and last.partner == sender(msg) and msg.seq == last.end - 1:
            self._ack(last.partner, mavlink.MAV_MISSION_ACCEPTED, last.plan.mission_type)

    def _check(self, item: Item, mission_type: int) -> int:
        """MAV_MISSION_RESULT for an item."""
        allowed = {
            MISSION: self.vehicle.personality.mission_commands,
            FENCE: FENCE_COMMANDS,
            RALLY: RALLY_COMMANDS,
        }
        if item.command not in allowed[mission_type]:
            return mavlink.MAV_MISSION_UNSUPPORTED
        if item.frame not in MISSION_FRAMES:
            return mavlink.MAV_MISSION_UNSUPPORTED_FRAME
        if item.frame != mavlink.MAV_FRAME_MISSION:
            if abs(item.x) > MAX_LATITUDE:
                return mavlink.MAV_MISSION_INVALID_PARAM5_X
            if abs(item.y) > MAX_LONGITUDE:
                return mavlink.MAV_MISSION_INVALID_PARAM6_Y
        return mavlink.MAV_MISSION_ACCEPTED

    def _complete(self, upload: Upload) -> None:
        upload.plan.store(upload.items, None if upload.whole else upload.start)
        self._upload, self._finished = None, upload
        self._ack(upload.partner, mavlink.MAV_MISSION_ACCEPTED, upload.plan.mission_type)
        if upload.plan.mission_type == MISSION:
            self.vehicle.mission_changed()

    def _guided(self, msg: Any) -> None:
        """An ArduPilot habit: a single item means "go there now"."""
        pilot = self.vehicle.autopilot
        result = mavlink.MAV_MISSION_UNSUPPORTED
        if self.vehicle.personality.guided_items:
            result = mavlink.MAV_MISSION_ERROR
            if pilot.mode.role is Role.GUIDED:
                place = Item.received(msg).place(pilot.home_place, pilot.copter.place)
                if msg.current == ALTITUDE_ITEM:
                    place = Place(*pilot.copter.place[:2], place.alt)
                pilot.go_to(pilot.copter.origin.local(place))
                result = mavlink.MAV_MISSION_ACCEPTED
        self._ack(sender(msg), result, MISSION)

    # -- download and the rest

    def _on_request_list(self, msg: Any) -> None:
        plan = self._plan(msg)
        if plan is not None:
            to = sender(msg)
            self.vehicle.send(
                mavlink.MAVLink_mission_count_message(*to, len(plan), plan.mission_type)
            )

    def _on_request(self, msg: Any) -> None:
        plan = self._plan(msg)
        if plan is None:
            return
        item = self._item(plan, msg.seq)
        if item is None:
            self._ack(sender(msg), mavlink.MAV_MISSION_INVALID_SEQUENCE, plan.mission_type)
            return
        current = int(plan.mission_type == MISSION and msg.seq == plan.current)
        head = (*sender(msg), msg.seq, item.frame, item.command, current, item.autocontinue)
        params = (item.param1, item.param2, item.param3, item.param4)
        place: tuple[float, float] = item.x, item.y
        message: Any = mavlink.MAVLink_mission_item_int_message
        if msg.get_type() == "MISSION_REQUEST":
            place = item.x / scale_of(item.frame), item.y / scale_of(item.frame)
            message = mavlink.MAVLink_mission_item_message
        self.vehicle.send(message(*head, *params, *place, item.z, plan.mission_type))

    def _item(self, plan: Plan, seq: int) -> Item | None:
        """An item of a plan; an ArduPilot always has its home, even without a mission."""
        if seq < len(plan):
            return plan.items[seq]
        if seq or plan.mission_type != MISSION or not self.vehicle.personality.first_mission_item:
            return None
        return Plan.home_item(self.vehicle.autopilot.home_place)

    def _on_clear(self, msg: Any) -> None:
        everything = _type_of(msg) == mavlink.MAV_MISSION_TYPE_ALL
        plans = list(self.vehicle.plans.values()) if everything else [self._plan(msg)]
        for plan in plans:
            if plan is None:
                return
            plan.store([])
            if plan.mission_type == MISSION:
                self.vehicle.mission_changed()
        self._ack(sender(msg), mavlink.MAV_MISSION_ACCEPTED, _type_of(msg))

    def _on_set_current(self, msg: Any) -> None:
        from .autopilot import RefusedError

        try:
            self.vehicle.autopilot.set_mission_current(msg.seq)
        except RefusedError as error:
            self.vehicle.text(mavlink.MAV_SEVERITY_WARNING, f"Mission: {error}")


def _type_of(msg: Any) -> int:
    """MAV_MISSION_TYPE. Messages of MAVLink 1 are about missions."""
    kind: int = getattr(msg, "mission_type", MISSION)
    return kind
