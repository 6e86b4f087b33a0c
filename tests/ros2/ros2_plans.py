"""Plans for guarded apps of ROS 2, as their files say them."""

from plans import grcn, plan_of

from rtron.planning import write_plan
from rtron.vocabulary import Flow, StreamKind


def driving(*nodes, **flow):
    """Return the GRCN before /driver; of the flows, named like their nodes, the first leads."""
    return _contended("/cmd_vel", "geometry_msgs/msg/Twist", "/driver", nodes, flow)


def telling(topic, type, successor, *nodes):
    """Return a GRCN of a state that nodes contend for."""
    return _contended(topic, type, successor, nodes, {}, kind=StreamKind.STATE)


def written(*grcns, **more):
    """Return the text of a plan."""
    return write_plan(plan_of(*grcns, app="robot", ros=2, revision=1, **more))


def _contended(topic, type, successor, nodes, flow, **more):
    flows = tuple(
        Flow(name=node, publisher=f"/{node}", priority=len(nodes) - rank, **flow)
        for rank, node in enumerate(nodes)
    )
    return grcn(topic, (), [successor], type=type, flows=flows, **more)
