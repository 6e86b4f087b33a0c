"""Every closed set of words that RTron speaks, spelled as ROS and the paper spell them."""

from enum import Enum


class StringEnum(str, Enum):
    """A closed set of words; a member is its value in JSON, YAML, the CLI and the console."""

    def __str__(self) -> str:
        return str(self.value)


class HiddenPart(StringEnum):
    """What of an app may be behind something that could not be read, as far as that is known."""

    NODES = "nodes"
    """More nodes, or other names of topics: a launch file, a component, a robot description."""
    ENDPOINTS = "endpoints"
    """A call that joins a node which is not known to a topic or a service."""


class UnresolvedCause(StringEnum):
    """What kind of thing could not be read: what somebody can do about it hangs on this."""

    MISSING_SOURCE = "missing_source"
    """A package or a program whose source is not here."""
    UNSET_VARIABLE = "unset_variable"
    ARGUMENT = "argument"
    """A launch argument that nobody gives, or that is given and not declared."""
    MISSING_CODE = "missing_code"
    """A library, plugin or base class that may add endpoints."""
    SYNTAX_ERROR = "syntax_error"
    PARTLY_READ = "partly_read"
    LIMIT = "limit"
    """What a scan ends because it is too large: it is read in part, too."""
    RUN_TIME = "run_time"
    """What only the running app decides."""
    UNREACHED = "unreached"
    """Functions that nothing which is seen calls."""
    INCOMPLETE_DESCRIPTION = "incomplete_description"
    """Follows from a file that a robot description includes and that is not here."""


class Domain(StringEnum):
    """The part of the robot's workflow a topic or function belongs to (paper, table of repos)."""

    PERCEPTION = "Perception"
    PLANNING = "Planning"
    CONTROL = "Control"
    DRIVERS = "Drivers"
    OTHERS = "Others"


class FunctionType(StringEnum):
    """The paper's 17 function types (paper section 3.1)."""

    PREPROCESSING = "Preprocessing"
    LOCALIZATION = "Localization"
    MAPPING = "Mapping"
    RECOGNITION = "Recognition"
    PATH_PLANNING = "Path Planning"
    GOAL_PLANNER = "Goal Planner"
    PATH_TRACKING = "Path Tracking"
    TELEOPERATION = "Teleoperation"
    SPEECH_GENERATION = "Speech Generation"
    SWITCHER = "Switcher"
    MOBILE = "Mobile"
    MANIPULATOR = "Manipulator"
    SPEAKER = "Speaker"
    SENSORS = "Sensors"
    VISUALIZATION = "Visualization"
    SUPPORT = "Support"
    EXTENSION = "Extension"


class RecognitionSubfunction(StringEnum):
    """What a Recognition function recognises (paper section 3.2, footnote)."""

    IMAGE = "Image Recognition"
    OBJECT = "Object Recognition"
    SPEECH = "Speech Recognition"
    TEMPERATURE = "Temperature Recognition"
    ILLUMINANCE = "Illuminance Recognition"
    HUMIDITY = "Humidity Recognition"


class Trust(StringEnum):
    """How far a node is trusted: its package is the user's own, somebody else's, or not known."""

    OWN = "own"
    THIRD_PARTY = "third_party"
    UNKNOWN = "unknown"


class Direction(StringEnum):
    """Whether an endpoint publishes or subscribes."""

    PUBLISH = "publish"
    SUBSCRIBE = "subscribe"

    @property
    def opposite(self) -> "Direction":
        """The direction of an endpoint's other end."""
        return Direction.SUBSCRIBE if self is Direction.PUBLISH else Direction.PUBLISH


class Resolution(StringEnum):
    """How an endpoint's topic name became known."""

    LITERAL = "literal"
    PARAMETER = "parameter"
    SYMBOLIC = "symbolic"
    MODEL = "model"
    OBSERVED = "observed"


class ActionRole(StringEnum):
    """The side of an action that a node plays."""

    CLIENT = "client"
    SERVER = "server"


class Reliability(StringEnum):
    """ROS 2 reliability of an endpoint; ROS 1 is always reliable."""

    RELIABLE = "reliable"
    BEST_EFFORT = "best_effort"


class Durability(StringEnum):
    """Whether a late subscriber gets what was said before; ROS 1 calls transient_local latched."""

    VOLATILE = "volatile"
    TRANSIENT_LOCAL = "transient_local"


class Liveliness(StringEnum):
    """Who asserts that a ROS 2 publisher is alive: the middleware, or the publisher itself."""

    AUTOMATIC = "automatic"
    MANUAL_BY_TOPIC = "manual_by_topic"


class RiskKind(StringEnum):
    """The kinds of risk that Algorithm 1 finds (paper section 4)."""

    GR_ST = "GR-ST"
    GR_MT = "GR-MT"
    RSR = "RSR"
    MSR = "MSR"


class RiskRole(StringEnum):
    """The part a high-risk node plays in a risk."""

    PUBLISHER = "publisher"
    IMAGE = "image"
    MAX_VEL = "max_vel"
    EVENT = "event"
    ACTION = "action"


class Severity(StringEnum):
    """How bad a risk is, mildest first."""

    LOW = "low"
    MEDIUM = "medium"
    HIGH = "high"


class CoordinationKind(StringEnum):
    """The coordination nodes of paper section 5.1."""

    GRCN = "GRCN"
    RSRCN = "RSRCN"
    MSRCN = "MSRCN"
    FPS_MONITOR = "fps_monitor"


class Mode(StringEnum):
    """Whether a coordination node stands in the flow or only watches it."""

    ENFORCE = "enforce"
    OBSERVE = "observe"


class Sharing(StringEnum):
    """Whether a topic's publishers each own a part of it (merge) or take turns (contend)."""

    MERGE = "merge"
    CONTEND = "contend"


class StreamKind(StringEnum):
    """What a topic carries: velocity-like commands, goals of an action, or state."""

    COMMAND = "command"
    ACTION = "action"
    STATE = "state"


class PolicyName(StringEnum):
    """The policies of the paper's table, and Lease."""

    BLOCK = "Block"
    FIFO_QUEUE = "FIFO_Queue"
    PRIORITY_QUEUE = "Priority_Queue"
    PREEMPTION = "Preemption"
    SAFE = "Safe"
    CONSTRAIN = "Constrain"
    SAFE_CONSTRAIN = "Safe+Constrain"
    LEASE = "Lease"


class CommanderRank(StringEnum):
    """Who goes before whom in command of a robot, the highest first."""

    EMERGENCY = "emergency"
    OPERATOR_ON_SITE = "operator_on_site"
    REMOTE_OPERATOR = "remote_operator"
    AUTONOMY = "autonomy"
    AGENT = "agent"


class OnSilence(StringEnum):
    """What the guard does when a flow that moved the robot falls silent."""

    STOP = "stop"
    RELEASE = "release"


class OnForeign(StringEnum):
    """What the guard does when a node that the plan does not name speaks to a guarded one."""

    STOP = "stop"
    ALARM = "alarm"


class OnError(StringEnum):
    """What the guard does about a message that it cannot judge: it never passes."""

    STOP = "stop"
    DROP = "drop"


class WhenUnknown(StringEnum):
    """What an eflow's bit counts as while nobody knows it.

    `block`: what depends on it is blocked; `set`, `clear`: 1, 0; `keep`: the last one known.
    """

    BLOCK = "block"
    SET = "set"
    CLEAR = "clear"
    KEEP = "keep"


class FrameSource(StringEnum):
    """What an fps_monitor counts: each frame, or detections only, where there is nothing better."""

    FRAMES = "frames"
    DETECTIONS = "detections"


class Decision(StringEnum):
    """What a policy does with a message."""

    PASS = "pass"  # noqa: S105 - a verdict, not a password
    HOLD = "hold"
    DROP = "drop"
    MODIFY = "modify"
