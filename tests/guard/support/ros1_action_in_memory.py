"""A guarded action of ROS 1 in memory: two clients, a stranger and a server as raw messages."""

import struct

from streams import stage, stream

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.message_types import standard_info
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.guard.transport.common.protocol import Peer, TypeInfo
from rtron.messages.common.definition_parser import parse_definition
from rtron.messages.common.encoding import Encoding
from rtron.messages.ros1.actions import (
    ACTIVE,
    SUCCEEDED,
    GoalID,
    GoalStatus,
    read_goal,
    read_result,
    read_statuses,
    result_message,
    with_statuses,
)
from rtron.vocabulary import SECOND, Flow, PolicyName, StreamKind

GOAL_TYPE, RESULT_TYPE = "demo_msgs/GoActionGoal", "demo_msgs/GoActionResult"
RULE = "=" * 80
HEADER = f"\n{RULE}\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id"
ID = f"\n{RULE}\nMSG: actionlib_msgs/GoalID\ntime stamp\nstring id"
STATUS = (
    f"\n{RULE}\nMSG: actionlib_msgs/GoalStatus\n"
    "actionlib_msgs/GoalID goal_id\nuint8 status\nstring text"
)
FLOWS = (
    Flow(name="flow1", publisher="/one", priority=1),
    Flow(name="flow2", publisher="/two", priority=2),
    Flow(name="flow3", publisher="/rogue", priority=3, block=True),
)
ONE, TWO, SERVER = "/one", "/two", "/server"


def info(type, text):
    return TypeInfo(type, parse_definition(type, text).md5sum, text)


GOAL = info(
    GOAL_TYPE,
    "std_msgs/Header header\nactionlib_msgs/GoalID goal_id\ndemo_msgs/GoGoal goal"
    + HEADER
    + ID
    + f"\n{RULE}\nMSG: demo_msgs/GoGoal\nint32 x",
)
RESULT = info(
    RESULT_TYPE,
    "std_msgs/Header header\nactionlib_msgs/GoalStatus status\ndemo_msgs/GoResult result"
    + HEADER
    + STATUS
    + ID
    + f"\n{RULE}\nMSG: demo_msgs/GoResult\nint32 y\nstring why",
)
CANCEL = standard_info("actionlib_msgs/GoalID", Encoding.ROS1)
STATUSES = standard_info("actionlib_msgs/GoalStatusArray", Encoding.ROS1)


def framed(body):
    return struct.pack("<I", len(body)) + body


def goal_message(id, stamp=0, x=0):
    goal_id = struct.pack("<II", *divmod(stamp, SECOND)) + struct.pack("<I", len(id)) + id
    return framed(bytes(16) + goal_id + struct.pack("<i", x))


def status_message(*statuses):
    return with_statuses(framed(bytes(16 + 4)), statuses)


def cancel_of(id=b"", stamp=0):
    return framed(struct.pack("<II", *divmod(stamp, SECOND)) + struct.pack("<I", len(id)) + id)


class Ros1ActionApp:
    """The guard of /act; a test publishes in the name of a node, and it arrives at once."""

    def __init__(self, policy=PolicyName.FIFO_QUEUE, *streams, handover=None, flows=FLOWS, **more):
        settings = {key: more.pop(key) for key in ("max_age", "max_hold") if key in more}
        settings.setdefault("max_age", 60 * SECOND)
        queue = stage("grcn_act", policy, flows, StreamKind.ACTION, **settings)
        self.stream = stream(
            queue, topic="/act/goal", type=GOAL_TYPE, flows=flows, successors=(SERVER,), **more
        )
        self.transport = MemoryTransport()
        self.coordinator = Coordinator(self.transport, [self.stream, *streams], handover=handover)
        self.coordinator.open()
        self.action = self.coordinator.streams[0]
        self.to_server = self.transport.listen("/rtron/act/goal/out")
        self.cancels = self.transport.listen("/rtron/act/cancel/out")
        self.results = self.transport.listen("/rtron/act/result/out")
        self.statuses = self.transport.listen("/rtron/act/status/out")
        self._publishers = {}

    def publish(self, topic, node, type, message, **more):
        """Publish on one connection for each node and topic."""
        key = (topic, node)
        if key not in self._publishers:
            self._publishers[key] = self.transport.publisher(topic, Peer(node, type, **more))
        self._publishers[key](message)
        self.transport.advance(0)

    def serve(self, *statuses):
        """Let the server be there, with these goals."""
        if self.action.server.state.empty_result is None:
            self.publish("/rtron/act/result/server", SERVER, RESULT, framed(b""))
        self.publish("/rtron/act/status/server", SERVER, STATUSES, status_message(*statuses))

    def reconnect_server(self):
        """Let the next status come over another connection."""
        self._publishers.pop(("/rtron/act/status/server", SERVER))

    def send_goal(self, node, id, stamp=0, **more):
        flow = next((f.name for f in self.stream.flows if f.publisher == node), None)
        topic = f"/rtron/act/goal/{flow}" if flow else "/act/goal"
        self.publish(topic, node, GOAL, goal_message(id, stamp), **more)

    def cancel(self, node, id=b"", stamp=0):
        flow = next((f.name for f in self.stream.flows if f.publisher == node), None)
        topic = f"/rtron/act/cancel/{flow}" if flow else "/act/cancel"
        self.publish(topic, node, CANCEL, cancel_of(id, stamp))

    def finish(self, id, status=SUCCEEDED):
        message = result_message(0, GoalStatus(GoalID(id, 0), status), bytes(8))
        self.publish("/rtron/act/result/server", SERVER, RESULT, message)

    def started(self):
        """Return the ids of the goals that the server got."""
        return [read_goal(message).id for message in self.to_server]

    def answers(self):
        """Return the results that clients got, as (id, state)."""
        statuses = map(read_result, self.results)
        return [(status.goal.id, status.status) for status in statuses]

    def listed(self):
        """Return the states in the last status that clients got, by the goal's id."""
        self.transport.advance(SECOND // 50)
        return read_statuses(self.statuses[-1])


def active(*ids):
    return [GoalStatus(GoalID(id, 0), ACTIVE) for id in ids]


SIMPLE = "/act_simple/goal"
POSE = TypeInfo("geometry_msgs/PoseStamped", "d3812c3cbc69362b77dc0b19b345f8f5")


def simple_stream(**more):
    queue = stage(
        "grcn_simple", PolicyName.FIFO_QUEUE, FLOWS, StreamKind.ACTION, max_age=60 * SECOND
    )
    settings = {"topic": SIMPLE, "type": POSE.type, "successors": (SERVER,), "done": "/act/result"}
    return stream(queue, flows=FLOWS, **settings | more)


class SimpleGoalApp(Ros1ActionApp):
    """A guarded action whose server takes goals on /act_simple/goal, too."""

    def __init__(self):
        super().__init__(PolicyName.FIFO_QUEUE, simple_stream())
        self.simple = self.transport.listen("/rtron/act_simple/goal/out")
        self.serve()

    def publish_pose(self, node, goal):
        flow = next(f.name for f in FLOWS if f.publisher == node)
        self.publish(f"/rtron/act_simple/goal/{flow}", node, POSE, goal)
