"""A small guarded base in memory, and settings for it."""

from streams import peer
from velocity_messages import float64, floats, speeds, twist

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.message_types import standard_info
from rtron.guard.core.observations import observations_of
from rtron.guard.settings.applier import SettingsApplier
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.guard.transport.common.protocol import TypeInfo
from rtron.messages.common.encoding import Encoding
from rtron.vocabulary import (
    GRCN,
    MSRCN,
    RSRCN,
    SECOND,
    Domain,
    EventFlow,
    Flow,
    FlowSettings,
    FpsMonitor,
    GuardedTopic,
    MissionRule,
    Mode,
    NodeSettings,
    Plan,
    PolicyName,
    RuleSettings,
    Settings,
    Sharing,
    StreamKind,
    WhenUnknown,
    build_streams,
)

TWIST = standard_info("geometry_msgs/Twist", Encoding.ROS1)
FLOAT64 = standard_info("std_msgs/Float64", Encoding.ROS1)
STRING = TypeInfo("std_msgs/String", "992ce8a1687cec8c8bd883ec73ca41d1")
DRIVERS = ("/nav", "/teleop")
LASTS = 5 * SECOND


def flows(prefix, *publishers):
    named = enumerate(publishers, 1)
    return tuple(Flow(name=f"{prefix}{n}", publisher=p, silent_after=LASTS) for n, p in named)


GENERAL = GRCN(
    id="grcn",
    topic="/cmd_vel",
    type="geometry_msgs/Twist",
    domain=Domain.CONTROL,
    kind=StreamKind.COMMAND,
    sharing=Sharing.CONTEND,
    mode=Mode.ENFORCE,
    policy=PolicyName.PREEMPTION,
    flows=(
        Flow(name="flow1", publisher="/nav", priority=2, silent_after=LASTS),
        Flow(name="flow2", publisher="/teleop", priority=1, silent_after=LASTS),
    ),
    successors=("/driver",),
)
MAPS = GRCN(
    id="grcn_map",
    topic="/map",
    type="std_msgs/String",
    domain=Domain.PLANNING,
    kind=StreamKind.STATE,
    sharing=Sharing.CONTEND,
    mode=Mode.ENFORCE,
    policy=PolicyName.BLOCK,
    flows=(Flow(name="flow1", publisher="/map_server"),),
    successors=("/planner",),
)
MOVING = GuardedTopic(topic="/cmd_vel", type="geometry_msgs/Twist", flows=flows("aflow", *DRIVERS))
SPEED = GuardedTopic(
    topic="/max_vel",
    type="std_msgs/Float64",
    flows=(Flow(name="aflow3", publisher="/decider"),),
    successors=("/driver",),
)
LIMITED = GuardedTopic(topic="/cmd_vel", type="geometry_msgs/Twist", flows=flows("vflow", *DRIVERS))
LIMIT = GuardedTopic(
    topic="/max_vel",
    type="std_msgs/Float64",
    flows=(Flow(name="vflow3", publisher="/decider"),),
    successors=("/driver",),
)
EVENTS = tuple(
    EventFlow(
        name=name,
        topic=f"/{name}",
        publisher=f"/{name}_sensor",
        type="std_msgs/String",
        present=60 * SECOND,
        on_silence=WhenUnknown.CLEAR,
    )
    for name in ("red", "fire")
)
AT_RED = MissionRule(name="red_light", when="red", block=("/cmd_vel",), reason="the light is red")
NOT_FAST = MissionRule(
    name="not_fast", when="fire", block=("/cmd_vel",), action="action.linear.x > 0.5"
)
PLAN = Plan(
    app="base",
    revision=1,
    grcn=(GENERAL, MAPS),
    msrcn=MSRCN(
        id="msrcn",
        mode=Mode.ENFORCE,
        policy=PolicyName.BLOCK,
        aflows=(MOVING, SPEED),
        eflows=EVENTS,
        rules=(AT_RED, NOT_FAST),
    ),
    rsrcn=RSRCN(
        id="rsrcn",
        mode=Mode.ENFORCE,
        policy=PolicyName.CONSTRAIN,
        max_vel_limit=3.0,
        threshold=0.1,
        vflows=(LIMITED, LIMIT),
    ),
    fps_monitor=(FpsMonitor(id="fps", node="/camera", topic="/image"),),
)
WALL = 1_700_000_000 * SECOND


def of(id, revision=2, **values):
    return Settings(revision=revision, nodes={id: NodeSettings(**values)})


def flow(name, id="grcn", revision=2, **values):
    return of(id, revision, flows={name: FlowSettings(**values)})


def rule(name, revision=2, **values):
    return of("msrcn", revision, rules={name: RuleSettings(**values)})


def limit(speed, revision=2):
    return of("rsrcn", revision, max_vel_limit=speed)


class Base:
    """The guard of a base with navigation, teleoperation and a decider of its maximal velocity."""

    def __init__(self, plan=PLAN, *, opened=True, dry_run=False):
        self.transport = MemoryTransport()
        self.host = Coordinator(
            self.transport, build_streams(plan), observations_of(plan), dry_run=dry_run
        )
        self.applying = SettingsApplier(plan, self.host, self.transport)
        self.driver = self.transport.listen("/rtron/cmd_vel/out")
        self.limits = self.transport.listen("/rtron/max_vel/out")
        if opened:
            self.open()

    def open(self):
        self.host.open()
        speak = self.transport.publisher
        self.nav = speak("/rtron/cmd_vel/flow1", peer("/nav", TWIST))
        self.teleop = speak("/rtron/cmd_vel/flow2", peer("/teleop", TWIST))
        self.decide = speak("/rtron/max_vel/aflow3", peer("/decider", FLOAT64))
        self.events = {
            name: speak(f"/{name}", peer(f"/{name}_sensor", STRING)) for name in ("red", "fire")
        }

    def apply(self, settings, wall=WALL):
        self.applying.apply(settings, wall)

    def event(self, name):
        self.events[name](b"\x04\x00\x00\x00\x00\x00\x00\x00")
        self.transport.advance(0)

    def stream(self, topic="/cmd_vel"):
        return next(each for each in self.host.streams if each.spec.topic == topic)

    def tally(self, name, topic="/cmd_vel"):
        return self.stream(topic).pipeline.tallies[name]

    def drive(self, x, by="nav", turn=0.0):
        getattr(self, by)(twist(x, turn=turn))

    def xs(self):
        return [round(x, 6) for x, _ in speeds(self.driver)]

    def ask(self, speed):
        self.decide(float64(speed))

    def asked(self):
        return floats(self.limits)
