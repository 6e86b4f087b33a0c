"""A guarded base in ROS 2 as its domain would show it, without one: made by hand, end by end."""

from dataclasses import dataclass, field, replace

from plans import grcn, plan_of

from rtron.guard.audit.ros2.observed_graph import ObservedGraph
from rtron.guard.audit.ros2.verification import verify_ros2
from rtron.vocabulary import BULK_NODE, GUARD_NODE, Direction, Flow, QoS

CMD_VEL = "/cmd_vel"
OUT, FLOW1, FLOW2 = (f"/rtron{CMD_VEL}/{name}" for name in ("out", "flow1", "flow2"))
GRCN = "/rtron/grcn_cmd_vel"
NAVIGATE = "/navigate"
NAVIGATE_GRCN = "/rtron/grcn_navigate"
TWIST = "geometry_msgs/msg/Twist"
SEND_GOAL = "/_action/send_goal"
CANCEL_GOAL = "/_action/cancel_goal"


@dataclass(frozen=True, kw_only=True)
class End:
    """An endpoint as `rtron.wire.ros2` tells it."""

    topic: str
    direction: Direction
    node: str
    gid: bytes
    type: str = TWIST
    type_hash: str = ""
    qos: QoS = field(default_factory=QoS)

    @property
    def participant(self):
        return self.gid[:12]


def participant(process):
    """Return the participant of a process on a host, as Fast DDS names it."""
    return b"\x01\x0f\x78\xfd" + process.to_bytes(2, "little") + bytes(6)


GUARD, NAV, TELEOP, DRIVER, ROGUE = (participant(n) for n in (1000, 2000, 3000, 4000, 5000))


def publisher(topic, node, of, **more):
    gid = of + hash((topic, node)).to_bytes(8, "little", signed=True)[:4]
    return End(topic=topic, direction=Direction.PUBLISH, node=node, gid=gid, **more)


def subscriber(topic, node, of, **more):
    return replace(publisher(topic, node, of, **more), direction=Direction.SUBSCRIBE)


def base_plan(**more):
    """Return the plan: two flows on the way to the driver."""
    flows = (
        Flow(name="flow1", publisher="/nav", priority=2),
        Flow(name="flow2", publisher="/teleop_*", priority=1),
    )
    node = grcn(CMD_VEL, (), ["/driver"], flows=flows, **more)
    return replace(plan_of(node, app="base"), ros=2)


def action_plan():
    """Return a plan for an action with one client."""
    flows = (Flow(name="flow1", publisher="/mission", priority=1),)
    node = grcn(NAVIGATE, (), ["/server"], type="nav2_msgs/action/NavigateToPose", flows=flows)
    return replace(plan_of(node, app="acting"), ros=2)


GUARDS = (
    publisher(OUT, GRCN, GUARD),
    publisher(CMD_VEL, GRCN, GUARD),
    subscriber(FLOW1, GRCN, GUARD),
    subscriber(FLOW2, GRCN, GUARD),
    subscriber(CMD_VEL, GRCN, GUARD),
)
NAV_PUBLISHES = publisher(FLOW1, "/nav", NAV)
DRIVER_SUBSCRIBES = subscriber(OUT, "/driver", DRIVER)
CLOSED = (*GUARDS, NAV_PUBLISHES, DRIVER_SUBSCRIBES)
NODES = (GUARD_NODE, BULK_NODE, GRCN, "/nav", "/driver")


def client_endpoint(action, part, node, of):
    """Return a client's end of one of an action's services."""
    return publisher(f"rq{action}{part}Request", node, of, type="x")


def server_endpoints(action, part, node, of):
    """Return a server's two ends of one of an action's services."""
    return (
        subscriber(f"rq{action}{part}Request", node, of, type="x"),
        publisher(f"rr{action}{part}Reply", node, of, type="x"),
    )


def verified(ends=CLOSED, nodes=NODES, services=(), plan=None, absent=("/teleop_*",)):
    """Return the result of a domain; teleop is known to be off, unless a test says otherwise."""
    found = verify_ros2(plan or base_plan(), ObservedGraph(ends, nodes, services))
    return found.without(absent)


def path_of(verification, node):
    (path,) = (path for path in verification.paths if path.node == node)
    return path
