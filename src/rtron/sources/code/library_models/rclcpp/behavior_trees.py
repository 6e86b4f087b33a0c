"""Behaviour trees: the nodes that libraries register, made as a tree would (behaviortree.dev).

Which of them a tree has is in its XML. Without a launch each that is registered is taken; with one
those that the trees have which are read from known files.
"""

import re
from collections.abc import Callable, Mapping
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.code.interpreter.abstract_values.items import items_of, listed
from rtron.sources.code.interpreter.abstract_values.value_types import (
    FALSE,
    NONE,
    TRUE,
    FunctionValue,
    Hole,
    Instance,
    Known,
    MapValue,
    Native,
    NativeClass,
    Value,
    options,
    spelled,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.library_models.common.cpp import cpp
from rtron.sources.code.library_models.rclcpp.behavior_tree_xml import (
    BUILT_IN,
    TreeNode,
    tree_nodes,
)
from rtron.vocabulary import Evidence

REGISTERING = "BT_RegisterNodesFromPlugin"
"""What BT_REGISTER_NODES defines (behaviortree_cpp/utils/shared_library.h)."""

_UNKNOWN = Hole("?")
_CONFIG = "tree.config"
_WITH_DEFAULT = 3
_BLACKBOARD_KEY = "tree.blackboard"
_FILES, _READ, _PORTS = "tree.files", "tree.read", "tree.ports"
_MAKER, _LIBRARY = "tree.maker ", "tree.library "
_POINTER = re.compile(r"\{.*\}")
_NOT_HERE = "its file is not in the folders that are read"
_OTHERS = "some are read from files that are not known: what else their nodes join is missing"
_NO_SOURCE = "nothing that is read registers it"


def _factory(machine: Machine, arguments: Arguments) -> Value:
    made = Instance(_FACTORY, {"truth": TRUE})
    if machine.recorder.site.complete:
        machine.deferred.append(lambda: _note_unread(machine, made, arguments))
    return made


def _note_unread(machine: Machine, owner: Instance, at: Arguments) -> None:
    """Note that nothing is known of the trees that a factory makes of registered nodes."""
    if _READ not in owner.fields and any(str(field).startswith(_MAKER) for field in owner.fields):
        why = "which file they are read from is not known: what their nodes join is missing"
        machine.recorder.unresolved("behaviour trees", why, at.evidence)


def _register_plugin(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    """`registerFromPlugin(library)`: what the library's source registers."""
    files = machine.world.files
    for name in options(arguments.get(0) or _UNKNOWN):
        if isinstance(name, Known):
            _register_library(machine, owner, files.library(str(name.value)), arguments)
        else:
            for sources in files.libraries_naming("BT_REGISTER_NODES"):
                _register_library(machine, owner, sources, arguments)
    return NONE


def _register_library(
    machine: Machine, owner: Instance, sources: tuple[object, ...], at: Arguments
) -> None:
    for function in cpp(machine).taken_in(sources, REGISTERING):
        key, ran = f"{_LIBRARY}{function.file}", (function.file, function.line, function.name)
        known = key in owner.fields if machine.recorder.site.complete else ran in machine.ran
        if not known:
            machine.trail.set(owner.fields, key, TRUE)
            given = Arguments(values=(owner,), line=at.line, frame=at.frame)
            machine.call(FunctionValue(function), given)


def _register_type(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    """`registerNodeType<T>(id)`."""
    if arguments.types:
        type = arguments.types[0]
        _later(machine, owner, arguments, lambda given: cpp(machine).make(type, given))
    return NONE


def _register_builder(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    """`registerBuilder<T>(id, builder)`."""
    builder = arguments.get(1) or NONE
    _later(machine, owner, arguments, lambda given: dispatch(machine, builder, given))
    return NONE


def _later(
    machine: Machine, owner: Instance, arguments: Arguments, make: Callable[[Arguments], Value]
) -> None:
    """Make a node of a tree when the program has put into the blackboard what it needs."""
    name = arguments.get(0) or _UNKNOWN
    if machine.recorder.site.complete:
        maker = Native(spelled(name), lambda _machine, _owner, given: make(given))
        machine.trail.set(owner.fields, f"{_MAKER}{spelled(name)}", maker)
        return
    config = Instance(_CONFIGURATION, {"blackboard": _blackboard(machine)})
    given = Arguments(values=(name, config), line=arguments.line, frame=arguments.frame)
    machine.deferred.append(lambda: make(given))


def _register_file(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    """`registerBehaviorTreeFromFile(path)`."""
    known = items_of(owner.fields.get(_FILES, NONE))[0]
    given = _paths(machine, arguments)
    machine.trail.set(owner.fields, _FILES, listed(tuple(dict.fromkeys((*known, *given)))))
    return NONE


def _paths(machine: Machine, arguments: Arguments) -> list[Known]:
    """Return the files that a call may mean; where it may be any other, this is noted."""
    found = options(arguments.get(0) or _UNKNOWN)
    known = [option for option in found if isinstance(option, Known)]
    if not known and machine.recorder.site.complete:
        machine.recorder.unresolved("behaviour trees", _OTHERS, arguments.evidence)
    return known


def _create_tree(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    """`createTree(id, blackboard)`: of the files that are registered, the tree of this name."""
    name = arguments.get(0)
    wanted = str(name.value) if isinstance(name, Known) else ""
    for path in dict.fromkeys(items_of(owner.fields.get(_FILES, NONE))[0]):
        if isinstance(path, Known):
            _make_nodes(machine, owner, str(path.value), wanted, arguments)
    return Hole("tree")


def _create_from_file(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    """`createTreeFromFile(path, blackboard)`."""
    for path in _paths(machine, arguments):
        _make_nodes(machine, owner, str(path.value), "", arguments)
    return Hole("tree")


def _make_nodes(
    machine: Machine, owner: Instance, path: str, wanted: str, arguments: Arguments
) -> None:
    """Make the nodes of a tree, each once with the same ports."""
    key = f"{_READ} {wanted} {path}"
    if key in owner.fields or not machine.recorder.site.complete:
        return
    text = machine.world.files.text(Path(path))
    if text is None:
        machine.recorder.unresolved(f"behaviour tree {path}", _NOT_HERE, arguments.evidence)
        return
    try:
        nodes = {(node.id, node.ports): node for node in tree_nodes(text, path, wanted)}
    except InputError as error:
        machine.recorder.unresolved(f"behaviour tree {path}", str(error), arguments.evidence)
        return
    for read in (_READ, key):
        machine.trail.set(owner.fields, read, TRUE)
    for node in nodes.values():
        _make_node(machine, owner, node, Evidence(file=path, line=node.line), arguments)


def _make_node(
    machine: Machine, owner: Instance, node: TreeNode, place: Evidence, arguments: Arguments
) -> None:
    maker = owner.fields.get(f"{_MAKER}{node.id}")
    if maker is None:
        if node.id not in BUILT_IN:
            machine.recorder.unresolved(f"tree node {node.id}", _NO_SOURCE, place)
        return
    ports = MapValue({port: Known(text, tainted=True) for port, text in node.ports})
    blackboard = arguments.get(1) or _blackboard(machine)
    config = Instance(_CONFIGURATION, {"blackboard": blackboard, _PORTS: ports})
    given = Arguments(values=(Known(node.id), config), line=arguments.line, frame=arguments.frame)
    machine.deferred.append(lambda: dispatch(machine, maker, given))


def _blackboard(machine: Machine) -> Value:
    """Return the program's blackboard: one for all of its trees."""
    if _BLACKBOARD_KEY not in machine.parameters:
        machine.parameters[_BLACKBOARD_KEY] = Instance(_BLACKBOARD, {"truth": TRUE})
    return machine.parameters[_BLACKBOARD_KEY]


def _create_blackboard(machine: Machine, _: object, __: Arguments) -> Value:
    """`BT::Blackboard::create()`; without trees all nodes have the same."""
    if machine.recorder.site.complete:
        return Instance(_BLACKBOARD, {"truth": TRUE})
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
    """`getInput(port, variable)`: what the tree gives, or the port's default."""
    port = spelled(arguments.get(0) or _UNKNOWN)
    place, value = arguments.place(1), _in_tree(owner, port)
    if value is None:
        value = _default_of(machine, owner, port, arguments)
        if isinstance(value, Hole) and _ports(owner) is not None:
            return FALSE
    if place is not None:
        machine.trail.set(*place, value)
    return value if len(arguments.values) == 1 else Hole("getInput")


def _ports(owner: Instance) -> MapValue | None:
    """Return the ports that a tree in a file gives a node; None where no file is read."""
    config = owner.fields.get(_CONFIG)
    found = config.fields.get(_PORTS) if isinstance(config, Instance) else None
    return found if isinstance(found, MapValue) else None


def _in_tree(owner: Instance, port: str) -> Value | None:
    """Return what a tree gives in a port; `{key}` is in the blackboard when the tree runs."""
    ports = _ports(owner)
    found = ports.entries.get(port) if ports is not None else None
    if isinstance(found, Known) and _POINTER.fullmatch(str(found.value)):
        return Hole(str(found.value)[1:-1], tainted=True)
    return found


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
        "registerBehaviorTreeFromFile": _register_file,
        "createTree": _create_tree,
        "createTreeFromFile": _create_from_file,
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
