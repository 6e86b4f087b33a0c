"""Behaviour trees: the nodes that libraries register, made as a tree would (behaviortree.dev).

Which of them a tree has is in its XML. Without a launch each that is registered is taken; with one
those that the trees have which are read from known files or texts.
"""

import re
from collections.abc import Callable, Mapping
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.code.interpreter.abstract_values.items import items_of, list_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    FALSE,
    NONE,
    TRUE,
    UNKNOWN,
    FunctionValue,
    Instance,
    LibraryClass,
    LibraryFunction,
    MapValue,
    Scalar,
    Unknown,
    Value,
    options,
    text_with_holes,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.interpreter.execution.language_runtime import cpp_runtime
from rtron.sources.code.library_models.common.trivial_functions import return_argument
from rtron.sources.code.library_models.rclcpp.behavior_tree_xml import (
    BUILT_IN_NODES,
    TreeNode,
    read_tree_nodes,
)
from rtron.vocabulary import Evidence

REGISTER_FUNCTION = "BT_RegisterNodesFromPlugin"
"""What BT_REGISTER_NODES defines (behaviortree_cpp/utils/shared_library.h)."""

_CONFIG_FIELD = "tree.config"
_ARGUMENTS_WITH_DEFAULT = 3
_BLACKBOARD_KEY = "tree.blackboard"
_FILES_FIELD, _READ_FIELD, _PORTS_FIELD = "tree.files", "tree.read", "tree.ports"
_MAKER_PREFIX, _LIBRARY_PREFIX = "tree.maker ", "tree.library "
_POINTER = re.compile(r"\{.*\}")
_MISSING_FILE_REASON = "its file is not in the folders that are read"
_UNKNOWN_FILES_REASON = (
    "some are read from files that are not known: what else their nodes join is missing"
)
_UNREGISTERED_REASON = "nothing that is read registers it"


def _make_factory(machine: AbstractMachine, arguments: Arguments) -> Value:
    made = Instance(_FACTORY, {"truth": TRUE})
    if machine.recorder.site.parameters_complete:
        machine.deferred_actions.append(lambda: _note_unread(machine, made, arguments))
    return made


def _note_unread(machine: AbstractMachine, owner: Instance, at: Arguments) -> None:
    """Note that nothing is known of the trees that a factory makes of registered nodes."""
    if _READ_FIELD not in owner.fields and any(
        str(field).startswith(_MAKER_PREFIX) for field in owner.fields
    ):
        why = "which file they are read from is not known: what their nodes join is missing"
        machine.recorder.add_unresolved("behaviour trees", why, at.evidence)


def _register_plugin(machine: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    """`registerFromPlugin(library)`: what the library's source registers."""
    register_library(machine, owner, arguments, REGISTER_FUNCTION)
    return NONE


_REGISTER_MACROS = {
    REGISTER_FUNCTION: "BT_REGISTER_NODES",
    "BT_RegisterRosNodeFromPlugin": "CreateRosNodePlugin",
}


def register_library(
    machine: AbstractMachine, owner: Instance, arguments: Arguments, function: str
) -> None:
    """Run what a library registers: its function gets the factory, and what follows the name."""
    files = machine.runtime.files
    given = arguments.with_values(owner, *arguments.values[1:])
    for name in options(arguments.value(0)):
        if isinstance(name, Scalar):
            _register_sources(machine, files.library_sources(str(name.value)), given, function)
        else:
            for sources in files.libraries_containing(_REGISTER_MACROS[function]):
                _register_sources(machine, sources, given, function)


def _register_sources(
    machine: AbstractMachine, sources: tuple[Path, ...], given: Arguments, name: str
) -> None:
    owner = given.values[0]
    for function in cpp_runtime(machine).load_functions(sources, name):
        key, fields = f"{_LIBRARY_PREFIX}{function.file}", getattr(owner, "fields", {})
        if machine.recorder.site.parameters_complete:
            known = key in fields
        else:
            known = function.key in machine.executed_functions
        if not known:
            machine.undo_log.set(fields, key, TRUE)
            machine.call(FunctionValue(function), given)


def _register_type(machine: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    """`registerNodeType<T>(id, …)`: what follows the id, each node gets behind its own."""
    if arguments.types:
        type, extra = arguments.types[0], arguments.values[1:]

        def make(given: Arguments) -> Value:
            whole = given.with_values(*given.values, *extra)
            return cpp_runtime(machine).construct(type, whole)

        _defer_node(machine, owner, arguments, make)
    return NONE


def _register_builder(machine: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    """`registerBuilder<T>(id, builder)`."""
    builder = arguments.get(1) or NONE
    _defer_node(machine, owner, arguments, lambda given: dispatch(machine, builder, given))
    return NONE


def _defer_node(
    machine: AbstractMachine,
    owner: Instance,
    arguments: Arguments,
    make: Callable[[Arguments], Value],
) -> None:
    """Make a node of a tree when the program has put into the blackboard what it needs."""
    name = arguments.value(0)
    if machine.recorder.site.parameters_complete:
        maker = LibraryFunction(text_with_holes(name), lambda _machine, _owner, given: make(given))
        machine.undo_log.set(owner.fields, f"{_MAKER_PREFIX}{text_with_holes(name)}", maker)
        return
    config = Instance(_CONFIGURATION, {"blackboard": _blackboard(machine)})
    given = arguments.with_values(name, config)
    machine.deferred_actions.append(lambda: make(given))


def _register_trees(machine: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    """`registerBehaviorTreeFromFile(path)`, `registerBehaviorTreeFromText(xml)`."""
    known = items_of(owner.fields.get(_FILES_FIELD, NONE))[0]
    given = _known_trees(machine, arguments)
    machine.undo_log.set(
        owner.fields, _FILES_FIELD, list_of(tuple(dict.fromkeys((*known, *given))))
    )
    return NONE


def _known_trees(machine: AbstractMachine, arguments: Arguments) -> list[Scalar]:
    """Return the files or texts that a call may mean; where it may be any other, it is noted."""
    found = options(arguments.value(0))
    known = [option for option in found if isinstance(option, Scalar)]
    if not known and machine.recorder.site.parameters_complete:
        machine.recorder.add_unresolved(
            "behaviour trees", _UNKNOWN_FILES_REASON, arguments.evidence
        )
    return known


def _create_tree(machine: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    """`createTree(id, blackboard)`: of the files that are registered, the tree of this name."""
    name = arguments.get(0)
    tree_id = str(name.value) if isinstance(name, Scalar) else ""
    for tree in dict.fromkeys(items_of(owner.fields.get(_FILES_FIELD, NONE))[0]):
        if isinstance(tree, Scalar):
            _make_nodes(machine, owner, str(tree.value), tree_id, arguments)
    return Unknown("tree")


def _create_directly(machine: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    """`createTreeFromFile(path, blackboard)`, `createTreeFromText(xml, blackboard)`."""
    for tree in _known_trees(machine, arguments):
        _make_nodes(machine, owner, str(tree.value), "", arguments)
    return Unknown("tree")


def _make_nodes(
    machine: AbstractMachine, owner: Instance, tree: str, tree_id: str, arguments: Arguments
) -> None:
    """Make the nodes of a tree, a file's or a text's, each once with the same ports."""
    key = f"{_READ_FIELD} {tree_id} {tree}"
    if key in owner.fields or not machine.recorder.site.parameters_complete:
        return
    is_text = tree.lstrip().startswith("<")
    path = arguments.evidence.file if is_text else tree
    text = tree if is_text else machine.runtime.files.read_text(Path(path))
    if text is None:
        machine.recorder.add_unresolved(
            f"behaviour tree {path}", _MISSING_FILE_REASON, arguments.evidence
        )
        return
    try:
        nodes = {(node.id, node.ports): node for node in read_tree_nodes(text, path, tree_id)}
    except InputError as error:
        machine.recorder.add_unresolved(f"behaviour tree {path}", str(error), arguments.evidence)
        return
    for read in (_READ_FIELD, key):
        machine.undo_log.set(owner.fields, read, TRUE)
    for node in nodes.values():
        place = arguments.evidence if is_text else Evidence(file=path, line=node.line)
        _make_node(machine, owner, node, place, arguments)


def _make_node(
    machine: AbstractMachine,
    owner: Instance,
    node: TreeNode,
    location: Evidence,
    arguments: Arguments,
) -> None:
    maker = owner.fields.get(f"{_MAKER_PREFIX}{node.id}")
    if maker is None:
        if node.id not in BUILT_IN_NODES:
            machine.recorder.add_unresolved(f"tree node {node.id}", _UNREGISTERED_REASON, location)
        return
    ports = MapValue({port: Scalar(text, tainted=True) for port, text in node.ports})
    blackboard = arguments.get(1) or _blackboard(machine)
    config = Instance(_CONFIGURATION, {"blackboard": blackboard, _PORTS_FIELD: ports})
    given = arguments.with_values(Scalar(node.id), config)
    machine.deferred_actions.append(lambda: dispatch(machine, maker, given))


def _blackboard(machine: AbstractMachine) -> Value:
    """Return the program's blackboard: one for all of its trees."""
    if _BLACKBOARD_KEY not in machine.parameters:
        machine.parameters[_BLACKBOARD_KEY] = Instance(_BLACKBOARD, {"truth": TRUE})
    return machine.parameters[_BLACKBOARD_KEY]


def _create_blackboard(machine: AbstractMachine, _: object, __: Arguments) -> Value:
    """`BT::Blackboard::create()`; without trees all nodes have the same."""
    if machine.recorder.site.parameters_complete:
        return Instance(_BLACKBOARD, {"truth": TRUE})
    return _blackboard(machine)


def _set_entry(machine: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    """`blackboard->set(key, value)`."""
    machine.undo_log.set(owner.fields, _entry_key(arguments), arguments.value(1))
    return NONE


def _get_entry(machine: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    """`blackboard->get<T>(key)`, `blackboard->get(key, variable)`."""
    found = owner.fields.get(_entry_key(arguments), Unknown(text_with_holes(arguments.value(0))))
    slot = arguments.slot(1)
    if slot is not None:
        machine.undo_log.set(*slot, found)
    return found


def _entry_key(arguments: Arguments) -> str:
    return f"entry.{text_with_holes(arguments.value(0))}"


def blackboard_entry(owner: Instance, key: str) -> Value:
    """Return an entry of the blackboard of a tree's node."""
    config = owner.fields.get(_CONFIG_FIELD)
    blackboard = config.fields.get("blackboard") if isinstance(config, Instance) else None
    fields = blackboard.fields if isinstance(blackboard, Instance) else {}
    return fields.get(f"entry.{key}", Unknown(key))


def make_tree_node(_: AbstractMachine, arguments: Arguments) -> Instance:
    """Make the part of a tree's node that its base class is: `SyncActionNode(name, config)`."""
    config = next((v for v in arguments.values if _is_configuration(v)), Unknown("config"))
    return Instance(TREE_NODE, {_CONFIG_FIELD: config, "tree.name": arguments.value(0)})


def _is_configuration(value: Value) -> bool:
    return isinstance(value, Instance) and value.type is _CONFIGURATION


def _node_config(_: AbstractMachine, owner: Instance, __: Arguments) -> Value:
    return owner.fields.get(_CONFIG_FIELD, Unknown("config"))


def _node_name(_: AbstractMachine, owner: Instance, __: Arguments) -> Value:
    return owner.fields.get("tree.name", UNKNOWN)


def _get_input(machine: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    """`getInput(port, variable)`: what the tree gives, or the port's default."""
    port = text_with_holes(arguments.value(0))
    slot, value = arguments.slot(1), _port_in_tree(owner, port)
    if value is None:
        value = _port_default(machine, owner, port, arguments)
        if isinstance(value, Unknown) and _ports(owner) is not None:
            return FALSE
    if slot is not None:
        machine.undo_log.set(*slot, value)
    return value if len(arguments.values) == 1 else Unknown("getInput")


def port_value(machine: AbstractMachine, owner: Instance, port: str, at: Arguments) -> Value | None:
    """Return what a tree gives in a port of the node that is made, or its default; else None."""
    found = _port_in_tree(owner, port)
    made = at.frame.this
    if found is None and isinstance(made, Instance):
        found = _port_default(machine, made, port, at)
        return None if isinstance(found, Unknown) else found
    return found


def _ports(owner: Instance) -> MapValue | None:
    """Return the ports that a tree in a file gives a node; None where no file is read."""
    config = owner.fields.get(_CONFIG_FIELD)
    found = config.fields.get(_PORTS_FIELD) if isinstance(config, Instance) else None
    return found if isinstance(found, MapValue) else None


def _port_in_tree(owner: Instance, port: str) -> Value | None:
    """Return what a tree gives in a port; `{key}` is in the blackboard when the tree runs."""
    ports = _ports(owner)
    found = ports.entries.get(port) if ports is not None else None
    if isinstance(found, Scalar) and _POINTER.fullmatch(str(found.value)):
        return Unknown(str(found.value)[1:-1], tainted=True)
    return found


def _port_default(machine: AbstractMachine, owner: Instance, port: str, at: Arguments) -> Value:
    method = machine.runtime.attribute(owner, "providedPorts", ())
    ports = dispatch(machine, method, at.with_values()) if method is not None else NONE
    for item in items_of(ports)[0]:
        if isinstance(item, Instance) and item.fields.get("port") == Scalar(port):
            found = item.fields["default"]
            return Scalar(found.value, tainted=True) if isinstance(found, Scalar) else found
    return Unknown(f"~{port}", tainted=True)


def _make_port(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    """`BT::InputPort<T>(name[, default], description)`."""
    name = arguments.value(0)
    hole = Unknown(f"~{text_with_holes(name)}", tainted=True)
    default = arguments.get(1) if len(arguments.values) >= _ARGUMENTS_WITH_DEFAULT else hole
    return Instance(_PORT, {"port": name, "default": default or hole})


_CONFIGURATION = LibraryClass("BT::NodeConfiguration")
_PORT = LibraryClass("BT::PortInfo")
_FACTORY = LibraryClass(
    "BT::BehaviorTreeFactory",
    _make_factory,
    {
        "registerFromPlugin": _register_plugin,
        "registerNodeType": _register_type,
        "registerBuilder": _register_builder,
        **dict.fromkeys(
            ("registerBehaviorTreeFromFile", "registerBehaviorTreeFromText"), _register_trees
        ),
        "createTree": _create_tree,
        **dict.fromkeys(("createTreeFromFile", "createTreeFromText"), _create_directly),
    },
)
_BLACKBOARD = LibraryClass("BT::Blackboard", methods={"set": _set_entry, "get": _get_entry})
TREE_NODE = LibraryClass(
    "BT::TreeNode",
    make_tree_node,
    {"config": _node_config, "getInput": _get_input, "name": _node_name},
)
_BASES = (
    *("TreeNode", "ActionNodeBase", "SyncActionNode", "StatefulActionNode", "CoroActionNode"),
    *("ThreadedAction", "ConditionNode", "DecoratorNode", "ControlNode", "LeafNode"),
    "SimpleActionNode",
)
_LOADER = LibraryClass("BT::SharedLibrary", methods={"getOSName": return_argument})
_CALLBACKS = ("tick", "onStart", "onRunning", "onHalted")
TREE_CLASSES: Mapping[str, LibraryClass] = {
    **{cls.name: cls for cls in (_FACTORY, _LOADER)},
    **{
        f"BT::{name}": LibraryClass(f"BT::{name}", make_tree_node, TREE_NODE.methods, _CALLBACKS)
        for name in _BASES
    },
}
TREE_FUNCTIONS: Mapping[str, Callable[..., Value]] = {
    "BT::Blackboard::create": _create_blackboard,
    "BT::SharedLibrary::getOSName": return_argument,
    **{f"BT::{kind}Port": _make_port for kind in ("Input", "Output", "Bidirectional")},
}
