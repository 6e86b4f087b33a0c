"""Parameters and node sites in a few words, and what an interface says as (kind, name, type)."""

from rtron.sources.declaration import NodeSite, ParameterSetting
from rtron.vocabulary import Evidence, Parameter, ParameterTree

HERE = Evidence(file="app.launch", line=1)


def parameters(values):
    found = ParameterTree()
    for name, value in values.items():
        found.set(name, Parameter(value=value, evidence=HERE))
    return found


def site(name="/robot/driver", values=None, args="", remaps=(), environ=()):
    return NodeSite(
        name=name,
        args=tuple(args.split()),
        parameters=parameters(values or {}),
        remaps=tuple(remaps),
        environ=tuple(environ),
    )


def names(fake_study, kind):
    return {d.name for d in fake_study.declarations if d.kind == kind}


def told(fake_study):
    return {(str(d.kind), d.name, d.type) for d in fake_study.declarations}


def frames(found):
    """Return the child and parent frame of each transform that a node broadcasts."""
    return [(frame.child, frame.parent) for frame in found.frames]


URDF = """<robot><joint type="fixed"><parent link="base"/><child link="laser"/></joint>
<joint type="revolute"><parent link="base"/><child link="arm"/></joint>
<joint type="floating"><parent link="base"/><child link="kite"/></joint></robot>"""
"""A robot with a joint that never moves, one that does, and one that nobody broadcasts."""


def ros2_node_site(name="/robot/driver", settings=None, args="", environ=(), *, named=True):
    """Return a site of ROS 2; `settings` are parameters by a pattern of node names."""
    return NodeSite(
        name=name,
        ros=2,
        args=tuple(args.split()),
        environ=tuple(environ),
        has_launch_name=named,
        settings=tuple(
            ParameterSetting(node=node, name=key, value=value)
            for node, values in (settings or {}).items()
            for key, value in values.items()
        ),
    )


def model_texts(model):
    """Yield each text of a model that holds an expression, as (kind, text)."""
    yield from (("expression", text) for text in model.let.values())
    yield "template", model.name
    for entry in model.walk():
        yield from (("expression", text) for text in entry.let.values())
        yield from (("expression", text) for text in entry.passed.values())
        names = (entry.name, entry.uses, entry.type, entry.namespace, entry.private, entry.node)
        messages = (entry.qos, entry.unresolved, entry.why, entry.broadcast, entry.parent)
        yield from (("template", text) for text in (*names, *messages) if text)
        if entry.condition:
            yield "expression", entry.condition
        if entry.loop:
            yield "expression", entry.loop.partition(" in ")[2]
