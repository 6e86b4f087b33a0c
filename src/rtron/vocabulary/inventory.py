"""The inventory: each thing that can move a robot, who commands it, what else can, and its end."""

from dataclasses import dataclass

from rtron.vocabulary.enums import StringEnum
from rtron.vocabulary.evidence import Evidence


class Thing(StringEnum):
    """What moves, or decides whether something moves; in the order of a report."""

    BASE = "base"
    VEHICLE = "vehicle"
    """What an autopilot flies, dives or drives."""
    THRUSTERS = "thrusters"
    ARM = "arm"
    SERVOS = "servos"
    """Servos of which the part is not known."""
    GRIPPER = "gripper"
    HEAD = "head"
    """Pan, tilt, gimbal."""
    TOOL = "tool"
    """A blade, a pump, a launcher: what works on the surroundings."""
    HORN = "horn"
    DEVICE = "device"
    """Hardware that a node opens; what hangs on it is not known."""
    STOP = "emergency stop"
    ARMING = "arming"
    MODE = "mode"
    POWER = "power"
    CONTROLLERS = "controllers"
    """Which controllers run."""
    LIMITS = "limits"
    """Speeds that parameters or topics bound."""


SWITCHES = frozenset({Thing.STOP, Thing.ARMING, Thing.MODE, Thing.POWER, Thing.CONTROLLERS})
"""What does not move itself, and decides whether something does."""
NO_MOTION = SWITCHES | {Thing.LIMITS}
"""What a plan does not keep for named publishers, and no rule takes for motion."""
SIGNALS = frozenset({"std_msgs/Bool", "std_msgs/Empty"})
"""Types that carry no more than that something is to happen, as ROS 1 spells them."""


class Means(StringEnum):
    """By which of ROS's means a command travels."""

    TOPIC = "topic"
    SERVICE = "service"
    ACTION = "action"
    PARAMETER = "parameter"


@dataclass(frozen=True, slots=True, kw_only=True)
class Command:
    """One way to command a thing: the last one before it at `hops` 0, those behind it above.

    `receivers` obey it, none if they are not in the app. `senders` are the app's nodes that send
    it: without one it is open to any node. `priority` is what an arbiter gives it, as text.
    """

    means: Means
    name: str
    type: str = ""
    receivers: tuple[str, ...] = ()
    senders: tuple[str, ...] = ()
    hops: int = 0
    priority: str = ""


class Stops(StringEnum):
    """Whether a thing stops by itself when its commands end."""

    YES = "yes"
    NO = "no"
    UNKNOWN = "not known"


@dataclass(frozen=True, slots=True, kw_only=True)
class Mover:
    """A thing that can be moved.

    `drivers` are the nodes next to the hardware, none if they are not in the app; of those in
    `firmware` a sketch was read, those in `starting` move hardware before any command comes.
    `hardware` says what their source opens. `arbiters` stand in the way of commands, the last one
    first. `doors` let others than ROS nodes in, `operators` are nodes that a person commands beside
    ROS, with what; `unprompted` send commands though nobody tells them to. `effect` says what a
    switch does that does less than its name says. `stop` says why it stops or does not, `holders`
    which nodes keep their last command, and why. `unread` are the nodes that were not read, one of
    which may obey what no driver does; where the app is not `is_whole`, one may send what nobody
    does.
    """

    thing: Thing
    commands: tuple[Command, ...]
    drivers: tuple[str, ...] = ()
    hardware: tuple[str, ...] = ()
    arbiters: tuple[str, ...] = ()
    doors: tuple[str, ...] = ()
    operators: tuple[str, ...] = ()
    unprompted: tuple[str, ...] = ()
    starting: tuple[str, ...] = ()
    firmware: tuple[str, ...] = ()
    effect: str = ""
    unread: tuple[str, ...] = ()
    is_whole: bool = True
    stops: Stops = Stops.UNKNOWN
    stop: str = ""
    holders: tuple[tuple[str, str], ...] = ()
    evidence: tuple[Evidence, ...] = ()

    @property
    def last_commands(self) -> tuple[Command, ...]:
        """What the drivers obey."""
        return tuple(each for each in self.commands if not each.hops)

    @property
    def open_commands(self) -> tuple[Command, ...]:
        """What no node of the app sends."""
        return tuple(each for each in self.commands if not each.senders)
