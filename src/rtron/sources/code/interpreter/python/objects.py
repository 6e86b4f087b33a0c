"""Python's classes and objects: members, decorators, bases."""

import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from functools import partial

from rtron.sources.code.interpreter.abstract_values.items import items_of, list_of
from rtron.sources.code.interpreter.abstract_values.shown_text import str_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    Choice,
    ClassValue,
    ExternalSymbol,
    FunctionValue,
    Instance,
    LibraryClass,
    LibraryFunction,
    MapValue,
    Scalar,
    Unknown,
    Value,
    join,
    map_options,
    options,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments, LibraryCall
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame
from rtron.sources.code.interpreter.python.descriptors import (
    CLASS_METHOD,
    DESCRIPTORS,
    OBJECT_METHODS,
    PROPERTY,
    STATIC_METHOD,
)
from rtron.sources.code.interpreter.python.method_resolution_order import (
    SUPER,
    MethodResolutionOrders,
)
from rtron.sources.code.interpreter.python.modules import (
    PythonModules,
    initialise_base,
    named_functions,
)
from rtron.sources.code.ir import Attr, Call, Class, Function, Name, TypeRef
from rtron.sources.code.ir.references import ir_nodes
from rtron.sources.code.library_models.python_std.data_classes import (
    ENUM,
    NAMED_TUPLE,
    add_enum_members,
    add_initialiser,
    enum_member,
    iterate_fields,
)
from rtron.vocabulary import Evidence, UnresolvedCause

_PYTHON_2 = {"BaseHTTPServer", "ConfigParser", "HTMLParser", "Queue", "SocketServer", "UserDict"}
_GUI_MODULES = {
    *("PyQt4", "PyQt5", "PyQt6", "PySide", "PySide2", "PySide6", "Tkinter", "tkinter", "wx")
}
_MODULES_WITHOUT_ROS = (
    sys.stdlib_module_names | _PYTHON_2 | _GUI_MODULES | {"python_qt_binding", "smach"}
)
_OWN_FIELDS = {"__class__", "__dict__"}
_METACLASS_METHODS = frozenset({"__new__", "__call__", "__prepare__"})
_NODE = "rclpy.node.Node"
_NODE_METHODS = frozenset(
    {"create_publisher", "create_subscription", "create_service", "create_client"}
)


@dataclass(eq=False, slots=True, kw_only=True)
class PythonObjects(PythonModules):
    """The classes and objects of one program."""

    _method_orders: MethodResolutionOrders = field(default_factory=MethodResolutionOrders)
    _library_bases: dict[str, Value] = field(default_factory=dict)
    _handed_classes: list[ClassValue] = field(default_factory=list)
    _classes: list[ClassValue] = field(default_factory=list)

    def method_names(self, definition: Class) -> list[str]:
        """Return the names of the methods that a class defines itself."""
        return [function.name for _, function in named_functions(definition.body)]

    def instantiate(self, called: Value, arguments: Arguments) -> Value:
        """Make an object by its `__new__` and run its `__init__`."""
        if not isinstance(called, ClassValue):
            return Unknown("object")
        if ENUM in self.lineage(called):
            return enum_member(called, arguments.value(0))
        made = self._new_object(called, arguments)
        if not isinstance(made, Instance) or made.type is not called:
            return made
        self.machine.instances.append(made)
        init = self._instance_member(made, "__init__")
        if init is not None:
            dispatch(self.machine, init, arguments)
        else:
            self.machine.escape_arguments(arguments)
        return made

    def _new_object(self, cls: ClassValue, arguments: Arguments) -> Value:
        new = self._find_member(cls, "__new__")
        if not isinstance(new, FunctionValue):
            return Instance(cls)
        made = dispatch(self.machine, new, replace(arguments, values=(cls, *arguments.values)))
        return Instance(cls) if isinstance(made, Unknown) else made

    def special_method(self, owner: Value, name: str) -> Value | None:
        """Return the method that an object's scanned class has for an operation, bound to it."""
        if not isinstance(owner, Instance) or not isinstance(owner.type, ClassValue):
            return None
        return self._bind_member(owner, self._find_member(owner.type, name))

    def iterate(self, value: Value) -> tuple[tuple[Value, ...], bool]:
        """Return what a loop over a value sees, and whether that is all."""
        method = self.special_method(value, "__iter__")
        if method is not None:
            found = dispatch(self.machine, method, Arguments(frame=StackFrame(file="")))
            return ((), False) if found is value else self.iterate(found)
        if isinstance(value, Instance) and NAMED_TUPLE in self.lineage(value.type):
            return iterate_fields(self.machine, value), True
        return items_of(value)

    def shown(self, value: Value) -> Value:
        """Return a value as a text shows it: an object of a scanned class by its `__str__`."""
        method = self.special_method(value, "__str__")
        if method is None:
            return map_options(value, str_of)
        return dispatch(self.machine, method, Arguments(frame=StackFrame(file="")))

    def lineage(self, cls: Value) -> Iterator[Value]:
        """Yield a class and its bases, in the order in which a member is looked for."""
        return iter(self._method_orders.order_of(cls))

    def _instance_member(self, owner: Instance, name: str) -> Value | None:
        if owner.type is SUPER:
            return self._super_member(owner, name)
        if name in owner.fields:
            is_fixed = name in self.machine.volatile and ENUM in self.lineage(owner.type)
            own: Value = owner.fields[name]
            return own if is_fixed else self.machine.volatile_value(name, own)
        if name in _OWN_FIELDS:
            return owner.type if name == "__class__" else members_of(owner)
        if isinstance(owner.type, LibraryClass):
            call = owner.type.methods.get(name)
            return LibraryFunction(name, call, owner) if call else None
        found = self._bind_member(owner, self._find_member(owner.type, name))
        return found if found is not None or name.startswith("__") else self._get(owner, name)

    def _get(self, owner: Instance, name: str) -> Value | None:
        """Return what a class's `__getattr__` gives for a name that the object has not."""
        method = self.special_method(owner, "__getattr__")
        if method is None:
            return None
        at = Arguments(values=(Scalar(name),), frame=StackFrame(file=""))
        return dispatch(self.machine, method, at)

    def _super_member(self, seen: Instance, name: str) -> Value | None:
        """Return a member of `super()`: that of the first class behind, bound to the object."""
        owner = seen.fields["owner"]
        found = _first_member(items_of(seen.fields["behind"])[0], name)
        if found is None and name in OBJECT_METHODS:
            return LibraryFunction(name, OBJECT_METHODS[name], owner)
        if isinstance(owner, ClassValue):
            if found is not None and name == "__init_subclass__":
                return _bind_function(found, owner)
            return _bind_to_class(owner, found)
        return self._bind_member(owner, found) if isinstance(owner, Instance) else None

    def _bind_member(self, owner: Instance, found: Value | None) -> Value | None:
        """Return what stands in an object's class as the object has it."""
        described = self.special_method(found, "__get__") if isinstance(found, Instance) else None
        if described is not None:
            at = Arguments(values=(owner, owner.type), frame=StackFrame(file=""))
            return dispatch(self.machine, described, at)
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
        if name in {"__name__", "__qualname__"}:
            return Scalar(owner.name)
        if name == "__dict__" and isinstance(owner, ClassValue):
            return members_of(owner)
        if name == "__subclasses__":
            heirs = list_of([cls for cls in self._classes if owner in cls.bases])
            return LibraryFunction(name, lambda *_: heirs)
        return _first_member(self.lineage(owner), name)

    def _create_class(self, definition: Class, frame: StackFrame) -> ClassValue:
        found = [
            Unknown("base") if isinstance(base, TypeRef) else self.machine.evaluate(base, frame)
            for base in definition.bases
        ]
        self._note_bases(definition, found)
        bases = [each for base in found for each in self._with_node(base, definition)]
        body = StackFrame(file=frame.file, closure=frame, body="class")
        self.machine.execute(definition.body, body)
        made = ClassValue(definition, self.base_classes(bases), body.variables, closure=frame)
        self._classes.append(made)
        return self.finish_class(made, frame)

    def finish_class(self, made: ClassValue, frame: StackFrame) -> ClassValue:
        """Do what Python does once a class's body has run."""
        self._note_order(made)
        if NAMED_TUPLE in made.bases:
            add_initialiser(made)
        if ENUM in self.lineage(made):
            return add_enum_members(made)
        at = Arguments(line=made.definition.line, frame=frame)
        for name, member in list(made.fields.items()):
            named = self.special_method(member, "__set_name__")
            if named is not None:
                dispatch(self.machine, named, replace(at, values=(made, Scalar(name))))
        self._tell_bases(made, at)
        return made

    def _tell_bases(self, made: ClassValue, at: Arguments) -> None:
        """Run the `__init_subclass__` of a class's bases, and its metaclass's `__init__`."""
        words = {
            name: self.machine.evaluate(value, at.frame) for name, value in made.definition.keywords
        }
        metaclass = words.pop("metaclass", None)
        hook = _first_member(list(self.lineage(made))[1:], "__init_subclass__")
        if hook is not None and not isinstance(hook, LibraryFunction):
            function = hook.fields["getter"] if isinstance(hook, Instance) else hook
            dispatch(self.machine, function, replace(at, values=(made,), keywords=words))
        if isinstance(metaclass, ClassValue):
            self._run_metaclass(metaclass, made, at)

    def _run_metaclass(self, metaclass: ClassValue, made: ClassValue, at: Arguments) -> None:
        """Run a metaclass's `__init__`; what else it does is noted."""
        init = self._find_member(metaclass, "__init__")
        if isinstance(init, FunctionValue):
            members = MapValue(dict(made.fields))
            values = (made, Scalar(made.name), list_of(made.bases, "tuple"), members)
            dispatch(self.machine, init, replace(at, values=values))
        for name in _METACLASS_METHODS.intersection(metaclass.fields):
            why = f"what {name} of its metaclass {metaclass.name} does is not followed"
            self.machine.recorder.add_unresolved(f"class {made.name}", why, at.evidence)

    def base_classes(self, bases: Iterable[Value]) -> tuple[Value, ...]:
        """Return the classes that a class is made from; one of a library is always the same."""
        return tuple(map(self._base_class, bases))

    def _base_class(self, base: Value) -> Value:
        if isinstance(base, Choice):
            return join([self._base_class(option) for option in base.options])
        if not isinstance(base, LibraryFunction):
            return base
        return self._library_bases.setdefault(base.name, library_base(base))

    def _note_bases(self, definition: Class, bases: Iterable[Value]) -> None:
        """Note each base class of a library that is neither here nor known to join no nodes."""
        location = Evidence(file=definition.file, line=definition.line)
        found = (option for base in bases for option in options(base))
        for base in (option for option in found if isinstance(option, ExternalSymbol)):
            if self._is_missing(base):
                why = f"its base class {base.name} is not in the source: "
                why += "what that declares is not known"
                self.machine.recorder.add_unresolved(
                    f"class {definition.name}", why, location, cause=UnresolvedCause.MISSING_CODE
                )

    def _is_missing(self, base: ExternalSymbol) -> bool:
        return "." in base.name and not self._is_known(base.name)

    def _with_node(self, base: Value, definition: Class) -> tuple[Value, ...]:
        """Return a base, behind that of a node if it is not here and the class makes endpoints."""
        node = self.library.get(_NODE)
        if node is None or not (isinstance(base, ExternalSymbol) and self._is_missing(base)):
            return (base,)
        methods = (function for _, function in named_functions(definition.body))
        return (node, base) if any(map(_makes_own_endpoint, methods)) else (base,)

    def take_handed_class(self, cls: ClassValue, arguments: Arguments) -> None:
        """Let a library that is not here make a node of the class that it gets, once for each."""
        if self.library.get(_NODE, NONE) in self.lineage(cls) and cls not in self._handed_classes:
            self._handed_classes.append(cls)
            make = partial(self._make_handed_node, cls, arguments)
            self.machine.deferred_actions.append(make)

    def _make_handed_node(self, cls: ClassValue, arguments: Arguments) -> None:
        """Make a node, unless the program makes one."""
        instances = (one for one in self.machine.instances if isinstance(one, Instance))
        if not any(one.type is cls for one in instances):
            dispatch(self.machine, cls, replace(arguments, values=(), keywords={}))

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
        if isinstance(decorator, (ExternalSymbol, Unknown)):
            return value
        made = dispatch(self.machine, decorator, Arguments(values=(value,), frame=frame))
        return value if isinstance(made, Unknown) or made == NONE else made


def _makes_own_endpoint(method: Function) -> bool:
    """Return whether a method calls what makes an endpoint on its own object, not on another."""
    own = Name(method.params[0].name) if method.params else None
    called = (node.function for node in ir_nodes(method.body or ()) if isinstance(node, Call))
    return any(isinstance(f, Attr) and f.name in _NODE_METHODS and f.owner == own for f in called)


def members_of(owner: Instance | ClassValue) -> MapValue:
    """Return an object's or a class's `__dict__`."""
    return MapValue(owner.fields, is_namespace=True)


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


def library_base(base: LibraryFunction) -> LibraryClass:
    """Return the class that a library's function stands for which makes objects."""

    def init(machine: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
        given = replace(arguments, values=(owner, *arguments.values))
        return initialise_base(base, machine, None, given)

    return LibraryClass(base.name, methods={"__init__": init})


def _bind_function(found: Value, owner: Value) -> Value:
    if not isinstance(found, FunctionValue) or found.owner is not None:
        return found
    return replace(found, owner=owner)


def _with_defining_class(found: Value, cls: ClassValue) -> Value:
    """Return a member that knows the class it stands in, which `super()` needs."""
    if isinstance(found, FunctionValue) and found.cls is None:
        return replace(found, cls=cls)
    if isinstance(found, Instance) and found.type in DESCRIPTORS.values():
        return Instance(
            found.type, {n: _with_defining_class(v, cls) for n, v in found.fields.items()}
        )
    return found
