"""Python's classes and objects: members, decorators, bases."""

import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from functools import partial

from rtron.sources.code.interpreter.abstract_values.items import items_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    ClassValue,
    ExternalSymbol,
    FunctionValue,
    Instance,
    LibraryClass,
    LibraryFunction,
    Scalar,
    Unknown,
    Value,
    options,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments, LibraryCall
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame
from rtron.sources.code.interpreter.python.method_resolution_order import (
    SUPER,
    MethodResolutionOrders,
)
from rtron.sources.code.interpreter.python.modules import PythonModules, named_functions
from rtron.sources.code.ir import Class, TypeRef
from rtron.sources.code.library_models.python_std.data_classes import (
    ENUM,
    add_enum_members,
    enum_member,
)
from rtron.vocabulary import Evidence

_PYTHON_2 = {"BaseHTTPServer", "ConfigParser", "HTMLParser", "Queue", "SocketServer", "UserDict"}
_GUI_MODULES = {
    *("PyQt4", "PyQt5", "PyQt6", "PySide", "PySide2", "PySide6", "Tkinter", "tkinter", "wx"),
}
_MODULES_WITHOUT_ROS = (
    sys.stdlib_module_names | _PYTHON_2 | _GUI_MODULES | {"python_qt_binding", "smach"}
)


@dataclass(eq=False, slots=True, kw_only=True)
class PythonObjects(PythonModules):
    """The classes and objects of one program."""

    _method_orders: MethodResolutionOrders = field(default_factory=MethodResolutionOrders)

    def method_names(self, definition: Class) -> list[str]:
        """Return the names of the methods that a class defines itself."""
        return [function.name for _, function in named_functions(definition.body)]

    def instantiate(self, called: Value, arguments: Arguments) -> Value:
        """Make an object and run its `__init__`."""
        if not isinstance(called, ClassValue):
            return Unknown("object")
        if ENUM in self.lineage(called):
            return enum_member(called, arguments.value(0))
        made = Instance(called)
        self.machine.instances.append(made)
        init = self._instance_member(made, "__init__")
        if init is not None:
            dispatch(self.machine, init, arguments)
        else:
            self.machine.escape_arguments(arguments)
        return made

    def lineage(self, cls: Value) -> Iterator[Value]:
        """Yield a class and its bases, in the order in which a member is looked for."""
        return iter(self._method_orders.order_of(cls))

    def _instance_member(self, owner: Instance, name: str) -> Value | None:
        if owner.type is SUPER:
            return self._super_member(owner, name)
        if name in owner.fields:
            return self.machine.volatile_value(name, owner.fields[name])
        if isinstance(owner.type, LibraryClass):
            call = owner.type.methods.get(name)
            return LibraryFunction(name, call, owner) if call else None
        return self._bind_member(owner, self._find_member(owner.type, name))

    def _super_member(self, seen: Instance, name: str) -> Value | None:
        """Return a member of `super()`: that of the first class behind, bound to the object."""
        owner = seen.fields["owner"]
        found = _first_member(items_of(seen.fields["behind"])[0], name)
        if isinstance(owner, ClassValue):
            return _bind_to_class(owner, found)
        return self._bind_member(owner, found) if isinstance(owner, Instance) else None

    def _bind_member(self, owner: Instance, found: Value | None) -> Value | None:
        """Return what stands in an object's class as the object has it."""
        if isinstance(found, Instance) and found.type is PROPERTY:
            getter = found.fields["getter"]
            file = owner.type.definition.file if isinstance(owner.type, ClassValue) else ""
            return dispatch(
                self.machine, getter, Arguments(values=(owner,), frame=StackFrame(file=file))
            )
        return _bind_to_instance(owner, found)

    def _class_attribute(self, owner: ClassValue | LibraryClass, name: str) -> Value | None:
        return _bind_to_class(owner, self._find_member(owner, name))

    def _find_member(self, owner: ClassValue | LibraryClass, name: str) -> Value | None:
        """Return what stands in a class, unbound: a library's method has its class for owner."""
        if name == "__name__":
            return Scalar(owner.name)
        return _first_member(self.lineage(owner), name)

    def _create_class(self, definition: Class, frame: StackFrame) -> ClassValue:
        bases = tuple(
            Unknown("base") if isinstance(base, TypeRef) else self.machine.evaluate(base, frame)
            for base in definition.bases
        )
        self._note_bases(definition, bases)
        body = StackFrame(file=frame.file, closure=frame)
        self.machine.execute(definition.body, body)
        made = ClassValue(definition, tuple(map(_base_class, bases)), body.variables, closure=frame)
        self._note_order(made)
        return add_enum_members(made) if ENUM in self.lineage(made) else made

    def _note_bases(self, definition: Class, bases: tuple[Value, ...]) -> None:
        """Note each base class of a library that is neither here nor known to join no nodes."""
        location = Evidence(file=definition.file, line=definition.line)
        found = (option for base in bases for option in options(base))
        for base in (option for option in found if isinstance(option, ExternalSymbol)):
            if "." in base.name and not self._is_known(base.name):
                why = f"its base class {base.name} is not in the source: "
                why += "what that declares is not known"
                self.machine.recorder.add_unresolved(f"class {definition.name}", why, location)

    def _note_order(self, cls: ClassValue) -> None:
        """Note a class whose bases contradict each other."""
        self._method_orders.order_of(cls)
        if cls in self._method_orders.refused:
            location = Evidence(file=cls.definition.file, line=cls.definition.line)
            why = "Python finds no order for its bases: they are taken nearest first"
            self.machine.recorder.add_unresolved(f"class {cls.name}", why, location)

    def _is_known(self, dotted: str) -> bool:
        return self.is_library(dotted) or dotted.partition(".")[0] in _MODULES_WITHOUT_ROS

    def _apply_decorator(self, decorator: Value, value: Value, frame: StackFrame) -> Value:
        if isinstance(decorator, ExternalSymbol):
            found = _DESCRIPTORS.get(decorator.name)
            return Instance(found, {"getter": value}) if found else value
        if not isinstance(decorator, (FunctionValue, LibraryFunction, ClassValue)):
            return value
        made = dispatch(self.machine, decorator, Arguments(values=(value,), frame=frame))
        return value if isinstance(made, Unknown) or made == NONE else made


def _first_member(classes: Iterable[Value], name: str) -> Value | None:
    """Return the first member of a name, unbound."""
    for cls in classes:
        if isinstance(cls, ClassValue) and name in cls.fields:
            return _with_defining_class(cls.fields[name], cls)
        if isinstance(cls, LibraryClass) and name in cls.methods:
            return LibraryFunction(name, cls.methods[name], cls)
    return None


def _bind_to_instance(owner: Instance, found: Value | None) -> Value | None:
    if isinstance(found, Instance) and found.type is STATIC_METHOD:
        return found.fields["getter"]
    if isinstance(found, Instance) and found.type is CLASS_METHOD:
        return _bind_function(found.fields["getter"], owner.type)
    if isinstance(found, LibraryFunction) and isinstance(found.owner, LibraryClass):
        return replace(found, owner=owner)
    return _bind_function(found, owner) if found is not None else None


def _bind_to_class(cls: ClassValue | LibraryClass, found: Value | None) -> Value | None:
    """Return a member as the class itself has it: `Class.method(owner, …)`."""
    if isinstance(found, Instance) and found.type in {STATIC_METHOD, CLASS_METHOD}:
        return _bind_to_instance(Instance(cls), found)
    if isinstance(found, LibraryFunction) and isinstance(found.owner, LibraryClass):
        return LibraryFunction(found.name, partial(_call_on_first_argument, found.call))
    return found


def _call_on_first_argument(
    method: LibraryCall, machine: AbstractMachine, _: object, arguments: Arguments
) -> Value:
    return method(machine, arguments.get(0), arguments.without_first(1))


def _base_class(base: Value) -> Value:
    """Return the class that a library's function stands for which makes objects."""
    if not isinstance(base, LibraryFunction):
        return base

    def init(machine: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
        made = base.call(machine, base.owner, arguments)
        for name, value in made.fields.items() if isinstance(made, Instance) else ():
            machine.undo_log.set(owner.fields, name, value)
        return NONE

    return LibraryClass(base.name, methods={"__init__": init})


def _bind_function(found: Value, owner: Value) -> Value:
    if not isinstance(found, FunctionValue) or found.owner is not None:
        return found
    return replace(found, owner=owner)


def _with_defining_class(found: Value, cls: ClassValue) -> Value:
    """Return a member that knows the class it stands in, which `super()` needs."""
    if isinstance(found, FunctionValue) and found.cls is None:
        return replace(found, cls=cls)
    if isinstance(found, Instance) and found.type in _DESCRIPTORS.values():
        return Instance(
            found.type, {n: _with_defining_class(v, cls) for n, v in found.fields.items()}
        )
    return found


def _with_setter(_: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    return Instance(PROPERTY, {**owner.fields, "setter": arguments.get(0) or NONE})


PROPERTY = LibraryClass("property", methods={"setter": _with_setter})
STATIC_METHOD = LibraryClass("staticmethod")
CLASS_METHOD = LibraryClass("classmethod")
_DESCRIPTORS = {"property": PROPERTY, "staticmethod": STATIC_METHOD, "classmethod": CLASS_METHOD}
