"""C++'s names and calls."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

from rtron.sources.code import ir
from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.cpp.calls import copy_container
from rtron.sources.code.interpreter.cpp.held_values import PLACE_TAGS, place_tag
from rtron.sources.code.interpreter.cpp.iterators import dereference
from rtron.sources.code.interpreter.cpp.objects import CppObjects
from rtron.sources.code.interpreter.cpp.overload_resolution import hides
from rtron.sources.code.interpreter.cpp.types import bound_overloads, unqualified_names
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.assignment import slot_of
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame, StorageSlot
from rtron.sources.code.ir.references import called_names
from rtron.sources.code.library_models.common.maps import cpp_container_member
from rtron.sources.code.library_models.common.strings import CPP_STRING_METHODS, bound_string_method
from rtron.sources.code.library_models.cpp_std.registry import (
    CONSTANTS,
    PARAMETER_TYPE_PREFIX,
    PLACEHOLDERS,
    parameter_type_of,
)
from rtron.sources.code.library_models.ros2_common.parameter_types import get_type

_FACTORIES = frozenset({"make_shared", "make_unique"})
_SAME_TYPES = frozenset({"std::is_same_v", "std::is_same::value"})


@dataclass(eq=False, slots=True, kw_only=True)
class CppRuntime(CppObjects):
    """One program, as the machine runs it."""

    library_functions: Mapping[str, av.LibraryFunction]
    library_constants: Mapping[str, av.Value] = field(default_factory=lambda: CONSTANTS)
    _unqualified_functions: frozenset[str] = field(default=frozenset(), init=False)
    _globals: dict[str, av.Value] = field(default_factory=dict)
    _statics: dict[object, dict[str, av.Value]] = field(default_factory=dict)
    _candidate_cache: dict[tuple[str, str], tuple[str, ...]] = field(init=False)

    passes_by_reference = True

    def __post_init__(self) -> None:
        """Note the last parts of the library functions' names: most names are none of them."""
        CppObjects.__post_init__(self)
        self._unqualified_functions = unqualified_names(self.library_functions)
        self._candidate_cache = self.symbols.new_cache()

    def module_variables(self) -> Iterator[Mapping[str, av.Value]]:
        """Yield the variables of namespaces that were used."""
        yield self._globals

    def special_method(self, owner: av.Value, name: str) -> av.Value | None:
        """C++ has none of Python's."""
        del owner, name
        return None

    def related_names(self, function: ir.Function) -> frozenset[str]:
        """Return the plain names of what a function calls, makes or hands on."""
        return called_names(function)

    def calls_unknown(self, function: ir.Function) -> bool:
        """C++ names what it calls; a function that is passed is one of its callbacks."""
        del function
        return False

    def find_by_arguments(self, name: str, arguments: Arguments) -> av.Value | None:
        """Return a function of the namespace of an argument's class, or of one of its bases."""
        given = [value.type for value in arguments.values if isinstance(value, av.Instance)]
        classes = [one for type in given for one in self.lineage(type)] if "::" not in name else []
        spaces = (str(getattr(one, "name", "")).rpartition("::")[0] for one in classes)
        found = ir.Name(name, types=arguments.types)
        return self._first_global(tuple(f"{space}::{name}" for space in spaces if space), found)

    def note_unknown_call(self, called: av.Value, arguments: Arguments) -> None:
        """C++ notes these where it evaluates the call: the template arguments tell."""
        del called, arguments

    def shown(self, value: av.Value) -> av.Value:
        """Return a value as a text shows it."""
        return value

    def iterate(self, value: av.Value) -> tuple[tuple[av.Value, ...], bool]:
        """Return what a loop over a value sees, and whether that is all."""
        return av.items_of(value)

    def lookup(self, name: ir.Name, frame: StackFrame) -> av.Value:
        """Return what a name means: local, member, of a namespace around, or of a library."""
        if name.id in frame.aliases:
            holder, key = frame.aliases[name.id]
            found: av.Value = holder.get(key, av.Unknown(name.id))
            return found
        if name.id in frame.variables:
            local: av.Value = frame.variables[name.id]
            return local
        if frame.closure is not None and self._in_closure(name.id, frame.closure):
            return self.lookup(name, frame.closure)
        found = self._member(name, frame) or self._outer_name(name, frame)
        if name.types and isinstance(found, av.FunctionValue):
            return replace(
                found, types=tuple(self.resolve_type(type, frame) for type in name.types)
            )
        return found

    def slot(self, name: str, frame: StackFrame) -> StorageSlot:
        """Return where a name's value is kept."""
        if name in frame.aliases:
            return frame.aliases[name]
        if name not in frame.variables:
            if frame.closure is not None and self._in_closure(name, frame.closure):
                return self.slot(name, frame.closure)
            if isinstance(frame.this, av.Instance) and name in frame.this.fields:
                return StorageSlot(frame.this.fields, name)
            if self.symbols.is_known_name(name):
                for candidate in self.symbols.candidates(name, frame.scope):
                    if candidate in self.symbols.variables:
                        return StorageSlot(self._globals, candidate)
        return StorageSlot(frame.variables, name)

    def is_constant(self, name: str, frame: StackFrame) -> bool:
        """Tell whether a name is of a constant: whoever is given it cannot change it."""
        if name in frame.constants or name in frame.aliases or name in frame.variables:
            return frame.constants.get(name, False)
        if frame.closure is not None and self._in_closure(name, frame.closure):
            return self.is_constant(name, frame.closure)
        found = self.slot(name, frame)
        if isinstance(frame.this, av.Instance) and found.holder is frame.this.fields:
            return self.has_constant_member(name, frame.this.type)
        variable = self.symbols.variables.get(found.key) if found.holder is self._globals else None
        return variable is not None and variable[0].constant

    def attribute(
        self, owner: av.Value, name: str, types: tuple[ir.TypeRef, ...]
    ) -> av.Value | None:
        """Return a member, bound to its owner; through an iterator, of what it points at."""
        if isinstance(owner, av.Instance):
            target = dereference(owner)
            if target is not owner and not name.startswith("operator"):
                return av.map_options(
                    target, lambda one: self.attribute(one, name, types) or av.Unknown(name)
                )
            return self._instance_member(owner, name, types)
        if name in _PARAMETER_TYPE_METHODS:
            return av.LibraryFunction(name, _PARAMETER_TYPE_METHODS[name], owner)
        if isinstance(owner, (av.ListValue, av.MapValue)):
            return cpp_container_member(owner, name)
        if av.is_text(owner):
            return bound_string_method(CPP_STRING_METHODS, owner, name)
        return None

    def declare(self, node: ir.Declare, frame: StackFrame) -> None:
        """Make a local variable."""
        frame.constants[node.name] = node.constant and self._may_be_constant(node.name, frame)
        if node.static:
            frame.aliases[node.name] = self._static_local(node, frame)
            return
        if (node.reference or node.pointer) and node.value is not None:
            slot = slot_of(self.machine, node.value, frame)
            if slot is not None and _may_alias(node, slot.holder.get(slot.key)):
                frame.aliases[node.name] = slot
                return
        frame.aliases.pop(node.name, None)
        self.machine.undo_log.set(frame.variables, node.name, self.initial_value(node, frame))

    def _static_local(self, node: ir.Declare, frame: StackFrame) -> StorageSlot:
        """Return where a function's static variable is kept, which the first call makes."""
        key = (frame.function and frame.function.key, node.line, *sorted(frame.types.items()))
        held = self._statics.setdefault(key, {})
        if node.name not in held:
            self.machine.undo_log.set(held, node.name, self.initial_value(node, frame))
        return StorageSlot(held, node.name)

    def _may_be_constant(self, name: str, frame: StackFrame) -> bool:
        """Tell whether no variable that may change has the name already: blocks share a frame."""
        if self.is_constant(name, frame):
            return True
        holder, key = self.slot(name, frame)
        return name not in frame.constants and holder is frame.variables and key not in holder

    def closure_frame(self, node: ir.Lambda, frame: StackFrame) -> StackFrame:
        """Return the frame around a lambda: what it takes by copy stays as it is now."""
        if not node.copies and not node.captures:
            return frame
        made = replace(frame, variables={}, aliases={}, closure=frame, returns=[], yields=[])
        made.constants = dict(frame.constants)
        for name in node.copies:
            if self._in_closure(name, frame):
                made.variables[name] = copy_container(self.lookup(ir.Name(name), frame))
        for variable in node.captures:
            self.declare(variable, made)
        return made

    def _instance_member(
        self, owner: av.Instance, name: str, types: tuple[ir.TypeRef, ...]
    ) -> av.Value | None:
        if name in owner.fields:
            return self.machine.volatile_value(name, owner.fields[name])
        if isinstance(owner.type, av.LibraryClass):
            call = owner.type.methods.get(name)
            return av.LibraryFunction(name, call, owner, types) if call else None
        return self.bound_method(owner.type, name, owner)

    def _member(self, name: ir.Name, frame: StackFrame) -> av.Value | None:
        if frame.this is None:
            return None
        if name.id == "this":
            return frame.this
        if not isinstance(frame.this, av.Instance):
            return None
        if "::" in name.id:
            return self._base_method(name.id, frame)
        found = self._instance_member(frame.this, name.id, name.types)
        if not isinstance(found, av.FunctionValue) or found.cls is frame.cls or frame.cls is None:
            return found
        own = self.overloads(f"{frame.cls.name}::{name.id}")
        return bound_overloads(own, frame.this, frame.cls) if hides(found.overloads, own) else found

    def _base_method(self, name: str, frame: StackFrame) -> av.Value | None:
        """`Base::run` inside a class: that base's own method, bound to this."""
        owner, _, method = name.rpartition("::")
        base = self.class_of(ir.TypeRef(owner), frame)
        if base is None or not isinstance(frame.this, av.Instance):
            return None
        if base not in self.lineage(frame.this.type):
            return None
        if isinstance(base, av.LibraryClass):
            call = base.methods.get(method)
            return av.LibraryFunction(method, call, frame.this) if call is not None else None
        functions = self.overloads(f"{base.name}::{method}")
        return bound_overloads(functions, frame.this, base) if functions else None

    def _outer_name(self, name: ir.Name, frame: StackFrame) -> av.Value:
        found = self._template_parameter(name, frame) or _copy_constant(
            self.library_constants.get(name.id)
        )
        if name.id in _SAME_TYPES and len(name.types) > 1:
            first, second = (self.qualified_type(type, frame) for type in name.types[:2])
            return av.Scalar(first == second)
        if found is None and name.types and self.symbols.specialisations:
            found = self._specialised_member(name, frame)
        if name.id in PLACE_TAGS:
            return place_tag(tuple(self.resolve_type(type, frame) for type in name.types))
        if found is None and "::" in name.id and name.id in self.library_functions:
            found = self._library_function(name.id, name)
        return (
            found or self._namespace_member(name, frame) or self._type_or_placeholder(name, frame)
        )

    def _specialised_member(self, name: ir.Name, frame: StackFrame) -> av.Value | None:
        """`T<int>::text`, a static member of what the template T is specialised as for int."""
        owner, _, member = name.id.rpartition("::")
        cls = self.class_of(ir.TypeRef(owner, name.types), frame) if owner else None
        if not isinstance(cls, av.ClassValue) or not cls.definition.specialised:
            return None
        return self._global(f"{cls.name}::{member}", ir.Name(member))

    def _template_parameter(self, name: ir.Name, frame: StackFrame) -> av.Value | None:
        """Return what a template parameter stands for: a type, or a number."""
        meant = frame.types.get(name.id)
        if meant is None:
            return None
        if meant.name.lstrip("-").isdigit():
            return av.Scalar(int(meant.name))
        return self._type_value(meant, frame) or av.Unknown(name.id)

    def _namespace_member(self, name: ir.Name, frame: StackFrame) -> av.Value | None:
        """Return what a name means in the namespaces around, and through their aliases."""
        if name.id.partition("::")[0] in frame.types:
            return self._first_global(self._candidates(name.id, frame), name)
        key = name.id, frame.scope
        if key not in self._candidate_cache:
            candidates = self._candidates(name.id, frame) if self._may_be_global(name.id) else ()
            self._candidate_cache[key] = tuple(c for c in candidates if self._is_global(c))
        return self._first_global(self._candidate_cache[key], name)

    def _candidates(self, name: str, frame: StackFrame) -> tuple[str, ...]:
        followed = self.resolve_type(ir.TypeRef(name), frame).name
        aliased = (followed,) if followed != name and "::" in followed else ()
        return (*self.symbols.candidates(name, frame.scope), *aliased)

    def _first_global(self, candidates: tuple[str, ...], name: ir.Name) -> av.Value | None:
        for candidate in candidates:
            found = self._global(candidate, name)
            if found is not None:
                return found
        return None

    def _may_be_global(self, name: str) -> bool:
        """Tell whether anything that a name may mean can be a global: its last part stays."""
        return (
            self.symbols.is_known_name(name)
            or name.rpartition("::")[2] in self._unqualified_functions
        )

    def _is_global(self, name: str) -> bool:
        symbols = self.symbols
        tables = (symbols.variables, symbols.enums, symbols.functions, self.library_functions)
        return name in self._globals or any(name in table for table in tables)

    def _type_or_placeholder(self, name: ir.Name, frame: StackFrame) -> av.Value:
        if name.id in PLACEHOLDERS:
            return PLACEHOLDERS[name.id]
        if name.id.startswith(PARAMETER_TYPE_PREFIX):
            return av.Scalar(name.id.removeprefix(PARAMETER_TYPE_PREFIX))
        made = self._type_value(ir.TypeRef(name.id, name.types), frame)
        return made or self._factory(name, frame) or av.ExternalSymbol(name.id)

    def _factory(self, name: ir.Name, frame: StackFrame) -> av.Value | None:
        """`Class::make_shared(…)`, which rclcpp gives its classes (rclcpp/macros.hpp)."""
        cls, _, last = name.id.rpartition("::")
        return self._type_value(ir.TypeRef(cls), frame) if cls and last in _FACTORIES else None

    def _global(self, name: str, node: ir.Name) -> av.Value | None:
        if name in self._globals:
            return self.machine.volatile_value(name.rpartition("::")[2], self._globals[name])
        if name in self.symbols.variables:
            return self._initialise_global(name)
        if name in self.symbols.enums:
            value = self.symbols.enums[name]
            return av.Unknown(name) if value is None else av.Scalar(value)
        functions = self.overloads(name)
        if functions:
            return av.FunctionValue(functions[0], types=node.types, overloads=functions)
        return self._library_function(name, node) if name in self.library_functions else None

    def _library_function(self, name: str, node: ir.Name) -> av.LibraryFunction:
        found = self.library_functions[name]
        return av.LibraryFunction(found.name, found.call, found.owner, node.types)

    def _type_value(self, type: ir.TypeRef, frame: StackFrame) -> av.Value | None:
        """Return a function that makes an object of a type: `Foo(x)`."""
        found = self.class_of(type, frame)
        if found is None:
            return None

        def make(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
            return self.construct(type, arguments)

        return av.LibraryFunction(type.name, make)

    def initialise_globals(self) -> None:
        """Make the program's global objects, as is done before main runs; macros are none."""
        for name, (declared, file) in list(self.symbols.variables.items()):
            if not declared.static and self.symbols.is_program_file(file):
                self.lookup(ir.Name(name), StackFrame(file=file))
        for statement, file in self.symbols.stray:
            if self.symbols.is_program_file(file):
                self.machine.evaluate(statement.value, StackFrame(file=file))

    def _initialise_global(self, name: str) -> av.Value:
        declared, file = self.symbols.variables[name]
        scope = name.rpartition("::")[0]
        self._globals[name] = av.Unknown(name)
        self._globals[name] = self.initial_value(declared, StackFrame(file=file, scope=scope))
        return self._globals[name]

    def _in_closure(self, name: str, frame: StackFrame) -> bool:
        if name in frame.variables or name in frame.aliases:
            return True
        return frame.closure is not None and self._in_closure(name, frame.closure)


_PARAMETER_TYPE_METHODS = {"getType": parameter_type_of, "get_type": get_type}
"""The methods that give the type of a parameter's value, in ROS 1 and in ROS 2."""


def _may_alias(node: ir.Declare, value: av.Value | None) -> bool:
    """Tell whether a variable is another name of a slot: a reference, a pointer to a string."""
    return value is not None and (node.reference or av.is_text(value))


def _copy_constant(constant: av.Value | None) -> av.Value | None:
    """Return a constant as an object of its own, which may be changed; a bare mark is itself."""
    if not (isinstance(constant, av.Instance) and constant.fields):
        return constant
    return av.Instance(constant.type, dict(constant.fields))
