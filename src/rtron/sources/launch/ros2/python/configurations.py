"""The configurations of a launch as a function of a Python launch file sees them."""

from collections.abc import Iterator

from rtron.sources.code.interpreter.abstract_values.items import list_of
from rtron.sources.code.interpreter.abstract_values.value_types import Scalar, Unknown, Value
from rtron.sources.code.library_models.ros1_common.names import abstract_value as parameter_value
from rtron.sources.launch.ros2.launch_context import LaunchContext
from rtron.sources.launch.ros2.parameters.merge import ParameterSource
from rtron.sources.launch.ros2.python.substitutions import value_of

GLOBAL_PARAMETERS_KEY, REMAPS_KEY = "global_params", "ros_remaps"
"""The names under which launch_ros keeps what SetParameter and SetRemap set."""


def context_configurations(context: LaunchContext) -> dict[object, Value]:
    """Return what a context has as `launch_configurations`."""
    values: dict[object, Value] = {
        name: value_of(text) for name, text in context.configurations.items()
    }
    values |= {
        variable.name: Unknown(variable.name)
        for variable in context.unknown
        if not variable.is_environment
    }
    if context.parameters is not None:
        pairs = [pair for source in context.parameters for pair in _parameter_pairs(source)]
        values[GLOBAL_PARAMETERS_KEY] = list_of(pairs)
    if context.remaps is not None:
        values[REMAPS_KEY] = list_of([_pair(value_of(a), value_of(b)) for a, b in context.remaps])
    return values


def _parameter_pairs(source: ParameterSource) -> Iterator[Value]:
    """Yield a file's name, or a name with its value."""
    if source.file:
        yield value_of(source.file)
        return
    for _, values in source.entries:
        for name, parameter in values.items():
            yield _pair(Scalar(name), parameter_value(parameter.value, name))


def _pair(first: Value, second: Value) -> Value:
    return list_of([first, second], "tuple")
