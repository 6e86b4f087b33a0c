"""C++'s names and calls."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from rtron.sources.code.interpreter.abstract_values.value_types import (
    Foreign,
    FunctionValue,
    Hole,
    Instance,
    Known,
    ListValue,
    MapValue,
    Native,
    NativeClass,
    Text,
    Value,
    each,
    is_text,
)
from rtron.sources.code.interpreter.cpp.calls import container_copied
from rtron.sources.code.interpreter.cpp.iterators import begin, end, item_at
from rtron.sources.code.interpreter.cpp.objects import CppObjects
from rtron.sources.code.interpreter.cpp.types import bound_overloads, ends_of
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.assignment import place_of
from rtron.sources.code.interpreter.execution.stack_frame import Frame, Place
from rtron.sources.code.ir import (
    Declare,
    Define,
    Import,
    Lambda,
    Name,
    TypeRef,
)
from rtron.sources.code.library_models.common.containers import CPP_MAP, LIST, bound
from rtron.sources.code.library_models.common.strings import CPP_TEXT, text_method
from rtron.sources.code.library_models.cpp_std.registry import (
    CONSTANTS,
    PARAMETER_KIND,
    PLACEHOLDERS,
    kind_of,
)
from rtron.sources.code.library_models.ros2_common.parameter_types import parameter_kind

_MAKERS = frozenset({"make_shared", "make_unique"})


@dataclass(eq=False, slots=True, kw_only=True)
class CppWorld(CppObjects):
    """One program as the machine asks for it."""

    functions: Mapping[str, Native]
    constants: Mapping[str, Value] = field(default_factory=lambda: CONSTANTS)
    _function_ends: frozenset[str] = field(default=frozenset(), init=False)
    _globals: dict[str, Value] = field(default_factory=dict)
    _known: dict[tuple[str, str], tuple[str, ...]] = field(default_factory=dict)
    _known_at: int = -1

    by_reference = True

    def __post_init__(self) -> None:
        """Note how the names of native functions end: most names are none of them."""
        CppObjects.__post_init__(self)
        self._function_ends = ends_of(self.functions)

    def lookup(self, name: Name, frame: Frame) -> Value:
        """Return what a name means: local, member, of a namespace around, or of a library."""
        if name.id in frame.aliases:
            holder, key = frame.aliases[name.id]
            found: Value = holder.get(key, Hole(name.id))
            return found
        if name.id in frame.variables:
            local: Value = frame.variables[name.id]
            return local
        if frame.closure is not None and self._in_closure(name.id, frame.closure):
            return self.lookup(name, frame.closure)
        found = self._member(name, frame) or self._outer(name, frame)
        if name.types and isinstance(found, FunctionValue):
            return replace(found, types=tuple(self.resolved(type, frame) for type in name.types))
        return found

    def place(self, name: str, frame: Frame) -> Place:
        """Return where a name's value is kept."""
        if name in frame.aliases:
            return frame.aliases[name]
        if name not in frame.variables:
            if frame.closure is not None and self._in_closure(name, frame.closure):
                return self.place(name, frame.closure)
            if isinstance(frame.this, Instance) and name in frame.this.fields:
                return Place(frame.this.fields, name)
            if self.symbols.is_end(name):
                for candidate in self.symbols.candidates(name, frame.scope):
                    if candidate in self.symbols.variables:
                        return Place(self._globals, candidate)
        return Place(frame.variables, name)

    def is_constant(self, name: str, frame: Frame) -> bool:
        """Tell whether a name is of a constant: whoever is given it cannot change it."""
        if name in frame.constants or name in frame.aliases or name in frame.variables:
            return frame.constants.get(name, False)
        if frame.closure is not None and self._in_closure(name, frame.closure):
            return self.is_constant(name, frame.closure)
        found = self.place(name, frame)
        if isinstance(frame.this, Instance) and found.holder is frame.this.fields:
            return self.has_constant(name, frame.this.type)
        variable = self.symbols.variables.get(found.key) if found.holder is self._globals else None
        return variable is not None and variable[0].constant

    def attribute(self, owner: Value, name: str, types: tuple[TypeRef, ...]) -> Value | None:
        """Return a member, bound to its owner; through an iterator, of what it points at."""
        if isinstance(owner, Instance):
            target = item_at(owner)
            if target is not owner and not name.startswith("operator"):
                return each(target, lambda one: self.attribute(one, name, types) or Hole(name))
            return self._of_instance(owner, name, types)
        if name in _KINDS:
            return Native(name, _KINDS[name], owner)
        if isinstance(owner, (ListValue, MapValue)):
            return _of_container(owner, name)
        if isinstance(owner, Text) or (isinstance(owner, Known) and isinstance(owner.value, str)):
            return text_method(CPP_TEXT, owner, name)
        return None

    def declare(self, node: Declare, frame: Frame) -> None:
        """Make a local variable."""
        frame.constants[node.name] = node.constant and self._may_be_constant(node.name, frame)
        if (node.reference or node.pointer) and node.value is not None:
            place = place_of(self.machine, node.value, frame)
            if place is not None and _may_alias(node, place.holder.get(place.key)):
                frame.aliases[node.name] = place
                return
        frame.aliases.pop(node.name, None)
        self.machine.trail.set(frame.variables, node.name, self.initial(node, frame))

    def _may_be_constant(self, name: str, frame: Frame) -> bool:
        """Tell whether no variable that may change has the name already: blocks share a frame."""
        if self.is_constant(name, frame):
            return True
        holder, key = self.place(name, frame)
        return name not in frame.constants and holder is frame.variables and key not in holder

    def around(self, node: Lambda, frame: Frame) -> Frame:
        """Return the frame around a lambda: what it takes by copy stays as it is now."""
        if not node.copies and not node.captures:
            return frame
        made = replace(frame, variables={}, aliases={}, closure=frame, returns=[], yields=[])
        made.constants = dict(frame.constants)
        for name in node.copies:
            if self._in_closure(name, frame):
                made.variables[name] = container_copied(self.lookup(Name(name), frame))
        for variable in node.captures:
            self.declare(variable, made)
        return made

    def define(self, node: Define, frame: Frame) -> None:
        """C++ defines nothing while it runs."""
        raise TypeError(node, frame)

    def import_(self, node: Import, frame: Frame) -> None:
        """C++ imports nothing while it runs."""
        raise TypeError(node, frame)

    def _of_instance(self, owner: Instance, name: str, types: tuple[TypeRef, ...]) -> Value | None:
        if name in owner.fields:
            return self.machine.seen(name, owner.fields[name])
        if isinstance(owner.type, NativeClass):
            call = owner.type.methods.get(name)
            return Native(name, call, owner, types) if call else None
        return self.method(owner.type, name, owner)

    def _member(self, name: Name, frame: Frame) -> Value | None:
        if frame.this is None:
            return None
        if name.id == "this":
            return frame.this
        if not isinstance(frame.this, Instance):
            return None
        if "::" in name.id:
            return self._base_method(name.id, frame)
        return self._of_instance(frame.this, name.id, name.types)

    def _base_method(self, name: str, frame: Frame) -> Value | None:
        """`Base::run` inside a class: that base's own method, bound to this."""
        owner, _, method = name.rpartition("::")
        definition = self.symbols.class_named(owner, frame.scope)
        if definition is None or frame.this is None:
            return self._native_method(owner, method, frame)
        functions = self.overloads(f"{definition.name}::{method}")
        if not functions:
            return None
        return bound_overloads(functions, frame.this, self._class(definition))

    def _native_method(self, owner: str, method: str, frame: Frame) -> Value | None:
        """`rclcpp::Node::shared_from_this` inside a class that extends it."""
        base = self.class_of(TypeRef(owner), frame)
        if not isinstance(base, NativeClass) or not isinstance(frame.this, Instance):
            return None
        call = base.methods.get(method) if base in self.lineage(frame.this.type) else None
        return Native(method, call, frame.this) if call is not None else None

    def _outer(self, name: Name, frame: Frame) -> Value:
        found = self._parameter(name, frame) or _copy(self.constants.get(name.id))
        if found is None and "::" in name.id and name.id in self.functions:
            found = self._native(name.id, name)
        return found or self._around(name, frame) or self._made_by(name, frame)

    def _parameter(self, name: Name, frame: Frame) -> Value | None:
        """Return what a template parameter stands for: a type, or a number."""
        meant = frame.types.get(name.id)
        if meant is None:
            return None
        if meant.name.lstrip("-").isdigit():
            return Known(int(meant.name))
        return self._type_value(meant, frame) or Hole(name.id)

    def _around(self, name: Name, frame: Frame) -> Value | None:
        """Return what a name means in the namespaces around, and through their aliases."""
        if name.id.partition("::")[0] in frame.types:
            return self._among(self._candidates(name.id, frame), name)
        key = name.id, frame.scope
        if self._known_at != self.symbols.version:
            self._known_at = self.symbols.version
            self._known.clear()
        if key not in self._known:
            candidates = self._candidates(name.id, frame) if self._may_be_global(name.id) else ()
            self._known[key] = tuple(c for c in candidates if self._is_global(c))
        return self._among(self._known[key], name)

    def _candidates(self, name: str, frame: Frame) -> tuple[str, ...]:
        followed = self.resolved(TypeRef(name), frame).name
        aliased = (followed,) if followed != name and "::" in followed else ()
        return (*self.symbols.candidates(name, frame.scope), *aliased)

    def _among(self, candidates: tuple[str, ...], name: Name) -> Value | None:
        for candidate in candidates:
            found = self._global(candidate, name)
            if found is not None:
                return found
        return None

    def _may_be_global(self, name: str) -> bool:
        """Tell whether anything that a name may mean can be a global: its last part stays."""
        return self.symbols.is_end(name) or name.rpartition("::")[2] in self._function_ends

    def _is_global(self, name: str) -> bool:
        symbols = self.symbols
        tables = (symbols.variables, symbols.enums, symbols.functions, self.functions)
        return name in self._globals or any(name in table for table in tables)

    def _made_by(self, name: Name, frame: Frame) -> Value:
        if name.id in PLACEHOLDERS:
            return PLACEHOLDERS[name.id]
        if name.id.startswith(PARAMETER_KIND):
            return Known(name.id.removeprefix(PARAMETER_KIND))
        made = self._type_value(TypeRef(name.id, name.types), frame)
        return made or self._maker(name, frame) or Foreign(name.id)

    def _maker(self, name: Name, frame: Frame) -> Value | None:
        """`Class::make_shared(…)`, which rclcpp gives its classes (rclcpp/macros.hpp)."""
        cls, _, last = name.id.rpartition("::")
        return self._type_value(TypeRef(cls), frame) if cls and last in _MAKERS else None

    def _global(self, name: str, node: Name) -> Value | None:
        if name in self._globals:
            return self.machine.seen(name.rpartition("::")[2], self._globals[name])
        if name in self.symbols.variables:
            return self._initialised(name)
        if name in self.symbols.enums:
            value = self.symbols.enums[name]
            return Hole(name) if value is None else Known(value)
        functions = self.overloads(name)
        if functions:
            return FunctionValue(functions[0], types=node.types, overloads=functions)
        return self._native(name, node) if name in self.functions else None

    def _native(self, name: str, node: Name) -> Native:
        native = self.functions[name]
        return Native(native.name, native.call, native.owner, node.types)

    def _type_value(self, type: TypeRef, frame: Frame) -> Value | None:
        """Return a native function that makes an object of a type: `Foo(x)`."""
        found = self.class_of(type, frame)
        if found is None:
            return None

        def make(_: Machine, __: object, arguments: Arguments) -> Value:
            return self.make(type, arguments)

        return Native(type.name, make)

    def make_globals(self) -> None:
        """Make the program's global objects, as is done before main runs."""
        for name, (declared, file) in list(self.symbols.variables.items()):
            if declared.type is not None and self.symbols.is_own(file):
                self.lookup(Name(name), Frame(file=file))

    def _initialised(self, name: str) -> Value:
        declared, file = self.symbols.variables[name]
        scope = name.rpartition("::")[0]
        self._globals[name] = Hole(name)
        self._globals[name] = self.initial(declared, Frame(file=file, scope=scope))
        return self._globals[name]

    def _in_closure(self, name: str, frame: Frame) -> bool:
        return (
            name in frame.variables
            or name in frame.aliases
            or (frame.closure is not None and self._in_closure(name, frame.closure))
        )


_KINDS = {"getType": kind_of, "get_type": parameter_kind}
"""What tells the kind of a parameter's value, in ROS 1 and in ROS 2."""


def _may_alias(node: Declare, value: Value | None) -> bool:
    """Tell whether a variable is another name of a place: a reference, a pointer to a string."""
    return value is not None and (node.reference or is_text(value))


def _of_container(owner: ListValue | MapValue, name: str) -> Value | None:
    walk = {"begin": begin, "end": end, "cbegin": begin, "cend": end}.get(name)
    if walk is not None:
        return Native(name, walk, owner)
    return bound(LIST if isinstance(owner, ListValue) else CPP_MAP, owner, name)


def _copy(constant: Value | None) -> Value | None:
    """Return a constant as an object of its own, which may be changed; a bare mark is itself."""
    if not (isinstance(constant, Instance) and constant.fields):
        return constant
    return Instance(constant.type, dict(constant.fields))
