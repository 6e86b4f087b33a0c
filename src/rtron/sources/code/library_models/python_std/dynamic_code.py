"""What runs code that the source does not show, or joins nodes behind rospy: followed or noted."""

import ast
from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter.abstract_values.items import items_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    ClassValue,
    Foreign,
    Hole,
    Instance,
    Known,
    MapValue,
    ModuleValue,
    Native,
    NativeClass,
    Value,
    join,
    spelled,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.interpreter.execution.stack_frame import Frame
from rtron.sources.code.ir import Import

CODE = "runs code that the source does not show"
_MASTER = "registers at the master itself"
_MAX_TEXT = 4096


def _noted(name: str, why: str, machine: Machine, _: object, arguments: Arguments) -> Value:
    """Note a call; what it is given may be called."""
    for value in (*arguments.values, *arguments.keywords.values()):
        machine.escape(value)
    machine.recorder.unresolved(f"{name}()", why, arguments.evidence)
    return Hole(f"{name}()")


def _eval(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`eval(text)`; a text that is a plain literal runs nothing."""
    if _is_literal(arguments.get(0)):
        return Hole("eval()")
    return _noted("eval", CODE, machine, None, arguments)


def _is_literal(text: Value | None) -> bool:
    if not (isinstance(text, Known) and isinstance(text.value, str)):
        return False
    try:
        ast.literal_eval(text.value[:_MAX_TEXT])
    except (ValueError, SyntaxError, TypeError, MemoryError, RecursionError):
        return False
    return len(text.value) <= _MAX_TEXT


def _imported(machine: Machine, _: object, arguments: Arguments, *, whole: bool) -> Value:
    """`importlib.import_module(name)`, `__import__(name)`, which brings the topmost package."""
    name = arguments.get(0, "name")
    if not (isinstance(name, Known) and isinstance(name.value, str)):
        what = f"import of {spelled(name or NONE)}"
        machine.recorder.unresolved(what, "which module is not known", arguments.evidence)
        return Hole("module")
    frame = Frame(file=arguments.frame.file)
    given = arguments.get(3, "fromlist")
    alias = "module" if whole or (given and items_of(given)[0]) else ""
    machine.world.import_(Import(name.value, None, alias, line=arguments.line), frame)
    return join(frame.variables.values())


def _globals(_: Machine, __: object, arguments: Arguments) -> Value:
    frame = arguments.frame
    while frame.closure is not None:
        frame = frame.closure
    return MapValue(frame.variables)


def _vars(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`vars(owner)`, `owner.__dict__`; without an owner, the variables here."""
    owner = arguments.get(0)
    if owner is None:
        return MapValue(arguments.frame.variables)
    if isinstance(owner, Foreign):
        return machine.world.attribute(owner, "__dict__", ()) or Hole("vars()")
    if isinstance(owner, (Instance, ClassValue, ModuleValue)):
        return MapValue(owner.fields)
    return Hole("vars()")


def _getter(_: Machine, __: object, arguments: Arguments) -> Value:
    """`operator.attrgetter(name)`: of several names it is not known which is which."""
    name = arguments.get(0) or NONE

    def get(machine: Machine, _: object, later: Arguments) -> Value:
        return member(machine, later.get(0) or NONE, name, arguments)

    return Native("attrgetter", get)


def _caller(_: Machine, __: object, arguments: Arguments) -> Value:
    """`operator.methodcaller(name, …)`."""
    name, given = arguments.get(0) or NONE, arguments.shifted(1)

    def call(machine: Machine, _: object, later: Arguments) -> Value:
        return dispatch(machine, member(machine, later.get(0) or NONE, name, arguments), given)

    return Native("methodcaller", call)


def member(machine: Machine, owner: Value, name: Value, at: Arguments) -> Value:
    """Return a member by its name; one of a library, of a name that is not known, is noted."""
    if not isinstance(name, Known):
        if isinstance(owner, (Foreign, Native, ModuleValue)):
            what = f"getattr({_shown(owner)}, {spelled(name)})"
            machine.recorder.unresolved(what, "which member is not known", at.evidence)
        return Hole("getattr")
    found = owner
    for part in str(name.value).split("."):
        found = machine.world.attribute(found, part, ()) or Hole(part)
    return found


def _shown(owner: Value) -> str:
    return str(getattr(owner, "name", "?"))


def _master(_: Machine, __: object, ___: Arguments) -> Value:
    return Instance(_PROXY)


def _init_node(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`init_node(name, argv)`: remaps that are not those of the command line are noted."""
    words, _certain = items_of(arguments.get(1, "argv") or NONE)
    ours = machine.recorder.site.args
    for word in words:
        text = spelled(word)
        if text not in ours and (":=" in text or not isinstance(word, Known)):
            why = "is given to init_node: what it remaps is not followed"
            machine.recorder.unresolved(f"remap {text}", why, arguments.evidence)
    return NONE


_REGISTERING = (
    "registerPublisher",
    "registerSubscriber",
    "registerService",
    "publisherUpdate",
    "requestTopic",
)
_PROXY = NativeClass(
    "master", methods={name: partial(_noted, name, _MASTER) for name in _REGISTERING}
)
_PROXIES = (
    "rosgraph.Master",
    "rosgraph.masterapi.Master",
    "rospy.get_master",
    "rospy.client.get_master",
    "rospy.msproxy.MasterProxy",
    "xmlrpclib.Server",
    "xmlrpclib.ServerProxy",
    "xmlrpc.client.Server",
    "xmlrpc.client.ServerProxy",
    "rosgraph.xmlrpc.ServerProxy",
)
_INSIDE_ROSPY = (
    "rospy.topics.get_topic_manager",
    "rospy.topics._PublisherImpl",
    "rospy.topics._SubscriberImpl",
    "rospy.impl.registration.get_topic_manager",
    "rospy.impl.registration.get_service_manager",
    "rospy.service.get_service_manager",
)
_RUNNING = (
    "builtins.exec",
    "code.InteractiveInterpreter",
    "ctypes.CDLL",
    "ctypes.PyDLL",
    "ctypes.cdll.LoadLibrary",
    "imp.load_source",
    "imp.load_module",
    "importlib.util.spec_from_file_location",
    "runpy.run_module",
    "runpy.run_path",
)
_CALLS: Mapping[str, Callable[..., Value]] = {
    "builtins.eval": _eval,
    "importlib.import_module": partial(_imported, whole=True),
    "operator.attrgetter": _getter,
    "operator.methodcaller": _caller,
    "rospy.init_node": _init_node,
    "rospy.client.init_node": _init_node,
    **dict.fromkeys(_PROXIES, _master),
    **{name: partial(_noted, name, _MASTER) for name in _INSIDE_ROSPY},
    **{name: partial(_noted, name, CODE) for name in _RUNNING},
}
PYTHON_HIDDEN: Mapping[str, Value] = {name: Native(name, call) for name, call in _CALLS.items()}
_BUILTINS: Mapping[str, Callable[..., Value]] = {
    **{name: partial(_noted, name, CODE) for name in ("exec", "execfile", "compile")},
    "eval": _eval,
    "__import__": partial(_imported, whole=False),
    "globals": _globals,
    "vars": _vars,
    "locals": lambda machine, _, a: MapValue(a.frame.variables),
}
HIDDEN_BUILTINS: Mapping[str, Value] = {name: Native(name, c) for name, c in _BUILTINS.items()}
