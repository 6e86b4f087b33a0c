"""What runs code that the source does not show, or joins nodes behind rospy: followed or noted."""

import ast
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.language_runtime import python_runtime
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame
from rtron.sources.code.ir import Import
from rtron.sources.code.library_models.common.trivial_functions import making

HIDDEN_CODE_REASON = "runs code that the source does not show"
_MASTER_REASON = "registers at the master itself"
_MAX_TEXT = 4096


def _note_call(
    name: str, why: str, machine: AbstractMachine, _: object, arguments: Arguments
) -> av.Value:
    """Note a call; what it is given may be called."""
    machine.escape_arguments(arguments)
    machine.recorder.add_unresolved(f"{name}()", why, arguments.evidence)
    return av.Unknown(f"{name}()")


def _eval(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`eval(text)`; a text that is a plain literal runs nothing."""
    literal = literal_value(arguments.get(0))
    if literal is not None:
        return literal
    return _note_call("eval", HIDDEN_CODE_REASON, machine, None, arguments)


def literal_value(text: av.Value | None) -> av.Value | None:
    """Return what a text says that is a plain literal of Python; None for any other."""
    is_text = isinstance(text, av.Scalar) and isinstance(text.value, str)
    if not (is_text and len(text.value) <= _MAX_TEXT):  # type: ignore[union-attr]
        return None
    try:
        return _plain_value(ast.literal_eval(text.value), text.tainted)  # type: ignore[union-attr]
    except (ValueError, SyntaxError, TypeError, MemoryError, RecursionError):
        return None


def _plain_value(value: object, tainted: bool) -> av.Value:  # noqa: FBT001 - as Scalar has it
    if isinstance(value, dict):
        pairs = ((_plain_value(k, tainted), _plain_value(v, tainted)) for k, v in value.items())
        return av.MapValue({av.map_key(key): entry for key, entry in pairs})
    if isinstance(value, (list, tuple, set)):
        return av.list_of([_plain_value(item, tainted) for item in value], type(value).__name__)
    return av.Scalar(value, tainted)


def _import_dynamically(
    machine: AbstractMachine, _: object, arguments: Arguments, *, returns_submodule: bool
) -> av.Value:
    """`importlib.import_module(name)`, `__import__(name)`, which brings the topmost package."""
    name = arguments.get(0, "name")
    if not (isinstance(name, av.Scalar) and isinstance(name.value, str)):
        what = f"import of {av.text_with_holes(name or av.NONE)}"
        machine.recorder.add_unresolved(what, "which module is not known", arguments.evidence)
        return av.Unknown("module")
    frame = StackFrame(file=arguments.frame.file)
    given = arguments.get(3, "fromlist")
    alias = "module" if returns_submodule or (given and av.items_of(given)[0]) else ""
    python_runtime(machine).import_(Import(name.value, None, alias, line=arguments.line), frame)
    return av.join(frame.variables.values())


def _globals(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    frame = arguments.frame
    while frame.closure is not None:
        frame = frame.closure
    return av.MapValue(frame.variables, is_namespace=True)


def _locals(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    """`locals()`; of a function it is a copy: what is written to it changes no variable."""
    frame = arguments.frame
    if frame.function is not None or frame.body == "comprehension":
        return av.MapValue(dict(frame.variables))
    return av.MapValue(frame.variables, is_namespace=True)


def _vars(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`vars(owner)`, `owner.__dict__`; without an owner, the variables here."""
    owner = arguments.get(0)
    if owner is None:
        return _locals(machine, None, arguments)
    if isinstance(owner, av.ExternalSymbol):
        return machine.runtime.attribute(owner, "__dict__", ()) or av.Unknown("vars()")
    if isinstance(owner, (av.Instance, av.ClassValue, av.ModuleValue)):
        return av.MapValue(owner.fields, is_namespace=True)
    return av.Unknown("vars()")


def get_member(
    machine: AbstractMachine, owner: av.Value, name: av.Value, at: Arguments
) -> av.Value:
    """Return a member by its name; one of a library, of a name that is not known, is noted."""
    if not isinstance(name, av.Scalar):
        is_library = isinstance(owner, (av.ExternalSymbol, av.LibraryFunction, av.ModuleValue))
        if is_library or _has_joining_method(machine, owner):
            what = f"getattr({_owner_name(owner)}, {av.text_with_holes(name)})"
            machine.recorder.add_unresolved(what, "which member is not known", at.evidence)
        return av.Unknown("getattr")
    found = owner
    for part in str(name.value).split("."):
        found = machine.runtime.attribute(found, part, ()) or av.Unknown(part)
    return found


def _has_joining_method(machine: AbstractMachine, owner: av.Value) -> bool:
    """Tell whether an object's class has a method that may join nodes and is not called yet."""
    classes = machine.runtime.lineage(owner.type) if isinstance(owner, av.Instance) else ()
    members = (m for cls in classes if isinstance(cls, av.ClassValue) for m in cls.fields.values())
    functions = (member.function for member in members if isinstance(member, av.FunctionValue))
    return any(
        function.key not in machine.executed_functions and machine.is_relevant(machine, function)
        for function in functions
    )


def _owner_name(owner: av.Value) -> str:
    named = owner.type if isinstance(owner, av.Instance) else owner
    return str(getattr(named, "name", "?"))


def _init_node(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`init_node(name, argv)`: remaps that are not those of the command line are noted."""
    words, _certain = av.items_of(arguments.get(1, "argv") or av.NONE)
    ours = machine.recorder.site.args
    for word in words:
        text = av.text_with_holes(word)
        if text not in ours and (":=" in text or not isinstance(word, av.Scalar)):
            why = "is given to init_node: what it remaps is not followed"
            machine.recorder.add_unresolved(f"remap {text}", why, arguments.evidence)
    return av.NONE


_REGISTRATION_METHODS = (
    *("registerPublisher", "registerSubscriber", "registerService", "publisherUpdate"),
    "requestTopic",
)
_MASTER_PROXY = av.LibraryClass(
    "master",
    methods={name: partial(_note_call, name, _MASTER_REASON) for name in _REGISTRATION_METHODS},
)
_MASTER_PROXY_NAMES = (
    *("rosgraph.Master", "rosgraph.masterapi.Master", "rospy.get_master"),
    *("rospy.client.get_master", "rospy.msproxy.MasterProxy", "xmlrpclib.Server"),
    *("xmlrpclib.ServerProxy", "xmlrpc.client.Server", "xmlrpc.client.ServerProxy"),
    "rosgraph.xmlrpc.ServerProxy",
)
_ROSPY_INTERNALS = (
    "rospy.topics.get_topic_manager",
    "rospy.topics._PublisherImpl",
    "rospy.topics._SubscriberImpl",
    "rospy.impl.registration.get_topic_manager",
    "rospy.impl.registration.get_service_manager",
    "rospy.service.get_service_manager",
)
_PROGRAM_KINDS = ("v", "vp", "ve", "vpe", "l", "lp", "le", "lpe")
_CODE_RUNNERS = (
    *("builtins.exec", "code.InteractiveInterpreter", "ctypes.CDLL", "ctypes.PyDLL"),
    *("ctypes.cdll.LoadLibrary", "imp.load_module"),
    *("runpy.run_module", "runpy.run_path"),
    *(f"os.{run}{kind}" for run in ("exec", "spawn") for kind in _PROGRAM_KINDS),
)
DYNAMIC_CODE_FUNCTIONS: Mapping[str, Callable[..., av.Value]] = {
    "builtins.eval": _eval,
    "ast.literal_eval": lambda _, __, arguments: (
        literal_value(arguments.get(0)) or av.Unknown("literal_eval")
    ),
    "importlib.import_module": partial(_import_dynamically, returns_submodule=True),
    "rospy.init_node": _init_node,
    "rospy.client.init_node": _init_node,
    **dict.fromkeys(_MASTER_PROXY_NAMES, making(_MASTER_PROXY)),
    **{name: partial(_note_call, name, _MASTER_REASON) for name in _ROSPY_INTERNALS},
    **{name: partial(_note_call, name, HIDDEN_CODE_REASON) for name in _CODE_RUNNERS},
}
DYNAMIC_CODE_BUILTINS: Mapping[str, Callable[..., av.Value]] = {
    **{
        name: partial(_note_call, name, HIDDEN_CODE_REASON)
        for name in ("exec", "execfile", "compile")
    },
    "eval": _eval,
    "__import__": partial(_import_dynamically, returns_submodule=False),
    "globals": _globals,
    "vars": _vars,
    "locals": _locals,
}


def _load(
    machine: AbstractMachine, name: av.Value, path: av.Value, arguments: Arguments
) -> av.Value:
    """Return the module of a file; one that is not in the workspace is noted."""

    def loaded(one: av.Value) -> av.Value:
        file = Path(str(one.value)) if isinstance(one, av.Scalar) else None
        if file is None or machine.runtime.files.read_text(file) is None:
            what = f"import of {av.text_with_holes(one)}"
            machine.recorder.add_unresolved(what, HIDDEN_CODE_REASON, arguments.evidence)
            return av.Unknown("module")
        return python_runtime(machine).load_module(file.resolve(), av.text_with_holes(name))

    return av.map_options(path, loaded)


def _load_source(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`imp.load_source(name, path)`."""
    name, path = arguments.get(0, "name") or av.NONE, arguments.get(1, "pathname") or av.NONE
    return _load(machine, name, path, arguments)


def _specification(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    """`spec_from_file_location(name, path)`, and `SourceFileLoader(name, path)`."""
    name = arguments.get(0, "name") or arguments.get(0, "fullname") or av.NONE
    path = arguments.get(1, "location") or arguments.get(1, "path") or av.NONE
    loader = av.Instance(_LOADER, {"name": name, "origin": path})
    return av.Instance(_LOADER, loader.fields | {"loader": loader})


def _module(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`module_from_spec(spec)`: with what its file defines."""
    specification = arguments.get(0, "spec")
    if not isinstance(specification, av.Instance) or specification.type is not _LOADER:
        return av.Unknown("module")
    return _load_specified(machine, specification, arguments)


def _load_specified(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """`loader.load_module()`."""
    return _load(machine, owner.fields["name"], owner.fields["origin"], arguments)


def _execute_module(_: AbstractMachine, __: object, ___: Arguments) -> av.Value:
    """`loader.exec_module(module)`: it has run when the module was made."""
    return av.NONE


_LOADER = av.LibraryClass(
    "importlib.machinery.SourceFileLoader",
    methods={"load_module": _load_specified, "exec_module": _execute_module},
)
MODULE_FILES: Mapping[str, Callable[..., av.Value]] = {
    "imp.load_source": _load_source,
    "importlib.machinery.SourceFileLoader": _specification,
    "importlib.util.module_from_spec": _module,
    "importlib.util.spec_from_file_location": _specification,
}
