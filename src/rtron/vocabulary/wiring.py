"""What a launch wires in vain, or in a way that its author hardly meant: facts for the findings."""

from dataclasses import dataclass

from rtron.vocabulary.enums import StringEnum
from rtron.vocabulary.evidence import Evidence


class WiringFactKind(StringEnum):
    """What a fact is about; each says what its subject, value and others are."""

    DUPLICATE_NODE = "duplicate_node"
    """A node's name that is started more than once; others are the programs."""
    IDLE_REMAP = "idle_remap"
    """A remap from the subject to the value, which changes nothing; others use the subject."""
    UNUSED_REMAP = "unused_remap"
    """A remap from the subject to the value, of which no name of others, who get it, is known."""
    UNREAD_NODE = "unread_node"
    """A node that was not read; others are the names that its remaps and parameters give it."""
    UNREACHED_LISTENER = "unreached_listener"
    """A node that remaps transforms to the value; its listener, a node too, gets others instead."""
    SHARED_OUTPUT = "shared_output"
    """A topic that others, instances of one program, publish, while their other topics differ."""
    SECOND_SOURCE = "second_source"
    """A clock or a map that each of others, nodes, publishes."""
    SECTION_WITHOUT_NODE = "section_without_node"
    """A name with parameters that no node has; others have near names and no parameters."""
    MALFORMED_PARAMETER_FILE = "malformed_parameter_file"
    """A file that others, nodes, are given, with values and none below `ros__parameters`."""
    OVERRIDDEN_PARAMETER = "overridden_parameter"
    """A parameter that a launch file sets, and one within it later to the value.

    The others are what it was, and the argument whose default the value is, if it is one.
    """
    UNTYPED_CONTROLLER = "untyped_controller"
    """A controller that the value, a spawner, asks for, and that has no type; others have one."""
    MISSING_PLUGIN = "missing_plugin"
    """The id of a plugin that is asked for and that the value, a server, does not have; the subject
    is the id below the field of the request, others are the ids that it has."""
    LEAKED_ARGUMENT = "leaked_argument"
    """An argument with the value; others are the file that declares it, the file before, whose
    value it is, and its own default."""
    POSSIBLE_LEAKED_ARGUMENT = "possible_leaked_argument"
    """The same, where it may be meant: a switch, or what another file was given."""
    UNDECLARED_ARGUMENT = "undeclared_argument"
    """An argument that others, a file, are given and do not know; the value is a near one."""
    MISSING_ARGUMENT = "missing_argument"
    """An argument that the value, a launch file, uses and that nobody gives or has a default of."""
    BRIDGE_MISMATCH = "bridge_mismatch"
    """A topic of Gazebo that others, bridges, carry where they should carry the value, or in the
    wrong direction if it is the same."""
    OTHER_MODEL = "other_model"
    """A topic of Gazebo that others, bridges, carry, and that is of no model which is spawned."""
    TOPIC_PARAMETER = "topic_parameter"
    """A parameter whose value is a topic that nobody uses; others are near topics in use."""
    MISSPELT_PARAMETER = "misspelt_parameter"
    """A node that does not know the value, its parameter; it knows others, near ones."""
    UNREAD_PARAMETER = "unread_parameter"
    """A node that does not know the value, its parameter, nor a near one."""
    MISTYPED_PARAMETER = "mistyped_parameter"
    """A node that is given the value, its parameter, in another type; others: declared, given."""
    DOUBLE_FRAME = "double_frame"
    """A TF frame that others broadcast, some of them below the value, its parent frame."""
    DOUBLE_FIXED_FRAME = "double_fixed_frame"
    """The same, where all of them broadcast a transform that never changes, below one parent."""
    POSSIBLE_DOUBLE_FRAME = "possible_double_frame"
    """The same, where conditions that are not known decide whether more than one does."""
    FRAME_LOOP = "frame_loop"
    """A TF frame in a loop; the value is a frame of the loop, too, which others broadcast."""
    STRAY_FRAME = "stray_frame"
    """A frame of messages of others that is in no transform; the value is a near one that is."""
    MISSING_FRAME = "missing_frame"
    """A frame that others look up and that is in no transform; the value is a near one that is."""
    POSSIBLE_MISSING_FRAME = "possible_missing_frame"
    """The same, where another launch may send it; the value may be meant, or is empty."""
    UNREAD_PUBLISHER = "unread_publisher"
    """A topic that code which was not understood may publish."""
    STATE_PUBLISHER = "state_publisher"
    """A latched topic that the value, a node, publishes once or on change, not ever again."""
    SLOW_PUBLISHER = "slow_publisher"
    """A topic that the value, a node, sends by a timer alone; others are its deadline and the
    timer's period, which is longer, in seconds."""
    SENT_ONCE = "sent_once"
    """A node that is a `topic pub` of the launch and sends its message once, not ever again."""
    TRANSITION = "transition"
    """A launch file that changes a lifecycle node's state; the value is the node's plain name, or
    empty where any may be meant."""
    DISTRIBUTION = "distribution"
    """The ROS distribution that the user gave for the scan; what is only guessed is no fact."""
    DEVICE = "device"
    """A node whose source opens hardware; the value says what: a serial port, CAN."""
    SOCKET = "socket"
    """A node whose source joins a network beside ROS; the value says how: MQTT, a web server."""
    OPERATOR = "operator"
    """A node whose source reads what a person does; the value says how: a joystick, a keyboard."""
    COMMAND_AGE = "command_age"
    """A node whose source has a name that tells of how old a command is."""
    LAST_MESSAGE = "last_message"
    """A node with a subscription at the first place; the value is a `LastMessageFate`, others are
    the seconds after which, and the second place where; of what is repeated, the further places
    are those of the publishers, if they are known."""
    MESSAGE_FLOW = "message_flow"
    """A node with a subscription at the first place, whose messages lead to the publishers at the
    further places, to others, its services and actions, and to a `device` or another
    `library`, the value; without all three they are not used."""


class LastMessageFate(StringEnum):
    """What a node does with the last message of a topic when no more come."""

    STOPPED = "stopped"
    """It compares the time of the message with now, and stops something."""
    CHECKED = "checked"
    """It may notice: it compares that time or keeps it elsewhere, restarts a timer, waits with a
    limit, sets a mark or a counter that is tested, or takes away what it kept."""
    REPEATED = "repeated"
    """It publishes what it kept of the message again and again."""
    UNNOTICED = "unnoticed"
    """Nothing in its source notices."""


@dataclass(frozen=True, slots=True, kw_only=True)
class WiringFact:
    """One fact about how an app is wired; the kind says what its parts are."""

    kind: WiringFactKind
    subject: str
    value: str = ""
    others: tuple[str, ...] = ()
    evidence: tuple[Evidence, ...] = ()
