"""Whether a program of ROS 2 reads its parameters when it starts, and never again.

Then a parameter that is set while the app runs changes nothing, though its node takes it. By plain
names, as `reachability` does it: whatever may be called later counts as called.
"""

from collections.abc import Iterable
from dataclasses import replace

from rtron.sources.code import ir
from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.ir.references import called_names, callee_names, ir_nodes
from rtron.sources.code.reachability import has_unknown_base, reachable_functions
from rtron.sources.declaration import NodeInterface

_READS = frozenset(
    {"get_parameter", "get_parameter_or", "get_parameters", "get_parameters_by_prefix"}
)
_CHANGES = frozenset(
    [
        *("add_on_set_parameters_callback", "add_pre_set_parameters_callback"),
        *("add_post_set_parameters_callback", "set_on_parameters_set_callback"),
        *("ParameterEventHandler", "ParameterEventSubscriber", "add_parameter_callback"),
        *("add_parameter_event_callback", "on_parameter_event", "ParameterEvent"),
        *("ParamListener", "get_params", "is_old", "refresh_dynamic_parameters"),
    ]
)
"""What hears of a change: of rclcpp, of rclpy, and of generate_parameter_library."""


def mark_parameters_read_once(machine: AbstractMachine, interface: NodeInterface) -> NodeInterface:
    """Return what a program's nodes declare, their parameters marked if they are read once."""
    if not interface.parameters or machine.recorder.site.ros == 1:
        return interface
    read_once = _reads_parameters_once(machine)
    parameters = (replace(each, read_once=read_once) for each in interface.parameters)
    return replace(interface, parameters=tuple(parameters))


def _reads_parameters_once(machine: AbstractMachine) -> bool:
    """Tell whether nothing that runs after the start reads a parameter, or hears of a change."""
    lambdas = list(machine.lambdas.values())
    functions = [function for _, function in machine.runtime.program_functions()]
    if machine.parameter_callbacks or any(
        called_names(each) & _CHANGES for each in (*functions, *lambdas)
    ):
        return False
    made = [each for each in machine.instances if isinstance(each, av.Instance)]
    if any(has_unknown_base(machine, each) for each in made):
        return False
    repeated = _names_in_loops((*functions, *lambdas))
    later = [*machine.escaped_functions, *lambdas]
    later += [each for name in repeated for each in machine.runtime.functions_named(name)]
    reached = reachable_functions(machine, later, include_unrelated=True)
    return not (repeated & _READS or any(called_names(each) & _READS for each in reached))


def _names_in_loops(functions: Iterable[ir.Function]) -> frozenset[str]:
    """Return the plain names that are called while a condition holds: as long as a node spins."""
    loops = (
        node for each in functions for node in ir_nodes(each.body) if isinstance(node, ir.While)
    )
    calls = (node for loop in loops for node in ir_nodes(loop) if isinstance(node, ir.Call))
    return frozenset(name for call in calls for name in callee_names(call.function))
