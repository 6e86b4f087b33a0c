"""Python's classes and objects: members, decorators, bases."""

import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from functools import partial

from rtron.sources.code.interpreter.abstract_values.items import items_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    ClassValue,
    Foreign,
    FunctionValue,
    Hole,
    Instance,
    Known,
    Native,
    NativeClass,
    Value,
    options,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments, NativeCall
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.interpreter.execution.stack_frame import Frame
from rtron.sources.code.interpreter.python.method_resolution_order import SUPER, MethodOrders
from rtron.sources.code.interpreter.python.modules import PythonModules
from rtron.sources.code.ir import Class, Function, TypeRef
from rtron.sources.code.library_models.python_std.data_classes import ENUM, member, with_members
from rtron.vocabulary import Evidence

_PYTHON_2 = {"BaseHTTPServer", "ConfigParser", "HTMLParser", "Queue", "SocketServer", "UserDict"}
_WINDOWS = {"PyQt4", "PyQt5", "PyQt6", "PySide", "PySide2", "PySide6", "Tkinter", "tkinter", "wx"}
_JOINING_NONE = sys.stdlib_module_names | _PYTHON_2 | _WINDOWS | {"python_qt_binding", "smach"}


@dataclass(eq=False, slots=True, kw_only=True)
class PythonObjects(PythonModules):
    """The classes and objects of one program."""

    _orders: MethodOrders = field(default_factory=MethodOrders)

    def method_names(self, definition: Class) -> list[str]:
        """Return the names of the methods that a class defines itself."""
        return [f.name for f in functions_in(definition.body)]

    def instantiate(self, called: Value, arguments: Arguments) -> Value:
        """Make an object and run its `__init__`."""
        if not isinstance(called, ClassValue):
            return Hole("object")
        if ENUM in self.lineage(called):
            return member(called, arguments.get(0) or Hole("?"))
        made = Instance(called)
        self.machine.instances.append(made)
        init = self._of_instance(made, "__init__")
        if init is not None:
            dispatch(self.machine, init, arguments)
        else:
            for value in (*arguments.values, *arguments.keywords.values()):
                self.machine.escape(value)
        return made

    def lineage(self, cls: Value) -> Iterator[Value]:
        """Yield a class and its bases, in the order in which a member is looked for."""
        return iter(self._orders.of(cls))

    def _of_instance(self, owner: Instance, name: str) -> Value | None:
        if owner.type is SUPER:
            return self._of_super(owner, name)
        if name in owner.fields:
            return self.machine.seen(name, owner.fields[name])
        if isinstance(owner.type, NativeClass):
            call = owner.type.methods.get(name)
            return Native(name, call, owner) if call else None
        return self._of_object(owner, self._of_class(owner.type, name))

    def _of_super(self, seen: Instance, name: str) -> Value | None:
        """Return a member of `super()`: that of the first class behind, bound to the object."""
        owner = seen.fields["owner"]
        found = _among(items_of(seen.fields["behind"])[0], name)
        if isinstance(owner, ClassValue):
            return _of_no_instance(owner, found)
        return self._of_object(owner, found) if isinstance(owner, Instance) else None

    def _of_object(self, owner: Instance, found: Value | None) -> Value | None:
        """Return what stands in an object's class as the object has it."""
        if isinstance(found, Instance) and found.type is PROPERTY:
            getter = found.fields["getter"]
            file = owner.type.definition.file if isinstance(owner.type, ClassValue) else ""
            return dispatch(
                self.machine, getter, Arguments(values=(owner,), frame=Frame(file=file))
            )
        return _bound_to(owner, found)

    def _of_type(self, owner: ClassValue | NativeClass, name: str) -> Value | None:
        return _of_no_instance(owner, self._of_class(owner, name))

    def _of_class(self, owner: ClassValue | NativeClass, name: str) -> Value | None:
        """Return what stands in a class, unbound: a native method has its class for owner."""
        if name == "__name__":
            return Known(owner.name)
        return _among(self.lineage(owner), name)

    def _class(self, definition: Class, frame: Frame) -> ClassValue:
        bases = tuple(
            Hole("base") if isinstance(base, TypeRef) else self.machine.evaluate(base, frame)
            for base in definition.bases
        )
        self._note_bases(definition, bases)
        body = Frame(file=frame.file, closure=frame)
        self.machine.execute(definition.body, body)
        made = ClassValue(definition, tuple(map(_as_class, bases)), body.variables, closure=frame)
        self._note_order(made)
        return with_members(made) if ENUM in self.lineage(made) else made

    def _note_bases(self, definition: Class, bases: tuple[Value, ...]) -> None:
        """Note each base class of a library that is neither here nor known to join no nodes."""
        place = Evidence(file=definition.file, line=definition.line)
        found = (option for base in bases for option in options(base))
        for base in (option for option in found if isinstance(option, Foreign)):
            if "." in base.name and not self._is_known(base.name):
                why = f"its base class {base.name} is not in the source: "
                why += "what that declares is not known"
                self.machine.recorder.unresolved(f"class {definition.name}", why, place)

    def _note_order(self, cls: ClassValue) -> None:
        """Note a class whose bases contradict each other."""
        self._orders.of(cls)
        if cls in self._orders.refused:
            place = Evidence(file=cls.definition.file, line=cls.definition.line)
            why = "Python finds no order for its bases: they are taken nearest first"
            self.machine.recorder.unresolved(f"class {cls.name}", why, place)

    def _is_known(self, dotted: str) -> bool:
        return self.is_library(dotted) or dotted.partition(".")[0] in _JOINING_NONE

    def _decorated(self, decorator: Value, value: Value, frame: Frame) -> Value:
        if isinstance(decorator, Foreign):
            found = _DESCRIPTORS.get(decorator.name)
            return Instance(found, {"getter": value}) if found else value
        if not isinstance(decorator, (FunctionValue, Native, ClassValue)):
            return value
        made = dispatch(self.machine, decorator, Arguments(values=(value,), frame=frame))
        return value if isinstance(made, Hole) or made == NONE else made


def _among(classes: Iterable[Value], name: str) -> Value | None:
    """Return the first member of a name, unbound."""
    for cls in classes:
        if isinstance(cls, ClassValue) and name in cls.fields:
            return _with_class(cls.fields[name], cls)
        if isinstance(cls, NativeClass) and name in cls.methods:
            return Native(name, cls.methods[name], cls)
    return None


def functions_in(body: tuple[object, ...]) -> Iterator[Function]:
    """Yield every function that is defined in statements, nested ones too."""
    for statement in body:
        what = getattr(statement, "what", None)
        if isinstance(what, Function):
            yield what
            yield from functions_in(what.body or ())
        elif isinstance(what, Class):
            yield from functions_in(what.body)
        else:
            for name in ("body", "orelse", "final"):
                yield from functions_in(getattr(statement, name, ()) or ())


def _bound_to(owner: Instance, found: Value | None) -> Value | None:
    if isinstance(found, Instance) and found.type is STATIC:
        return found.fields["getter"]
    if isinstance(found, Instance) and found.type is CLASSWISE:
        return _bound_function(found.fields["getter"], owner.type)
    if isinstance(found, Native) and isinstance(found.owner, NativeClass):
        return replace(found, owner=owner)
    return _bound_function(found, owner) if found is not None else None


def _of_no_instance(cls: ClassValue | NativeClass, found: Value | None) -> Value | None:
    """Return a member as the class itself has it: `Class.method(owner, …)`."""
    if isinstance(found, Instance) and found.type in {STATIC, CLASSWISE}:
        return _bound_to(Instance(cls), found)
    if isinstance(found, Native) and isinstance(found.owner, NativeClass):
        return Native(found.name, partial(_on_first, found.call))
    return found


def _on_first(method: NativeCall, machine: Machine, _: object, arguments: Arguments) -> Value:
    return method(machine, arguments.get(0), arguments.shifted(1))


def _as_class(base: Value) -> Value:
    """Return the class that a library's function stands for which makes objects."""
    if not isinstance(base, Native):
        return base

    def init(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
        made = base.call(machine, base.owner, arguments)
        for name, value in made.fields.items() if isinstance(made, Instance) else ():
            machine.trail.set(owner.fields, name, value)
        return NONE

    return NativeClass(base.name, methods={"__init__": init})


def _bound_function(found: Value, owner: Value) -> Value:
    if not isinstance(found, FunctionValue) or found.owner is not None:
        return found
    return replace(found, owner=owner)


def _with_class(found: Value, cls: ClassValue) -> Value:
    """Return a member that knows the class it stands in, which `super()` asks for."""
    if isinstance(found, FunctionValue) and found.cls is None:
        return replace(found, cls=cls)
    if isinstance(found, Instance) and found.type in _DESCRIPTORS.values():
        return Instance(found.type, {n: _with_class(v, cls) for n, v in found.fields.items()})
    return found


def _with_setter(_: Machine, owner: Instance, arguments: Arguments) -> Value:
    return Instance(PROPERTY, {**owner.fields, "setter": arguments.get(0) or NONE})


PROPERTY = NativeClass("property", methods={"setter": _with_setter})
STATIC = NativeClass("staticmethod")
CLASSWISE = NativeClass("classmethod")
_DESCRIPTORS = {"property": PROPERTY, "staticmethod": STATIC, "classmethod": CLASSWISE}
