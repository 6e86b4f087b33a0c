"""Parameters and node sites in a few words, and what an interface says as (kind, name, type)."""

from rtron.sources.declaration import NodeSite
from rtron.vocabulary import Evidence, Parameter, Parameters

HERE = Evidence(file="app.launch", line=1)


def parameters(values):
    found = Parameters()
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


def names(found, kind):
    return {d.name for d in found.declarations if d.kind == kind}


def told(found):
    return {(str(d.kind), d.name, d.type) for d in found.declarations}
