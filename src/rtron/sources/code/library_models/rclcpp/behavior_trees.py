"""Behaviour trees: the nodes that libraries register, made as a tree would (behaviortree.dev).

Which of them a tree has is in its XML. Without a launch each that is registered is taken; with one
those that the trees have which are read from known files or texts.
"""

import re
from collections.abc import Callable, Mapping
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.interpreter.execution.language_runtime import cpp_runtime
from rtron.sources.code.library_models.common.trivial_functions import (
    return_argument,
    returning_field,
)
from rtron.sources.code.library_models.rclcpp.behavior_tree_xml import (
    BUILT_IN_NODES,
    TreeNode,
    read_tree_nodes,
)
from rtron.vocabulary import Evidence, UnresolvedCause

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
_MISSING = UnresolvedCause.MISSING_CODE
_UNREGISTERED_REASON = "nothing that is read registers it"


def _make_factory(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    made = av.Instance(_FACTORY, {"truth": av.TRUE})
    if machine.recorder.site.parameters_complete:
        machine.deferred_actions.append(lambda: _note_unread(machine, made, arguments))
    return made


def _note_unread(machine: AbstractMachine, owner: av.Instance, at: Arguments) -> None:
    """Note that nothing is known of the trees that a factory makes of registered nodes."""
    if _READ_FIELD not in owner.fields and any(
        str(field).startswith(_MAKER_PREFIX) for field in owner.fields
    ):
        why = "which file they are read from is not known: what their nodes join is missing"
        machine.recorder.add_unresolved("behaviour trees", why, at.evidence)


def _load_plugin(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """`registerFromPlugin(library)`: what the library's source registers."""
    register_library(machine, owner, arguments, REGISTER_FUNCTION)
    return av.NONE


_REGISTER_MACROS = {
    REGISTER_FUNCTION: "BT_REGISTER_NODES",
    "BT_RegisterRosNodeFromPlugin": "CreateRosNodePlugin",
}


def register_library(
    machine: AbstractMachine, owner: av.Instance, arguments: Arguments, function: str
) -> None:
    """Run what a library registers: its function gets the factory, and what follows the name."""
    files = machine.runtime.files
    given = arguments.with_values(owner, *arguments.values[1:])
    for name in av.options(arguments.value(0)):
        if isinstance(name, av.Scalar):
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
            machine.undo_log.set(fields, key, av.TRUE)
            machine.call(av.FunctionValue(function), given)


def _register_type(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """`registerNodeType<T>(id, …)`: what follows the id, each node gets behind its own."""
    if arguments.types:
        type, extra = arguments.types[0], arguments.values[1:]

        def make(given: Arguments) -> av.Value:
            whole = given.with_values(*given.values, *extra)
            return cpp_runtime(machine).construct(type, whole)

        _defer_node(machine, owner, arguments, make)
    return av.NONE


def _add_builder(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """`registerBuilder<T>(id, builder)`."""
    builder = arguments.get(1) or av.NONE
    _defer_node(machine, owner, arguments, lambda given: dispatch(machine, builder, given))
    return av.NONE


def _defer_node(
    machine: AbstractMachine,
    owner: av.Instance,
    arguments: Arguments,
    make: Callable[[Arguments], av.Value],
) -> None:
    """Make a node of a tree when the program has put into the blackboard what it needs."""
    name = arguments.value(0)
    if machine.recorder.site.parameters_complete:
        maker = av.LibraryFunction(
            av.text_with_holes(name), lambda _machine, _owner, given: make(given)
        )
        machine.undo_log.set(owner.fields, f"{_MAKER_PREFIX}{av.text_with_holes(name)}", maker)
        return
    config = av.Instance(_CONFIGURATION, {"blackboard": _blackboard(machine)})
    given = arguments.with_values(name, config)
    machine.deferred_actions.append(lambda: make(given))


def _register_trees(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """`registerBehaviorTreeFromFile(path)`, `registerBehaviorTreeFromText(xml)`."""
    known = av.items_of(owner.fields.get(_FILES_FIELD, av.NONE))[0]
    given = _known_trees(machine, arguments)
    machine.undo_log.set(
        owner.fields, _FILES_FIELD, av.list_of(tuple(dict.fromkeys((*known, *given))))
    )
    return av.NONE


def _known_trees(machine: AbstractMachine, arguments: Arguments) -> list[av.Scalar]:
    """Return the files or texts that a call may mean; where it may be any other, it is noted."""
    found = av.options(arguments.value(0))
    known = [option for option in found if isinstance(option, av.Scalar)]
    if not known and machine.recorder.site.parameters_complete:
        machine.recorder.add_unresolved(
            "behaviour trees", _UNKNOWN_FILES_REASON, arguments.evidence
        )
    return known


def _create_tree(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """`createTree(id, blackboard)`: of the files that are registered, the tree of this name."""
    name = arguments.get(0)
    tree_id = str(name.value) if isinstance(name, av.Scalar) else ""
    for tree in dict.fromkeys(av.items_of(owner.fields.get(_FILES_FIELD, av.NONE))[0]):
        if isinstance(tree, av.Scalar):
            _make_nodes(machine, owner, str(tree.value), tree_id, arguments)
    return av.Unknown("tree")


def _create_now(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """`createTreeFromFile(path, blackboard)`, `createTreeFromText(xml, blackboard)`."""
    for tree in _known_trees(machine, arguments):
        _make_nodes(machine, owner, str(tree.value), "", arguments)
    return av.Unknown("tree")


def _make_nodes(
    machine: AbstractMachine, owner: av.Instance, tree: str, tree_id: str, arguments: Arguments
) -> None:
    """Make the nodes of a tree, a file's or a text's, each once with the same ports."""
    key = f"{_READ_FIELD} {tree_id} {tree}"
    if key in owner.fields or not machine.recorder.site.parameters_complete:
        return
    is_text = tree.lstrip().startswith("<")
    path = arguments.evidence.file if is_text else tree
    text = tree if is_text else machine.runtime.files.read_text(Path(path))
    if text is None:
        what, why, cause = f"behaviour tree {path}", _MISSING_FILE_REASON, _MISSING
        machine.recorder.add_unresolved(what, why, arguments.evidence, cause=cause)
        return
    try:
        nodes = {(node.id, node.ports): node for node in read_tree_nodes(text, path, tree_id)}
    except InputError as error:
        machine.recorder.add_unresolved(f"behaviour tree {path}", str(error), arguments.evidence)
        return
    for read in (_READ_FIELD, key):
        machine.undo_log.set(owner.fields, read, av.TRUE)
    for node in nodes.values():
        place = arguments.evidence if is_text else Evidence(file=path, line=node.line)
        _make_node(machine, owner, node, place, arguments)


def _make_node(
    machine: AbstractMachine,
    owner: av.Instance,
    node: TreeNode,
    location: Evidence,
    arguments: Arguments,
) -> None:
    maker = owner.fields.get(f"{_MAKER_PREFIX}{node.id}")
    if maker is None:
        if node.id not in BUILT_IN_NODES:
            what, why, cause = f"tree node {node.id}", _UNREGISTERED_REASON, _MISSING
            machine.recorder.add_unresolved(what, why, location, cause=cause)
        return
    ports = av.MapValue({port: av.Scalar(text, tainted=True) for port, text in node.ports})
    blackboard = arguments.get(1) or _blackboard(machine)
    config = av.Instance(_CONFIGURATION, {"blackboard": blackboard, _PORTS_FIELD: ports})
    given = arguments.with_values(av.Scalar(node.id), config)
    machine.deferred_actions.append(lambda: dispatch(machine, maker, given))


def _blackboard(machine: AbstractMachine) -> av.Value:
    """Return the program's blackboard: one for all of its trees."""
    if _BLACKBOARD_KEY not in machine.parameters:
        machine.parameters[_BLACKBOARD_KEY] = av.Instance(_BLACKBOARD, {"truth": av.TRUE})
    return machine.parameters[_BLACKBOARD_KEY]


def _create_blackboard(machine: AbstractMachine, _: object, __: Arguments) -> av.Value:
    """`BT::Blackboard::create()`; without trees all nodes have the same."""
    if machine.recorder.site.parameters_complete:
        return av.Instance(_BLACKBOARD, {"truth": av.TRUE})
    return _blackboard(machine)


def _set_entry(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """`blackboard->set(key, value)`."""
    machine.undo_log.set(owner.fields, _entry_key(arguments), arguments.value(1))
    return av.NONE


def _get_entry(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """`blackboard->get<T>(key)`, `blackboard->get(key, variable)`."""
    found = owner.fields.get(
        _entry_key(arguments), av.Unknown(av.text_with_holes(arguments.value(0)))
    )
    slot = arguments.slot(1)
    if slot is not None:
        machine.undo_log.set(*slot, found)
    return found


def _entry_key(arguments: Arguments) -> str:
    return f"entry.{av.text_with_holes(arguments.value(0))}"


def blackboard_entry(owner: av.Instance, key: str) -> av.Value:
    """Return an entry of the blackboard of a tree's node."""
    config = owner.fields.get(_CONFIG_FIELD)
    blackboard = config.fields.get("blackboard") if isinstance(config, av.Instance) else None
    fields = blackboard.fields if isinstance(blackboard, av.Instance) else {}
    return fields.get(f"entry.{key}", av.Unknown(key))


def make_tree_node(_: AbstractMachine, arguments: Arguments) -> av.Instance:
    """Make the part of a tree's node that its base class is: `SyncActionNode(name, config)`."""
    config = next((v for v in arguments.values if _is_configuration(v)), av.Unknown("config"))
    return av.Instance(TREE_NODE, {_CONFIG_FIELD: config, "tree.name": arguments.value(0)})


def _is_configuration(value: av.Value) -> bool:
    return isinstance(value, av.Instance) and value.type is _CONFIGURATION


def _get_input(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """`getInput(port, variable)`: what the tree gives, or the port's default."""
    port = av.text_with_holes(arguments.value(0))
    slot, value = arguments.slot(1), _port_in_tree(owner, port)
    if value is None:
        value = _default(machine, owner, port, arguments)
        if isinstance(value, av.Unknown) and _ports(owner) is not None:
            return av.FALSE
    if slot is not None:
        machine.undo_log.set(*slot, value)
    return value if len(arguments.values) == 1 else av.Unknown("getInput")


def port_value(
    machine: AbstractMachine, owner: av.Instance, port: str, at: Arguments
) -> av.Value | None:
    """Return what a tree gives in a port of the node that is made, or its default; else None."""
    found = _port_in_tree(owner, port)
    made = at.frame.this
    if found is None and isinstance(made, av.Instance):
        found = _default(machine, made, port, at)
        return None if isinstance(found, av.Unknown) else found
    return found


def _ports(owner: av.Instance) -> av.MapValue | None:
    """Return the ports that a tree in a file gives a node; None where no file is read."""
    config = owner.fields.get(_CONFIG_FIELD)
    found = config.fields.get(_PORTS_FIELD) if isinstance(config, av.Instance) else None
    return found if isinstance(found, av.MapValue) else None


def _port_in_tree(owner: av.Instance, port: str) -> av.Value | None:
    """Return what a tree gives in a port; `{key}` is in the blackboard when the tree runs."""
    ports = _ports(owner)
    found = ports.entries.get(port) if ports is not None else None
    if isinstance(found, av.Scalar) and _POINTER.fullmatch(str(found.value)):
        return av.Unknown(str(found.value)[1:-1], tainted=True)
    return found


def _default(machine: AbstractMachine, owner: av.Instance, port: str, at: Arguments) -> av.Value:
    method = machine.runtime.attribute(owner, "providedPorts", ())
    ports = dispatch(machine, method, at.with_values()) if method is not None else av.NONE
    for item in av.items_of(ports)[0]:
        if isinstance(item, av.Instance) and item.fields.get("port") == av.Scalar(port):
            found = item.fields["default"]
            return av.Scalar(found.value, tainted=True) if isinstance(found, av.Scalar) else found
    return av.Unknown(f"~{port}", tainted=True)


def _make_port(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    """`BT::InputPort<T>(name[, default], description)`."""
    name = arguments.value(0)
    hole = av.Unknown(f"~{av.text_with_holes(name)}", tainted=True)
    default = arguments.get(1) if len(arguments.values) >= _ARGUMENTS_WITH_DEFAULT else hole
    return av.Instance(_PORT, {"port": name, "default": default or hole})


_CONFIGURATION = av.LibraryClass("BT::NodeConfiguration")
_PORT = av.LibraryClass("BT::PortInfo")
_FACTORY = av.LibraryClass(
    "BT::BehaviorTreeFactory",
    _make_factory,
    {
        "registerFromPlugin": _load_plugin,
        "registerNodeType": _register_type,
        "registerBuilder": _add_builder,
        **dict.fromkeys(
            ("registerBehaviorTreeFromFile", "registerBehaviorTreeFromText"), _register_trees
        ),
        "createTree": _create_tree,
        **dict.fromkeys(("createTreeFromFile", "createTreeFromText"), _create_now),
    },
)
_BLACKBOARD = av.LibraryClass("BT::Blackboard", methods={"set": _set_entry, "get": _get_entry})
TREE_NODE = av.LibraryClass(
    "BT::TreeNode",
    make_tree_node,
    {
        "config": returning_field(_CONFIG_FIELD, av.Unknown("config")),
        "getInput": _get_input,
        "name": returning_field("tree.name"),
    },
)
_BASES = (
    *("TreeNode", "ActionNodeBase", "SyncActionNode", "StatefulActionNode", "CoroActionNode"),
    *("ThreadedAction", "ConditionNode", "DecoratorNode", "ControlNode", "LeafNode"),
    "SimpleActionNode",
)
_LOADER = av.LibraryClass("BT::SharedLibrary", methods={"getOSName": return_argument})
_CALLBACKS = ("tick", "onStart", "onRunning", "onHalted")
TREE_CLASSES: Mapping[str, av.LibraryClass] = {
    **{cls.name: cls for cls in (_FACTORY, _LOADER)},
    **{
        f"BT::{name}": av.LibraryClass(f"BT::{name}", make_tree_node, TREE_NODE.methods, _CALLBACKS)
        for name in _BASES
    },
}
TREE_FUNCTIONS: Mapping[str, Callable[..., av.Value]] = {
    "BT::Blackboard::create": _create_blackboard,
    "BT::SharedLibrary::getOSName": return_argument,
    **{f"BT::{kind}Port": _make_port for kind in ("Input", "Output", "Bidirectional")},
}
