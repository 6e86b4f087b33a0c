"""Parameters of ROS 2's nodes: declared with a default, overridden by a launch.

rcl_yaml_param_parser: the keys of a parameter file are full names of nodes, in which `*` stands
for one part and `**` for any number of them.
"""

import re
from collections.abc import Callable, Iterator, Mapping
from functools import lru_cache
from typing import TypeGuard

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine, ThrownError
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.exceptions import is_caught, is_fully_known
from rtron.sources.code.library_models.ros1_common.names import abstract_value
from rtron.sources.code.library_models.ros2_common import parameter_types
from rtron.sources.code.library_models.ros2_common.nodes import (
    NAME_FIELD,
    node_name,
    uses_global_arguments,
)
from rtron.sources.declaration import plain_value
from rtron.vocabulary import NodeParameterValue

_PARAMETER_CLASSES = frozenset({"rclcpp::Parameter", "rclpy.parameter.Parameter"})
OVERRIDES_FIELD, AUTOMATIC_FIELD = "node.overrides", "node.automatic"
_WILDCARDS = {"/**": "(?:/[^/]+)*", "/*": "/[^/]+"}


def declare_node_parameter(
    machine: AbstractMachine, node: av.Value, name: av.Value, default: av.Value | None
) -> av.Value:
    """Declare a parameter and return its value; one that is declared already has its own."""
    values = [_declare_one(machine, node, option, default) for option in av.options(name)]
    return av.join(values)


def record_overrides(machine: AbstractMachine, node: av.Value) -> None:
    """Record what a node declares of all that is set for it (rclcpp: NodeOptions, rclpy: Node)."""
    if not (isinstance(node, av.Instance) and node.fields.get(AUTOMATIC_FIELD) == av.TRUE):
        return
    own = node.fields.get(OVERRIDES_FIELD)
    items = own.items if isinstance(own, av.ListValue) else ()
    given = [item.fields.get("name", av.NONE) for item in items if isinstance(item, av.Instance)]
    launched = [av.Scalar(one.name) for one in machine.recorder.site.settings]
    for name in (*launched, *given):
        value = override_value(machine, node, name)
        if value is not None:
            _record(machine, node, name, value)


def node_parameter_value(
    machine: AbstractMachine, node: av.Value, name: av.Value
) -> av.Value | None:
    """Return a parameter's value; None where it is certainly neither declared nor set."""
    found = [_one_value(machine, node, option) for option in av.options(name)]
    values = [value for value in found if value is not None]
    return av.join(values) if values else None


def read_node_parameter(machine: AbstractMachine, node: av.Value, name: av.Value) -> av.Value:
    """Return what is read of a parameter that has to be set; one that is declared only throws."""
    found = node_parameter_value(machine, node, name)
    if found is None or not (is_fully_known(found) and is_declared(machine, node, name)):
        machine.possible_throws += 1
    thrown = ThrownError("ParameterUninitializedException", has_unknown_bases=True)
    if parameter_types.is_unset(found) and is_caught(machine.active_handlers, thrown):
        raise thrown
    return av.Unknown("parameter", tainted=True) if found is None else found


def value_or_default(found: av.Value | None, default: av.Value) -> av.Value:
    """Return a parameter's value, the default where it is not set, both where that is unknown."""
    if found is None or parameter_types.is_unset(found):
        return default
    return av.join((default, found)) if isinstance(found, av.Unknown) else found


def has_parameter(machine: AbstractMachine, node: av.Value, arguments: Arguments) -> av.Value:
    """`has_parameter(name)`: whether it is declared; what is set may be declared by that alone."""
    name = arguments.value(0, "name")
    answer = is_declared(machine, node, name)
    is_automatic = isinstance(node, av.Instance) and node.fields.get(AUTOMATIC_FIELD) == av.TRUE
    if answer is False and is_automatic:
        found = node_parameter_value(machine, node, name)
        answer = None if isinstance(found, av.Unknown) else found is not None
    return av.Unknown("has_parameter") if answer is None else av.Scalar(answer)


def prefixed_name(prefix: av.Value | None, name: av.Value) -> av.Value:
    """Return a parameter's name behind the prefix of `declare_parameters`, if there is one."""
    if prefix is None or prefix == av.Scalar(""):
        return name
    return av.concat((prefix, av.Scalar("."), name))


PARAMETER_CALLBACKS = tuple(f"add_{when}_set_parameters_callback" for when in ("on", "pre", "post"))
"""The methods of a node that register what a change of parameters calls."""


def is_declared(machine: AbstractMachine, node: av.Value, name: av.Value) -> bool | None:
    """Tell whether a parameter was declared; None where that cannot be known."""
    answers = {
        _parameter_key(node, option) in machine.parameters
        if isinstance(option, av.Scalar)
        else None
        for option in av.options(name)
    }
    return answers.pop() if len(answers) == 1 else None


def is_parameter(value: av.Value | None) -> TypeGuard[av.Instance]:
    """Tell whether a value is a Parameter of a client library."""
    return isinstance(value, av.Instance) and value.type.name in _PARAMETER_CLASSES


def unwrap_parameter(value: av.Value | None) -> av.Value | None:
    """Return what a parameter holds; any other value as it is."""
    return value.fields["value"] if is_parameter(value) else value


def set_parameters(machine: AbstractMachine, node: av.Value, arguments: Arguments) -> av.Value:
    """`set_parameter(Parameter(name, value))`, `set_parameters([…])`."""
    given = arguments.get(0, "parameter_list") or av.NONE
    for item in av.items_of(given)[0] if isinstance(given, av.ListValue) else av.options(given):
        for name in av.options(item.fields["name"]) if is_parameter(item) else ():
            key, value = _parameter_key(node, name), unwrap_parameter(item) or av.NONE
            machine.undo_log.set(machine.parameters, key, value)
    return av.Unknown("set_parameters")


def override_value(machine: AbstractMachine, node: av.Value, name: av.Value) -> av.Value | None:
    """Return what a launch, or the node's own options, set; None where they certainly do not."""
    if not isinstance(name, av.Scalar):
        return av.Unknown(short_name(machine, node, av.text_with_holes(name)), tainted=True)
    own = node.fields.get(OVERRIDES_FIELD) if isinstance(node, av.Instance) else None
    if isinstance(own, av.ListValue):
        for item in reversed(own.items):
            if isinstance(item, av.Instance) and _has_name(item.fields.get("name"), name):
                return item.fields.get("value", av.NONE)
    full, found = av.text_with_holes(node_name(node)), None
    for one in machine.recorder.site.settings if uses_global_arguments(node) else ():
        if one.name == name.value and _node_pattern(one.node).fullmatch(full):
            found = one
    if found is None:
        return None
    return abstract_value(found.value, short_name(machine, node, found.name))


def _has_name(given: av.Value | None, name: av.Scalar) -> bool:
    return isinstance(given, av.Scalar) and given.value == name.value


def note_parameter_callbacks(machine: AbstractMachine, arguments: Arguments) -> None:
    """Remember the functions that a change of parameters calls."""
    for value in arguments.all_values:
        machine.parameter_callbacks += [
            o.function for o in av.options(value) if isinstance(o, av.FunctionValue)
        ]


def short_name(machine: AbstractMachine, node: av.Value, name: str) -> str:
    """Return a parameter as a note spells it: `~topic` of the site's node, `/other/topic`."""
    full = av.text_with_holes(node_name(node))
    site = machine.recorder.site
    own = site.name == full or not (site.has_launch_name or site.loading)
    return f"~{name}" if own else f"{full}/{name}"


def _declare_one(
    machine: AbstractMachine, node: av.Value, name: av.Value, default: av.Value | None
) -> av.Value:
    key = _parameter_key(node, name)
    if key in machine.parameters:
        machine.possible_throws += 1
        return machine.parameters[key]
    value = _initial_value(machine, node, name, default)
    _record(machine, node, name, value)
    machine.possible_throws += not _has_type_of(value, default)
    machine.undo_log.set(machine.parameters, key, value)
    return value


def _has_type_of(value: av.Value, default: av.Value | None) -> bool:
    """Tell whether a parameter's value is certainly of the type that it is declared with."""
    if not (isinstance(value, av.Scalar) and isinstance(default, av.Scalar)):
        return isinstance(value, av.ListValue) and value.items == getattr(default, "items", None)
    return type(value.value) is type(default.value)


def _record(machine: AbstractMachine, node: av.Value, name: av.Value, value: av.Value) -> None:
    """Record a parameter; what is not known of its name stands in braces."""
    for owner in av.options(node_name(node)):
        machine.recorder.add_parameter(
            av.text_with_holes(owner), av.text_with_holes(name), plain_parameter_value(value)
        )


def plain_parameter_value(value: av.Value) -> NodeParameterValue | None:
    """Return what a parameter holds, None where that is not known or no parameter's."""
    if isinstance(value, av.ListValue) and not value.open:
        items = [plain_parameter_value(item) for item in value.items]
        found = tuple(item for item in items if isinstance(item, (bool, int, float, str)))
        return found if len(found) == len(items) else None
    held = value.value if isinstance(value, av.Scalar) else None
    return plain_value(held)


def _initial_value(
    machine: AbstractMachine, node: av.Value, name: av.Value, default: av.Value | None
) -> av.Value:
    found = override_value(machine, node, name)
    if found is not None and not isinstance(found, av.Unknown):
        return found
    hole = av.Unknown(short_name(machine, node, av.text_with_holes(name)), tainted=True)
    if (
        default is not None
        and parameter_types.is_parameter_type(default)
        and found is None
        and knows_all_overrides(machine, node)
    ):
        return parameter_types.unset_value(hole.label)
    if default is None or parameter_types.is_parameter_type(default):
        return hole
    marked = _tainted(default)
    if found is None and knows_all_overrides(machine, node):
        return marked
    return _with_unknown_item(marked, hole) or av.join((marked, hole))


def _with_unknown_item(value: av.Value, hole: av.Unknown) -> av.Value | None:
    """Return a list with one item that stands for all others that a launch may give."""
    if not isinstance(value, av.ListValue):
        return None
    more = av.Unknown(f"{hole.label}[]", tainted=True)
    return av.ListValue({**value.fields, "items": (*value.items, more)}, value.kind)


def _one_value(machine: AbstractMachine, node: av.Value, name: av.Value) -> av.Value | None:
    key = _parameter_key(node, name)
    if key in machine.parameters:
        return machine.parameters[key]
    found = override_value(machine, node, name)
    if found is None and not knows_all_overrides(machine, node):
        return av.Unknown(short_name(machine, node, av.text_with_holes(name)), tainted=True)
    return found


def knows_all_overrides(machine: AbstractMachine, node: av.Value) -> bool:
    """Tell whether all that is set for a node is known."""
    site = machine.recorder.site
    process = (
        site.loading is None or site.loading.is_process_known or not uses_global_arguments(node)
    )
    return site.parameters_complete and process


def _tainted(value: av.Value) -> av.Value:
    """Return a default marked as a parameter's value, which the launch may change."""
    if isinstance(value, av.Scalar):
        return av.Scalar(value.value, tainted=True)
    if isinstance(value, av.ListValue):
        items = tuple(_tainted(item) for item in value.items)
        return av.ListValue({**value.fields, "items": items}, value.kind)
    return av.join(map(_tainted, value.options)) if isinstance(value, av.Choice) else value


def _parameter_key(node: av.Value, name: av.Value) -> str:
    full = node.fields.get(NAME_FIELD) if isinstance(node, av.Instance) else None
    return f"{av.text_with_holes(full) if full is not None else ''} {av.text_with_holes(name)}"


@lru_cache(maxsize=4096)
def _node_pattern(key: str) -> re.Pattern[str]:
    absolute = key if key.startswith("/") else f"/{key}"
    pieces = re.split(r"(/\*\*|/\*)(?=/|$)", absolute)
    return re.compile("".join(_WILDCARDS.get(piece, re.escape(piece)) for piece in pieces))


_ANY_DEPTH = 0
_RESULT = av.LibraryClass("rcl_interfaces/ListParametersResult")


def parameter_names(machine: AbstractMachine, node: av.Value) -> tuple[list[str], bool]:
    """Return the parameters that a node has declared, sorted, and whether these are all.

    A node that declares what a launch sets has all of that too.
    """
    names = set(_declared_names(machine, node))
    is_automatic = isinstance(node, av.Instance) and node.fields.get(AUTOMATIC_FIELD) == av.TRUE
    if is_automatic:
        given = {one.name for one in machine.recorder.site.settings}
        names |= {name for name in given if override_value(machine, node, av.Scalar(name))}
    return sorted(names), not is_automatic or knows_all_overrides(machine, node)


def _declared_names(machine: AbstractMachine, node: av.Value) -> Iterator[str]:
    full = node.fields.get(NAME_FIELD) if isinstance(node, av.Instance) else None
    start = f"{av.text_with_holes(full)} " if full is not None else " "
    for key in machine.parameters:
        if key.startswith(start):
            yield key.removeprefix(start)


def names_below(names: list[str], prefix: str) -> dict[str, str]:
    """Return those of some names that are below a prefix, with what stands behind it."""
    start = f"{prefix}." if prefix else ""
    return {name: name.removeprefix(start) for name in names if name.startswith(start)}


def list_parameters(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`list_parameters(prefixes, depth)`: their names, and what stands before the last dots."""
    names, is_whole = parameter_names(machine, owner)
    prefixes, is_known = av.items_of(arguments.get(0, "prefixes") or av.NONE)
    depth = arguments.get(1, "depth")
    deepest = depth.value if isinstance(depth, av.Scalar) else _ANY_DEPTH
    texts = [str(one.value) for one in prefixes if isinstance(one, av.Scalar)]
    certain = is_whole and is_known and len(texts) == len(prefixes)
    listed = [name for name in names if _is_listed(name, texts, deepest)]
    before = dict.fromkeys(name.rpartition(".")[0] for name in listed if "." in name)
    fields = {"names": listed, "prefixes": before}
    return av.Instance(
        _RESULT,
        {key: av.list_of(map(av.Scalar, found), certain=certain) for key, found in fields.items()},
    )


def _is_listed(name: str, prefixes: list[str], depth: int) -> bool:
    """Tell whether a name is below a prefix, with fewer dots behind it than `depth`; 0 is any."""
    behind = [names_below([name], prefix).get(name) for prefix in prefixes or [""]]
    return name in prefixes or any(
        rest is not None and (depth == _ANY_DEPTH or rest.count(".") < depth) for rest in behind
    )


PARAMETER_METHODS: Mapping[str, Callable[..., av.Value]] = {
    "has_parameter": has_parameter,
    "list_parameters": list_parameters,
    **dict.fromkeys(
        ("set_parameter", "set_parameters", "set_parameters_atomically"), set_parameters
    ),
}
"""The methods of a node that are the same in both client libraries."""
