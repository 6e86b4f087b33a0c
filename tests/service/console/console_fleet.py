"""A fleet for the console: robots in the store, connected to the hub as far as a test says."""

import threading
import time
from contextlib import contextmanager

from service_app import FakeLink
from sqlalchemy import insert, select

from rtron.planning import parse_plan
from rtron.service.controller.handshake import perform_handshake
from rtron.service.domain.schemas import SettingsOutcome
from rtron.service.store.tables import AppRow, CoordinationNodeRow, RobotRow, SettingsRow
from rtron.vocabulary import Alarm, AlarmKind, GuardState, Mode, StreamState
from rtron.wire.common.link_protocol import Hello

SIZE = 1000
NAMES = [f"robot{number}" for number in range(SIZE)]
_PLAN = """\
schema: rtron.plan/1
app: hall
grcn:
  - id: drive
    topic: /cmd_vel
    type: geometry_msgs/Twist
    mode: enforce
    policy: Preemption
    successors: [/base]
    flows:
      - {name: flow1, publisher: /teleop, priority: 2}
      - {name: flow2, publisher: /planner, priority: 1}
"""
_ROWS = {
    RobotRow: ("id", "app_id"),
    AppRow: ("id", "robot_id"),
    CoordinationNodeRow: ("app_id",),
    SettingsRow: ("app_id",),
}
"""What a hello stores of a robot, and the columns that count robots."""


def store_robots(database, names, now):
    """Put robots whose guards have said hello into an empty database: the first, and its copies."""
    plan = parse_plan(_PLAN)
    with database.write_session() as session:
        hello = Hello(app=plan.app, plan=plan, run=names[0], began=1, version="1")
        perform_handshake(session, names[0], hello, now).row.outcome = SettingsOutcome.APPLIED
        session.flush()
        for table, keys in _ROWS.items():
            row = session.execute(select(*table.__table__.columns)).mappings().one()
            copies = [_copy(row, keys, names, number) for number in range(1, len(names))]
            session.execute(insert(table), copies)


def _copy(row, keys, names, number):
    own = {key: row[key] + number for key in keys}
    return {**row, **own, "name": names[number]} if row.get("name") == names[0] else {**row, **own}


class Fleet:
    """Robots that are in the store of a service, connected, with a state."""

    def __init__(self, service, names=NAMES):
        self.service, self.hub = service, service.hub
        self.names = names
        self.links = {name: FakeLink() for name in self.names}
        self._told, self._telling = {}, threading.Lock()
        for name in self.names:
            self.connect(name)

    def connect(self, name, **state):
        self.hub.register(name, self.links[name], dry_run=False)
        self.state(name, **state)

    def disconnect(self, name):
        with self._telling:
            self._told.pop(name, None)
            self.hub.unregister(name, self.links[name])

    def state(self, name, **more):
        """Let a robot's guard tell its state."""
        with self._telling:
            self._tell(name, more)

    @contextmanager
    def speaking(self):
        """Let all guards that are connected tell their states each second."""
        stop = threading.Event()

        def speak():
            while not stop.wait(1):
                with self._telling:
                    for name, more in self._told.items():
                        self._tell(name, more)

        thread = threading.Thread(target=speak)
        thread.start()
        try:
            yield
        finally:
            stop.set()
            thread.join()

    def _tell(self, name, more):
        self._told[name] = more
        stream = StreamState(topic="/cmd_vel", nodes=("drive",), mode=Mode.ENFORCE, owner="flow2")
        state = GuardState(at=time.time_ns(), revision=0, streams=(stream,), **more)
        self.hub.set_state(name, self.links[name], state)


def stored_fleet(service, names):
    """Put robots into the store of a service, and connect them."""
    store_robots(service.database, names, service.clock())
    return Fleet(service, names)


def alarm(reason="somebody speaks on /cmd_vel", kind=AlarmKind.FOREIGN_PUBLISHER, **more):
    return Alarm(kind=kind, reason=reason, topic="/cmd_vel", peer="/stranger", **more)
