"""Behaviour trees: the nodes that libraries register, made as a tree would (behaviortree.dev).

Which of them a tree has is in its XML. Without a launch each that is registered is taken; with one
this is noted.
"""

from collections.abc import Callable, Mapping

from rtron.sources.code.interpreter.arguments import Arguments
from rtron.sources.code.interpreter.calling import dispatch
from rtron.sources.code.interpreter.items import items_of
from rtron.sources.code.interpreter.machine import Machine
from rtron.sources.code.interpreter.values import (
    NONE,
    TRUE,
    FunctionValue,
    Hole,
    Instance,
    Known,
    NativeClass,
    Value,
    options,
    spelled,
)
from rtron.sources.code.natives.cpp import cpp

REGISTERING = "BT_RegisterNodesFromPlugin"
"""What BT_REGISTER_NODES defines (behaviortree_cpp/utils/shared_library.h)."""

_UNKNOWN = Hole("?")
_CONFIG = "tree.config"
_WITH_DEFAULT = 3
_BLACKBOARD_KEY = "tree.blackboard"


def _factory(_: Machine, __: Arguments) -> Value:
    return Instance(_FACTORY, {"truth": TRUE})


def _register_plugin(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    """`registerFromPlugin(library)`: what the library's source registers."""
    files = machine.world.files
    for name in options(arguments.get(0) or _UNKNOWN):
        if isinstance(name, Known):
            _register_library(machine, owner, files.library(str(name.value)), arguments)
        elif machine.recorder.site.complete:
            what = f"behaviour tree library {spelled(name)}"
            machine.recorder.unresolved(what, "its name is not known", arguments.evidence)
        else:
            for sources in files.libraries_naming("BT_REGISTER_NODES"):
                _register_library(machine, owner, sources, arguments)
    return NONE


def _register_library(
    machine: Machine, owner: Instance, sources: tuple[object, ...], at: Arguments
) -> None:
    for function in cpp(machine).taken_in(sources, REGISTERING):
        key = (function.file, function.line, function.name)
        if key not in machine.ran:
            given = Arguments(values=(owner,), line=at.line, frame=at.frame)
            machine.call(FunctionValue(function), given)


def _register_type(machine: Machine, _: Value, arguments: Arguments) -> Value:
    """`registerNodeType<T>(id)`."""
    if arguments.types:
        type = arguments.types[0]
        _later(machine, arguments, lambda given: cpp(machine).make(type, given))
    return NONE


def _register_builder(machine: Machine, _: Value, arguments: Arguments) -> Value:
    """`registerBuilder<T>(id, builder)`."""
    builder = arguments.get(1) or NONE
    _later(machine, arguments, lambda given: dispatch(machine, builder, given))
    return NONE


def _later(machine: Machine, arguments: Arguments, make: Callable[[Arguments], Value]) -> None:
    """Make a node of a tree when the program has put into the blackboard what it needs."""
    name = arguments.get(0) or _UNKNOWN
    if machine.recorder.site.complete:
        why = "which nodes its behaviour trees have is not looked at"
        machine.recorder.unresolved(f"tree node {spelled(name)}", why, arguments.evidence)
        return
    config = Instance(_CONFIGURATION, {"blackboard": _blackboard(machine)})
    given = Arguments(values=(name, config), line=arguments.line, frame=arguments.frame)
    machine.deferred.append(lambda: make(given))


def _blackboard(machine: Machine) -> Value:
    """Return the program's blackboard: one for all of its trees."""
    if _BLACKBOARD_KEY not in machine.parameters:
        machine.parameters[_BLACKBOARD_KEY] = Instance(_BLACKBOARD, {"truth": TRUE})
    return machine.parameters[_BLACKBOARD_KEY]


def _create_blackboard(machine: Machine, _: object, __: Arguments) -> Value:
    return _blackboard(machine)


def _put(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    """`blackboard->set(key, value)`."""
    machine.trail.set(owner.fields, _entry(arguments), arguments.get(1) or _UNKNOWN)
    return NONE


def _take(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    """`blackboard->get<T>(key)`, `blackboard->get(key, variable)`."""
    found = owner.fields.get(_entry(arguments), Hole(spelled(arguments.get(0) or _UNKNOWN)))
    place = arguments.place(1)
    if place is not None:
        machine.trail.set(*place, found)
    return found


def _entry(arguments: Arguments) -> str:
    return f"entry.{spelled(arguments.get(0) or _UNKNOWN)}"


def _node(_: Machine, arguments: Arguments) -> Value:
    """Make the part of a tree's node that its base class is: `SyncActionNode(name, config)`."""
    config = next((v for v in arguments.values if _is_configuration(v)), Hole("config"))
    return Instance(_NODE, {_CONFIG: config, "tree.name": arguments.get(0) or _UNKNOWN})


def _is_configuration(value: Value) -> bool:
    return isinstance(value, Instance) and value.type is _CONFIGURATION


def _config(_: Machine, owner: Instance, __: Arguments) -> Value:
    return owner.fields.get(_CONFIG, Hole("config"))


def _name(_: Machine, owner: Instance, __: Arguments) -> Value:
    return owner.fields.get("tree.name", _UNKNOWN)


def _input(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    """`getInput(port, variable)`: the port's default, which a tree may change."""
    port = spelled(arguments.get(0) or _UNKNOWN)
    value = _default_of(machine, owner, port, arguments)
    place = arguments.place(1)
    if place is not None:
        machine.trail.set(*place, value)
    return value if len(arguments.values) == 1 else Hole("getInput")


def _default_of(machine: Machine, owner: Instance, port: str, at: Arguments) -> Value:
    method = machine.world.attribute(owner, "providedPorts", ())
    ports = dispatch(machine, method, Arguments(frame=at.frame)) if method is not None else NONE
    for item in items_of(ports)[0]:
        if isinstance(item, Instance) and item.fields.get("port") == Known(port):
            found = item.fields["default"]
            return Known(found.value, tainted=True) if isinstance(found, Known) else found
    return Hole(f"~{port}", tainted=True)


def _port(_: Machine, __: object, arguments: Arguments) -> Value:
    """`BT::InputPort<T>(name[, default], description)`."""
    name = arguments.get(0) or _UNKNOWN
    hole = Hole(f"~{spelled(name)}", tainted=True)
    default = arguments.get(1) if len(arguments.values) >= _WITH_DEFAULT else hole
    return Instance(_PORT, {"port": name, "default": default or hole})


def _itself(_: Machine, __: object, arguments: Arguments) -> Value:
    return arguments.get(0) or _UNKNOWN


_CONFIGURATION = NativeClass("BT::NodeConfiguration")
_PORT = NativeClass("BT::PortInfo")
_FACTORY = NativeClass(
    "BT::BehaviorTreeFactory",
    _factory,
    {
        "registerFromPlugin": _register_plugin,
        "registerNodeType": _register_type,
        "registerBuilder": _register_builder,
    },
)
_BLACKBOARD = NativeClass("BT::Blackboard", methods={"set": _put, "get": _take})
_NODE = NativeClass("BT::TreeNode", _node, {"config": _config, "getInput": _input, "name": _name})
_BASES = (
    *("TreeNode", "ActionNodeBase", "SyncActionNode", "StatefulActionNode", "CoroActionNode"),
    *("ThreadedAction", "ConditionNode", "DecoratorNode", "ControlNode", "LeafNode"),
    "SimpleActionNode",
)
_LOADER = NativeClass("BT::SharedLibrary", methods={"getOSName": _itself})
TREE_CLASSES: Mapping[str, NativeClass] = {
    **{native.name: native for native in (_FACTORY, _LOADER)},
    **{f"BT::{name}": NativeClass(f"BT::{name}", _node, _NODE.methods) for name in _BASES},
}
TREE_FUNCTIONS: Mapping[str, Callable[..., Value]] = {
    "BT::Blackboard::create": _create_blackboard,
    "BT::SharedLibrary::getOSName": _itself,
    **{f"BT::{kind}Port": _port for kind in ("Input", "Output", "Bidirectional")},
}
