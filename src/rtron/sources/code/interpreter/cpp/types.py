"""C++'s types and classes: what a name of a type means, and the methods of a class."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from rtron.sources.code.interpreter.abstract_values.value_types import (
    ClassValue,
    Foreign,
    FunctionValue,
    Instance,
    Native,
    NativeClass,
    Value,
)
from rtron.sources.code.interpreter.cpp.symbol_table import Symbols
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.source_provider import Files
from rtron.sources.code.interpreter.execution.stack_frame import Frame
from rtron.sources.code.ir import (
    Class,
    Function,
    TypeRef,
    adapted_name,
)
from rtron.sources.code.library_models.common.message_types import (
    FOLDERS,
    cpp_message,
    cpp_message_name,
)

POINTERS = frozenset(
    [
        *("SharedPtr", "ConstSharedPtr", "WeakPtr", "ConstWeakPtr", "UniquePtr"),
        "SharedConstPtr",
    ]
)
"""What rclcpp's classes call pointers to themselves (rclcpp/macros.hpp)."""
_OF_MESSAGES = frozenset(["shared_ptr", "unique_ptr", "LoanedMessage"])
_MAX_BASES = 32


class _Scanned(NamedTuple):
    """A method that the source defines, and the class that has it."""

    functions: tuple[Function, ...]
    cls: ClassValue


class _Native(NamedTuple):
    """A method of a library's class."""

    call: Callable[..., Value]


@dataclass(eq=False, slots=True, kw_only=True)
class CppTypes:
    """The types of one program: its symbols, and the classes of the libraries that RTron knows."""

    files: Files
    symbols: Symbols
    native_classes: Mapping[str, NativeClass]
    _class_ends: frozenset[str] = field(default=frozenset(), init=False)
    _classes: dict[str, ClassValue] = field(default_factory=dict)
    _found: dict[tuple[str, str], ClassValue | NativeClass | None] = field(default_factory=dict)
    _found_at: int = -1
    _overloads: dict[str, tuple[int, tuple[Function, ...]]] = field(default_factory=dict)
    _methods: dict[tuple[str, str], _Scanned | _Native | None] = field(default_factory=dict)
    _methods_at: int = -1

    def __post_init__(self) -> None:
        """Note how the names of native classes end: most types are none of them."""
        self._class_ends = ends_of(self.native_classes)

    def size(self) -> int:
        """Return a number that changes when the program's functions do."""
        return self.symbols.version

    def own_functions(self) -> Iterator[tuple[str, Function]]:
        """Yield the functions of the program's sources and its package's headers, with names."""
        for functions in self.symbols.functions.values():
            yield from ((f.name, f) for f in functions if self.symbols.is_own(f.file))

    def named(self, name: str) -> tuple[Function, ...]:
        """Return the functions whose last part is a name."""
        return self.symbols.named(name)

    def lineage(self, cls: Value) -> Iterator[Value]:
        """Yield a class and its bases, nearest first."""
        queue, seen = [cls], 0
        while queue and seen < _MAX_BASES:
            seen += 1
            current = queue.pop(0)
            yield current
            if isinstance(current, ClassValue):
                queue.extend(current.bases)

    def has_constant(self, name: str, cls: Value) -> bool:
        """Tell whether the data members that a class and its bases have of a name are constant."""
        lineage = [one.definition for one in self.lineage(cls) if isinstance(one, ClassValue)]
        found = [member for one in lineage for member in one.fields if member.name == name]
        return bool(found) and all(member.constant for member in found)

    def class_of(self, type: TypeRef, frame: Frame) -> ClassValue | NativeClass | None:
        """Return the class that a type means, scanned or native."""
        resolved = self.resolved(type, frame)
        key = resolved.name, frame.scope
        if self._found_at != self.symbols.version:
            self._found_at = self.symbols.version
            self._found.clear()
        if key not in self._found:
            self._found[key] = self._class_of(resolved, frame)
        return self._found[key]

    def _class_of(self, resolved: TypeRef, frame: Frame) -> ClassValue | NativeClass | None:
        if "::" in resolved.name and resolved.name in self.native_classes:
            return self.native_classes[resolved.name]
        definition = self.symbols.class_named(resolved.name, frame.scope)
        if definition is not None:
            return self._class(definition)
        plain = resolved.name.rpartition("::")[2]
        if plain in self._class_ends:
            for candidate in self.symbols.candidates(resolved.name, frame.scope):
                if candidate in self.native_classes:
                    return self.native_classes[candidate]
        is_pointer = plain in POINTERS
        return self.native_classes["std::shared_ptr"] if is_pointer else None

    def resolved(self, type: TypeRef, frame: Frame) -> TypeRef:
        """Return a type with template parameters and typedefs followed."""
        if frame.types:
            type = _with_parameters(type, frame.types)
        found = self.symbols.type(type, frame.scope)
        if not found.args:
            return found
        return TypeRef(found.name, tuple([self.resolved(arg, frame) for arg in found.args]))

    def written_args(self, type: TypeRef, frame: Frame) -> tuple[TypeRef, ...]:
        """Return the template arguments of a type, classes by the names they have everywhere."""
        return tuple(self._full(arg, frame) for arg in self.resolved(type, frame).args)

    def _full(self, type: TypeRef, frame: Frame) -> TypeRef:
        found = self.symbols.class_named(type.name, frame.scope)
        return type if found is None else TypeRef(found.name, type.args)

    def class_named(self, name: str) -> ClassValue | None:
        """Return a scanned class by its qualified name."""
        definition = self.symbols.class_named(name, "")
        return self._class(definition) if definition is not None else None

    def method(self, cls: Value, name: str, owner: Value) -> Value | None:
        """Return the most derived method of a name, bound to its owner."""
        if isinstance(cls, NativeClass):
            return Native(name, cls.methods[name], owner) if name in cls.methods else None
        found = self._method(cls, name) if isinstance(cls, ClassValue) else None
        if isinstance(found, _Scanned):
            return bound_overloads(found.functions, owner, found.cls)
        return Native(name, found.call, owner) if found is not None else None

    def _method(self, cls: ClassValue, name: str) -> _Scanned | _Native | None:
        """Return the most derived method of a name; what was found holds until a file comes."""
        key = cls.name, name
        if self._methods_at == self.symbols.version and key in self._methods:
            return self._methods[key]
        found = self._found_method(cls, name)
        if self._methods_at != self.symbols.version:
            self._methods_at = self.symbols.version
            self._methods.clear()
        self._methods[key] = found
        return found

    def _found_method(self, cls: ClassValue, name: str) -> _Scanned | _Native | None:
        for ancestor in self.lineage(cls):
            if isinstance(ancestor, ClassValue):
                functions = self.overloads(f"{ancestor.name}::{name}")
                if functions:
                    return _Scanned(functions, ancestor)
            elif isinstance(ancestor, NativeClass) and name in ancestor.methods:
                return _Native(ancestor.methods[name])
        return None

    def method_names(self, definition: Class) -> list[str]:
        """Return the names of the methods that a class defines itself."""
        return self.symbols.methods(definition.name)

    def owned(self, called: FunctionValue, owner: Instance) -> FunctionValue:
        """Return a method named by `&Class::method`, bound to an object of that class."""
        cls, _, name = called.function.name.rpartition("::")
        if not cls or called.function.static or cls not in self._lines(owner):
            return called
        found = self.method(owner.type, name, owner)
        return found if isinstance(found, FunctionValue) else called

    def message_in(self, type: TypeRef | None, scope: str, types: Mapping[str, TypeRef]) -> str:
        """Return the message that a parameter's type means where its function is written."""
        if type is None:
            return ""
        resolved = self.resolved(type, Frame(file="", scope=scope, types=types))
        resolved = self._adapted(resolved, scope)
        name = cpp_message(resolved)
        package, _, plain = name.rpartition("/")
        if name and self.files.has_message(package, plain):
            return name
        return self._opened_message(plain or resolved.name.partition("::")[0]) or name

    def _adapted(self, type: TypeRef, scope: str) -> TypeRef:
        """Return the message that a type adapter, or a type that has one, is sent as (REP 2007)."""
        if type.args and type.name.endswith(("rclcpp::TypeAdapter", "rclcpp::adapt_type::as")):
            return type.args[-1]
        if type.args and type.name.rpartition("::")[2] in _OF_MESSAGES:
            return replace(type, args=(self._adapted(type.args[0], scope), *type.args[1:]))
        definition = self.symbols.class_named(type.name, scope)
        full = replace(type, name=definition.name) if definition is not None else type
        return self.symbols.aliases.get(adapted_name(str(full)), type)

    def _opened_message(self, plain: str) -> str:
        """Return what `using vector_map_msgs::PointArray` or `using namespace std_msgs` brings."""
        for using in self.symbols.usings:
            package, _, name = using.rpartition("::")
            for owner, what in ((package, name), (using, plain)):
                if owner.rpartition("::")[2] in FOLDERS and what == plain:
                    return self._opened_in_folder(owner, plain, named=name == plain)
                if what == plain and self.files.has_message(owner, cpp_message_name(plain)):
                    return f"{owner}/{cpp_message_name(plain)}"
        return ""

    def _opened_in_folder(self, space: str, plain: str, *, named: bool) -> str:
        """ROS 2: what `using std_msgs::msg::String` or `using namespace std_msgs::msg` brings."""
        package, _, folder = space.partition("::")
        is_message = named or self.files.has_message(package, plain)
        return f"{package}/{folder}/{plain}" if is_message else ""

    def types_of(self, called: FunctionValue) -> Mapping[str, TypeRef]:
        """Return what a method's template parameters, and those of its class, mean."""
        own = template_types(called.function, called.types)
        if not isinstance(called.owner, Instance) or called.cls is None:
            return own
        written = called.owner.bindings.get(called.cls.name, called.owner.types)
        return {**own, **template_types(called.cls.definition, written)}

    def bound_types(self, called: FunctionValue, arguments: Arguments) -> Mapping[str, TypeRef]:
        """Bind template parameters: of the object's class, written out, or by the arguments."""
        function, types = called.function, dict(getattr(called.closure, "types", {}))
        types.update(self.types_of(called))
        written = called.types or arguments.types
        resolved = tuple(self.resolved(type, arguments.frame) for type in written)
        types.update(template_types(function, resolved))
        return types

    def _lines(self, owner: Instance) -> set[str]:
        return {cls.name for cls in self.lineage(owner.type) if isinstance(cls, ClassValue)}

    def _class(self, definition: Class) -> ClassValue:
        if definition.name not in self._classes:
            made = ClassValue(definition)
            self._classes[definition.name] = made
            frame = Frame(file=definition.file, scope=definition.name.rpartition("::")[0])
            made.bases = tuple(
                self.class_of(base, frame) or Foreign(base.name)
                for base in definition.bases
                if isinstance(base, TypeRef)
            )
        return self._classes[definition.name]

    def overloads(self, name: str) -> tuple[Function, ...]:
        """Return the functions of a qualified name, those with a body if there are any."""
        known = self._overloads.get(name)
        if known is None or known[0] != self.symbols.version:
            found = self._found_overloads(name)
            known = self._overloads[name] = (self.symbols.version, found)
        return known[1]

    def _sought(self, functions: list[Function]) -> bool:
        """Look for the definitions of functions that are only declared so far."""
        answers = [self.symbols.seek(function) for function in list(functions)]
        return any(answers)

    def _found_overloads(self, name: str) -> tuple[Function, ...]:
        functions = self.symbols.functions.get(name, [])
        defined = [function for function in functions if function.body is not None]
        if functions and not defined and self._sought(functions):
            functions = self.symbols.functions.get(name, [])
            defined = [function for function in functions if function.body is not None]
        return tuple(_with_defaults(defined, functions) if defined else functions)


def ends_of(names: Iterable[str]) -> frozenset[str]:
    """Return the last parts of qualified names."""
    return frozenset(name.rpartition("::")[2] for name in names)


def bound_overloads(
    functions: tuple[Function, ...], owner: Value, cls: ClassValue
) -> FunctionValue:
    """Return a method that may be one of several, bound to its owner."""
    return FunctionValue(functions[0], owner=owner, cls=cls, overloads=functions)


def _with_parameters(type: TypeRef, meant: Mapping[str, TypeRef]) -> TypeRef:
    """Return a type with the template parameter that it is, or begins with, replaced."""
    type = meant.get(type.name, type)
    head, _, rest = type.name.partition("::")
    if rest and head in meant:
        return TypeRef(f"{meant[head].name}::{rest}", type.args)
    return type


def template_types(
    definition: Function | Class, written: tuple[TypeRef, ...]
) -> dict[str, TypeRef]:
    """Return what template parameters mean: what is written, else their defaults."""
    if not definition.template and not definition.defaults:
        return {}
    return {**dict(definition.defaults), **dict(zip(definition.template, written, strict=False))}


def _with_defaults(defined: list[Function], all_: list[Function]) -> Iterator[Function]:
    """Yield the defined functions; default arguments stand where they are declared."""
    for function in defined:
        alike = [
            other
            for other in all_
            if other.body is None and len(other.params) == len(function.params)
        ]
        source = next((o for o in alike if any(p.default is not None for p in o.params)), None)
        yield _defaulted(function, source) if source is not None else function


def _defaulted(function: Function, declared: Function) -> Function:
    params = tuple(
        replace(param, default=param.default or other.default)
        for param, other in zip(function.params, declared.params, strict=True)
    )
    return replace(function, params=params)
