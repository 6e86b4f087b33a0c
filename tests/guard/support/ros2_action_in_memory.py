"""A guarded action of ROS 2 in memory: a test speaks for its clients and its server."""

from collections import defaultdict

from plans import grcn, plan_of

from rtron.guard.coordinator import Coordinator
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.guard.transport.common.protocol import Peer, TypeInfo
from rtron.messages.common.encoding import Encoding
from rtron.messages.ros2.actions import GoalMessage, GoalStatus, read_statuses, status_array
from rtron.vocabulary import SECOND, PolicyName, Ros2ActionEntity, StreamKind, build_streams

TYPE = "demo_msgs/action/Go"
INFO = TypeInfo("demo_msgs/Go_Goal", "0" * 32)
ONE, TWO, SERVER = "/one", "/two", "/server"
FLOW = {ONE: "flow1", TWO: "flow2"}
UNKNOWN, ACCEPTED, EXECUTING, CANCELING, SUCCEEDED, CANCELED, ABORTED = range(7)


class Reply:
    """A request's reply: it notes each answer."""

    def __init__(self, token=""):
        self.token = token
        self.is_reachable = True
        self.answers = []

    def __call__(self, *answer):
        self.answers.append(answer if len(answer) > 1 else answer[0])


class MemoryActionEndpoints:
    """Notes the guard's requests to the server, for a test to answer, and what clients get."""

    type_info = INFO

    def __init__(self, listener):
        self.listener = listener
        self.goals, self.cancels, self.results = {}, {}, {}
        self.published = defaultdict(list)
        self.replies = {}

    def open(self):
        pass

    def send_goal(self, goal, on_reply):
        assert goal.id not in self.goals
        self.goals[goal.id] = on_reply

    def cancel(self, id, stamp, on_reply):
        self.cancels[id, stamp] = on_reply

    def get_result(self, id, on_reply):
        self.results[id] = on_reply

    def publish(self, end, message, flows=None):
        self.published[end].append((message, flows))

    def restore_reply(self, token):
        return self.replies.setdefault(token, Reply(token))


class MemoryActionTransport(MemoryTransport):
    """A transport in memory that carries requests."""

    encoding = Encoding.CDR

    def action_endpoints(self, _stream, _node, listener):
        self.endpoints = MemoryActionEndpoints(listener)
        return self.endpoints


class Ros2ActionApp:
    """A guarded action with two clients, by default with its server."""

    def __init__(
        self, policy=PolicyName.FIFO_QUEUE, *, handover=None, served=True, dry_run=False, **settings
    ):
        defaults = {
            "type": TYPE,
            "kind": StreamKind.ACTION,
            "policy": policy,
            "max_age": 60 * SECOND,
        }
        self.plan = plan_of(grcn("/go", [ONE, TWO], [SERVER], **defaults | settings), ros=2)
        self.transport = MemoryActionTransport()
        self.coordinator = Coordinator(
            self.transport, build_streams(self.plan), handover=handover, dry_run=dry_run
        )
        self.coordinator.open()
        (self.action,) = self.coordinator.streams
        self.endpoints = self.transport.endpoints
        if served:
            self.serve()

    def doubt(self, why="2 nodes serve it"):
        self.action.on_server_doubt(why)

    def serve(self, incarnation=b"first"):
        self.action.on_server_available(SERVER, incarnation)

    def send_goal(self, node, id, *, flow="", verified=True, goal=b"\0\1\0\0goal"):
        """Send a goal; return the answers."""
        reply = Reply()
        peer = Peer(node, INFO, verified=verified)
        message = GoalMessage.of(goal_id(id), goal)
        self.action.on_goal_request(flow or FLOW[node], peer, lambda: message, reply)
        return reply.answers

    def request_result(self, node, id, *, flow=""):
        """Ask for a result; return the answers."""
        reply = Reply(f"{node} {id}")
        self.action.on_result_request(flow or FLOW[node], Peer(node, INFO), goal_id(id), reply)
        return reply.answers

    def cancel(self, node, id=0, stamp=0, *, flow="", verified=True):
        """Send a cancel; return the answers as (code, ids)."""
        reply = Reply()
        peer = Peer(node, INFO, verified=verified)
        self.action.on_cancel_request(flow or FLOW[node], peer, goal_id(id), stamp, reply)
        return reply.answers

    def accept(self, id, stamp=5):
        self.endpoints.goals[goal_id(id)](stamp)

    def reject(self, id):
        self.endpoints.goals[goal_id(id)](None)

    def finish(self, id, status=SUCCEEDED, result="result"):
        self.endpoints.results[goal_id(id)](status, result)

    def publish_status(self, *statuses):
        message = status_array(GoalStatus(goal_id(id), 5, status) for id, status in statuses)
        self.action.on_server_message(Ros2ActionEntity.STATUS, message)

    def started(self):
        return [id[0] for id in self.endpoints.goals]

    def listed(self):
        """Return the states in the last status that clients got."""
        self.transport.advance(SECOND // 10)
        message, flows = self.endpoints.published[Ros2ActionEntity.STATUS][-1]
        assert flows is None
        return {each.id[0]: each.status for each in read_statuses(message)}


def goal_id(id):
    return bytes([id]) * 16 if id else bytes(16)
