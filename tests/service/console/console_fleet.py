"""A fleet for the console: robots in the store, connected to the hub as far as a test says."""

import threading
import time
from contextlib import contextmanager

from service_app import FakeLink

from rtron.planning import parse_plan
from rtron.service.controller.handshake import perform_handshake
from rtron.service.domain.schemas import SettingsOutcome
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


def store_robots(database, names, now):
    """Put robots whose guards have said hello into a database."""
    plan = parse_plan(_PLAN)
    with database.write_session() as session:
        for name in names:
            hello = Hello(app=plan.app, plan=plan, run=name, began=1, version="1")
            handshake = perform_handshake(session, name, hello, now)
            handshake.row.outcome = SettingsOutcome.APPLIED


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
