"""A guarded base in memory that needs a lease: its commanders ask and drive."""

import json

from velocity_messages import speeds, twist

from rtron.guard.authority.lease_commands import LeaseCommands
from rtron.guard.authority.lease_controller import LeaseController
from rtron.guard.authority.lease_topics import LeaseTopics
from rtron.guard.coordinator import Coordinator
from rtron.guard.core.message_types import standard_info
from rtron.guard.core.observations import observations_of
from rtron.guard.core.report_messages import STRING, read_string, string_message
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.guard.transport.common.protocol import Peer
from rtron.messages.common.encoding import Encoding
from rtron.vocabulary import (
    GRCN,
    SECOND,
    CommanderRank,
    Domain,
    Flow,
    LeaseGroup,
    Mode,
    Plan,
    PolicyName,
    Sharing,
    StopProfile,
    StreamKind,
    build_streams,
    lease_topic,
)

TWIST = standard_info("geometry_msgs/Twist", Encoding.ROS1)
TTL = 2 * SECOND
TELEOP, NAV, AGENT, STRANGER = "/teleop", "/nav", "/agent", "/stranger"
FLOWS = (
    Flow(name="teleop", publisher=TELEOP, rank=CommanderRank.OPERATOR_ON_SITE),
    Flow(name="nav", publisher=NAV, rank=CommanderRank.AUTONOMY),
    Flow(name="agent", publisher=AGENT),
)


def grcn(topic, lease="base"):
    return GRCN(
        id=f"grcn_{topic.strip('/')}",
        topic=topic,
        type=TWIST.type,
        domain=Domain.CONTROL,
        kind=StreamKind.COMMAND,
        sharing=Sharing.CONTEND,
        mode=Mode.ENFORCE,
        policy=PolicyName.LEASE,
        flows=FLOWS,
        successors=("/driver",),
        lease=lease,
    )


PLAN = Plan(
    app="app",
    grcn=(grcn("/cmd_vel"), grcn("/arm_vel")),
    leases=(LeaseGroup(name="base", ttl=TTL),),
    stop=StopProfile(decel=10.0, repeat=SECOND // 5),
)


class LeasedBase:
    def __init__(self, plan=PLAN):
        self.transport = MemoryTransport()
        self.plan = plan
        self.host = Coordinator(self.transport, build_streams(plan), observations_of(plan))
        self.controller = LeaseController(self.host, self.transport)
        self.commands = LeaseCommands(self.controller)
        self.topics = LeaseTopics(self.controller, self.transport)
        self.host.open()
        self.topics.open()
        self.driver = self.transport.listen("/rtron/cmd_vel/out")
        self.active = self.transport.listen("/rtron/grcn_cmd_vel/cmd_vel/active")
        self._answers = self.transport.listen(lease_topic("base", "answer"))
        self._statuses = self.transport.listen(lease_topic("base", "status"))
        self._publish = {}

    def ask(self, who, text, **options):
        """Let a node ask for something; return the last answer that anybody got."""
        message = text if isinstance(text, bytes) else string_message(self.transport.encoding, text)
        publisher = self._publisher(who, lease_topic("base", "request"), STRING, options)
        publisher(message)
        return self.answers()[-1] if self._answers else None

    def drive(self, who, x, topic="/cmd_vel"):
        """Let a node send a velocity; tell whether it reached the driver."""
        listener = self.transport.listen(f"/rtron{topic}/out")
        listener.clear()
        private = f"/rtron{topic}/{who.strip('/')}"
        self._publisher(who, private, TWIST, {})(twist(x))
        return twist(x) in listener

    def stand(self, who, topic="/cmd_vel"):
        return self.drive(who, 0.0, topic)

    def leave(self, who, topic="/cmd_vel"):
        """End the connection of a node that drives; its next command comes over another one."""
        private = f"/rtron{topic}/{who.strip('/')}"
        self.transport.leave(private, Peer(who, TWIST))
        self._publish.pop((who, private, ()))

    def pass_time(self, duration):
        self.transport.advance(duration)

    def answers(self):
        return [self._json(message) for message in self._answers]

    def status(self):
        return self._json(self._statuses[-1])

    def active_text(self):
        return self._text(self.active[-1])

    def speeds(self):
        return [x for x, _ in speeds(self.driver)]

    def reason(self, flow, topic="/cmd_vel"):
        stream = next(each for each in self.host.streams if each.spec.topic == topic)
        return stream.pipeline.tallies[flow].last.reason

    def _publisher(self, who, topic, info, options):
        key = who, topic, tuple(options.items())
        if key not in self._publish:
            self._publish[key] = self.transport.publisher(topic, Peer(who, info, **options))
        return self._publish[key]

    def _text(self, message):
        return read_string(self.transport.encoding, message, 10_000)

    def _json(self, message):
        return json.loads(self._text(message))
