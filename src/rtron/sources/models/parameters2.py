"""A node's parameters in ROS 2, as a model asks for them (docs.ros.org: About parameters)."""

from collections.abc import Iterator

from rtron.sources.launch.ros2.parameters.merge import names
from rtron.sources.models.common.model_scope import Scope
from rtron.sources.models.common.values import Hole, Value, known
from rtron.vocabulary import ParameterValue

MAX_CHILDREN = 1000
_KINDS = {float: (float, int)}


def parameter(scope: Scope, name: str, default: Value = None) -> Value:
    """Return what is given for a parameter of the scope's node, or its default.

    Raise ValueError where it is of another kind than the default: the node refuses it.
    """
    found = [value for given, value in _given(scope) if given == name]
    value = known(found[-1], name) if found else default
    kind = type(default)
    if default is not None and not isinstance(value, (Hole, _KINDS.get(kind, kind))):
        raise ValueError(f"parameter {name} is no {kind.__name__}")
    return value


def children(scope: Scope, prefix: str) -> list[str]:
    """Return the names right below `prefix.` among the parameters given, in order."""
    start = f"{prefix}."
    below = (name.removeprefix(start) for name, _ in _given(scope) if name.startswith(start))
    return list(dict.fromkeys(name.partition(".")[0] for name in below))[:MAX_CHILDREN]


def _given(scope: Scope) -> Iterator[tuple[str, ParameterValue]]:
    """Yield what is given, the last of a name counts; overrides are the first node's alone."""
    yield from ((s.name, s.value) for s in scope.site.own_settings if names(s.node, scope.private))
    if scope.private == scope.site.name:
        yield from scope.site.overrides
