"""A node's parameters in ROS 2, as a model asks for them (docs.ros.org: About parameters)."""

from collections.abc import Iterator

from rtron.sources.launch.ros2.parameters.merge import pattern_matches
from rtron.sources.models.common.model_scope import ModelScope
from rtron.sources.models.common.values import Placeholder, Value, with_placeholders
from rtron.vocabulary import ParameterValue

MAX_CHILDREN = 1000
_KINDS = {float: (float, int)}


def parameter_or_default(scope: ModelScope, name: str, default: Value = None) -> Value:
    """Return what is given for a parameter of the scope's node, or its default.

    Raise ValueError where it is of another kind than the default: the node refuses it.
    """
    values = [
        value for parameter_name, value in _launch_parameters(scope) if parameter_name == name
    ]
    value = with_placeholders(values[-1], name) if values else default
    kind = type(default)
    if default is not None and not isinstance(value, (Placeholder, _KINDS.get(kind, kind))):
        raise ValueError(f"parameter {name} is no {kind.__name__}")
    return value


def children(scope: ModelScope, prefix: str) -> list[str]:
    """Return the names right below `prefix.` among the parameters given, in order."""
    start = f"{prefix}."
    names_below = (
        name.removeprefix(start) for name, _ in _launch_parameters(scope) if name.startswith(start)
    )
    return list(dict.fromkeys(name.partition(".")[0] for name in names_below))[:MAX_CHILDREN]


def _launch_parameters(scope: ModelScope) -> Iterator[tuple[str, ParameterValue]]:
    """Yield what is given, the last of a name counts; overrides are the first node's alone."""
    yield from (
        (s.name, s.value)
        for s in scope.site.node_settings
        if pattern_matches(s.node, scope.private)
    )
    if scope.private == scope.site.name:
        yield from scope.site.overrides
