"""Parameters of ROS 2's nodes: declared with a default, overridden by a launch.

rcl_yaml_param_parser: the keys of a parameter file are full names of nodes, in which `*` stands
for one part and `**` for any number of them.
"""

import re
from functools import lru_cache

from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    TRUE,
    Choice,
    FunctionValue,
    Hole,
    Instance,
    Known,
    ListValue,
    Value,
    join,
    options,
    spelled,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine, ThrownError
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.exceptions import is_sure
from rtron.sources.code.library_models.ros1_common.names import value_of
from rtron.sources.code.library_models.ros2_common.nodes import NAME, name_of, takes_globals
from rtron.sources.code.library_models.ros2_common.parameter_types import is_kind, is_unset, unset
from rtron.sources.declaration import plain_value
from rtron.vocabulary import PlainValue

OVERRIDES, AUTOMATIC = "node.overrides", "node.automatic"
_PARTS = {"/**": "(?:/[^/]+)*", "/*": "/[^/]+"}


def declared(machine: Machine, node: Value, name: Value, default: Value | None) -> Value:
    """Declare a parameter and return its value; one that is declared already has its own."""
    values = [_declared(machine, node, option, default) for option in options(name)]
    return join(values)


def tell_overrides(machine: Machine, node: Value) -> None:
    """Record what a node declares of all that is set for it (rclcpp: NodeOptions, rclpy: Node)."""
    if not (isinstance(node, Instance) and node.fields.get(AUTOMATIC) == TRUE):
        return
    own = node.fields.get(OVERRIDES)
    items = own.items if isinstance(own, ListValue) else ()
    given = [item.fields.get("name", NONE) for item in items if isinstance(item, Instance)]
    launched = [Known(one.name) for one in machine.recorder.site.settings]
    for name in (*launched, *given):
        value = setting(machine, node, name)
        if value is not None:
            _told(machine, node, name, value)


def known(machine: Machine, node: Value, name: Value) -> Value | None:
    """Return a parameter's value; None where it is certainly neither declared nor set."""
    found = [_known(machine, node, option) for option in options(name)]
    values = [value for value in found if value is not None]
    return join(values) if values else None


def read(machine: Machine, node: Value, name: Value) -> Value:
    """Return what is read of a parameter that has to be set; one that is declared only throws."""
    found = known(machine, node, name)
    if found is None or not (is_sure(found) and is_declared(machine, node, name)):
        machine.doubts += 1
    if is_unset(found) and machine.catching:
        raise ThrownError("ParameterUninitializedException", open=True)
    return Hole("parameter", tainted=True) if found is None else found


def is_declared(machine: Machine, node: Value, name: Value) -> bool | None:
    """Tell whether a parameter was declared; None where that cannot be known."""
    answers = {
        _key(node, option) in machine.parameters if isinstance(option, Known) else None
        for option in options(name)
    }
    return answers.pop() if len(answers) == 1 else None


def written(machine: Machine, node: Value, name: Value, value: Value) -> None:
    """Set a parameter."""
    for option in options(name):
        machine.trail.set(machine.parameters, _key(node, option), value)


def setting(machine: Machine, node: Value, name: Value) -> Value | None:
    """Return what a launch, or the node's own options, set; None where they certainly do not."""
    if not isinstance(name, Known):
        return Hole(short(machine, node, spelled(name)), tainted=True)
    own = node.fields.get(OVERRIDES) if isinstance(node, Instance) else None
    if isinstance(own, ListValue):
        for item in reversed(own.items):
            if isinstance(item, Instance) and _is_called(item.fields.get("name"), name):
                return item.fields.get("value", NONE)
    full, found = spelled(name_of(node)), None
    for one in machine.recorder.site.settings if takes_globals(node) else ():
        if one.name == name.value and _pattern(one.node).fullmatch(full):
            found = one
    return None if found is None else value_of(found.value, short(machine, node, found.name))


def _is_called(given: Value | None, name: Known) -> bool:
    return isinstance(given, Known) and given.value == name.value


def watch_changes(machine: Machine, arguments: Arguments) -> None:
    """Remember the functions that a change of parameters calls."""
    for value in (*arguments.values, *arguments.keywords.values()):
        machine.setters += [o.function for o in options(value) if isinstance(o, FunctionValue)]


def short(machine: Machine, node: Value, name: str) -> str:
    """Return a parameter as a note spells it: `~topic` of the site's node, `/other/topic`."""
    full = spelled(name_of(node))
    site = machine.recorder.site
    own = site.name == full or not (site.named or site.loading)
    return f"~{name}" if own else f"{full}/{name}"


def _declared(machine: Machine, node: Value, name: Value, default: Value | None) -> Value:
    key = _key(node, name)
    if key in machine.parameters:
        machine.doubts += 1
        return machine.parameters[key]
    value = _overridden(machine, node, name, default)
    _told(machine, node, name, value)
    machine.doubts += not _fits(value, default)
    machine.trail.set(machine.parameters, key, value)
    return value


def _fits(value: Value, default: Value | None) -> bool:
    """Tell whether a parameter's value is certainly of the type that it is declared with."""
    if not (isinstance(value, Known) and isinstance(default, Known)):
        return isinstance(value, ListValue) and value.items == getattr(default, "items", None)
    return type(value.value) is type(default.value)


def _told(machine: Machine, node: Value, name: Value, value: Value) -> None:
    """Record a parameter whose name is known."""
    if isinstance(name, Known):
        for owner in options(name_of(node)):
            machine.recorder.parameter(spelled(owner), str(name.value), plain(value))


def plain(value: Value) -> PlainValue | None:
    """Return what a parameter holds, None where that is not known or no parameter's."""
    if isinstance(value, ListValue) and not value.open:
        items = [plain(item) for item in value.items]
        found = tuple(item for item in items if isinstance(item, (bool, int, float, str)))
        return found if len(found) == len(items) else None
    held = value.value if isinstance(value, Known) else None
    return plain_value(held)


def _overridden(machine: Machine, node: Value, name: Value, default: Value | None) -> Value:
    found = setting(machine, node, name)
    if found is not None and not isinstance(found, Hole):
        return found
    hole = Hole(short(machine, node, spelled(name)), tainted=True)
    if default is not None and is_kind(default) and found is None and _all_known(machine, node):
        return unset(hole.why)
    if default is None or is_kind(default):
        return hole
    marked = _marked(default)
    if found is None and _all_known(machine, node):
        return marked
    return _with_one_more(marked, hole) or join((marked, hole))


def _with_one_more(value: Value, hole: Hole) -> Value | None:
    """Return a list with one item that stands for all others that a launch may give."""
    if not isinstance(value, ListValue):
        return None
    more = Hole(f"{hole.why}[]", tainted=True)
    return ListValue({**value.fields, "items": (*value.items, more)}, value.kind)


def _known(machine: Machine, node: Value, name: Value) -> Value | None:
    key = _key(node, name)
    if key in machine.parameters:
        return machine.parameters[key]
    found = setting(machine, node, name)
    if found is None and not _all_known(machine, node):
        return Hole(short(machine, node, spelled(name)), tainted=True)
    return found


def _all_known(machine: Machine, node: Value) -> bool:
    """Tell whether all that is set for a node is known."""
    site = machine.recorder.site
    process = site.loading is None or site.loading.known or not takes_globals(node)
    return site.complete and process


def _marked(value: Value) -> Value:
    """Return a default marked as a parameter's value, which the launch may change."""
    if isinstance(value, Known):
        return Known(value.value, tainted=True)
    if isinstance(value, ListValue):
        items = tuple(_marked(item) for item in value.items)
        return ListValue({**value.fields, "items": items}, value.kind)
    return join(map(_marked, value.options)) if isinstance(value, Choice) else value


def _key(node: Value, name: Value) -> str:
    full = node.fields.get(NAME) if isinstance(node, Instance) else None
    return f"{spelled(full) if full is not None else ''} {spelled(name)}"


@lru_cache(maxsize=4096)
def _pattern(key: str) -> re.Pattern[str]:
    whole = key if key.startswith("/") else f"/{key}"
    pieces = re.split(r"(/\*\*|/\*)(?=/|$)", whole)
    return re.compile("".join(_PARTS.get(piece, re.escape(piece)) for piece in pieces))
