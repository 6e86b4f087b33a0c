"""The configurations of a launch as a function of a Python launch file sees them."""

from collections.abc import Iterator

from rtron.sources.code.interpreter.abstract_values.items import listed
from rtron.sources.code.interpreter.abstract_values.value_types import Hole, Known, Value
from rtron.sources.code.library_models.ros1_common.names import value_of as parameter_value
from rtron.sources.launch.ros2.launch_context import Scope
from rtron.sources.launch.ros2.parameters.merge import ParameterSource
from rtron.sources.launch.ros2.python.substitutions import value_of

GLOBAL_PARAMETERS, REMAPS = "global_params", "ros_remaps"
"""The names under which launch_ros keeps what SetParameter and SetRemap set."""


def configurations(scope: Scope) -> dict[object, Value]:
    """Return what a context has as `launch_configurations`."""
    found: dict[object, Value] = {
        name: value_of(text) for name, text in scope.configurations.items()
    }
    found |= {one.name: Hole(one.name) for one in scope.unknown if not one.environment}
    if scope.parameters is not None:
        pairs = [pair for source in scope.parameters for pair in _pairs(source)]
        found[GLOBAL_PARAMETERS] = listed(pairs)
    if scope.remaps is not None:
        found[REMAPS] = listed([_pair(value_of(a), value_of(b)) for a, b in scope.remaps])
    return found


def _pairs(source: ParameterSource) -> Iterator[Value]:
    """Yield a file's name, or a name with its value."""
    if source.file:
        yield value_of(source.file)
        return
    for _, values in source.entries:
        for name, one in values.items():
            yield _pair(Known(name), parameter_value(one.value, name))


def _pair(first: Value, second: Value) -> Value:
    return listed([first, second], "tuple")
