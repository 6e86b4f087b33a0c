"""Plans for apps that are guarded."""

from rtron.vocabulary import GRCN, Domain, Flow, Mode, Plan, PolicyName, Sharing, StreamKind


def grcn(topic, publishers, successors, **settings):
    """Return a GRCN that enforces Preemption on velocities, unless `settings` say otherwise."""
    flows = tuple(Flow(name=f"flow{n}", publisher=p) for n, p in enumerate(publishers, 1))
    defaults = {
        "id": f"grcn{topic.replace('/', '_')}",
        "topic": topic,
        "type": "geometry_msgs/Twist",
        "domain": Domain.CONTROL,
        "kind": StreamKind.COMMAND,
        "sharing": Sharing.CONTEND,
        "mode": Mode.ENFORCE,
        "policy": PolicyName.PREEMPTION,
        "flows": flows,
        "successors": tuple(successors),
    }
    return GRCN(**defaults | settings)


def plan_of(*grcns, app="app", **more):
    return Plan(app=app, grcn=grcns, **more)
