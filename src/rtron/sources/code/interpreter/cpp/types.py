"""C++'s types and classes: what a name of a type means, and the methods of a class."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from rtron.sources.code import ir
from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.cpp.symbol_table import SymbolTable
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.source_provider import SourceProvider
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame
from rtron.sources.code.library_models.common.message_types import (
    INTERFACE_FOLDERS,
    cpp_message_name,
    cpp_message_type,
    message_header,
)

POINTER_ALIASES = frozenset(
    [*("SharedPtr", "ConstSharedPtr", "WeakPtr", "ConstWeakPtr", "UniquePtr"), "SharedConstPtr"]
)
"""What rclcpp's classes call pointers to themselves (rclcpp/macros.hpp)."""
_MESSAGE_POINTERS = frozenset(["shared_ptr", "unique_ptr", "LoanedMessage"])
_MAX_BASES = 32


class _ScannedMethod(NamedTuple):
    """A method that the source defines, and the class that has it."""

    functions: tuple[ir.Function, ...]
    cls: av.ClassValue


class _LibraryMethod(NamedTuple):
    """A method of a library's class."""

    call: Callable[..., av.Value]


@dataclass(eq=False, slots=True, kw_only=True)
class CppTypes:
    """The types of one program: its symbols, and the classes of the libraries that RTron knows."""

    files: SourceProvider
    symbols: SymbolTable
    library_classes: Mapping[str, av.LibraryClass]
    _unqualified_classes: frozenset[str] = field(default=frozenset(), init=False)
    _classes: dict[str, av.ClassValue] = field(default_factory=dict)
    _class_cache: dict[tuple[str, str], av.ClassValue | av.LibraryClass | None] = field(init=False)
    _overload_cache: dict[str, tuple[ir.Function, ...]] = field(init=False)
    _method_cache: dict[tuple[str, str], _ScannedMethod | _LibraryMethod | None] = field(init=False)

    def __post_init__(self) -> None:
        """Note the last parts of the library classes' names: most types are none of them."""
        self._unqualified_classes = unqualified_names(self.library_classes)
        self._class_cache = self.symbols.new_cache()
        self._overload_cache = self.symbols.new_cache()
        self._method_cache = self.symbols.new_cache()

    def version(self) -> int:
        """Return a number that changes when the program's functions do."""
        return self.symbols.version

    def program_functions(self) -> Iterator[tuple[str, ir.Function]]:
        """Yield the functions of the program's sources and its package's headers, with names."""
        for functions in self.symbols.functions.values():
            yield from ((f.name, f) for f in functions if self.symbols.is_program_file(f.file))

    def functions_named(self, name: str) -> tuple[ir.Function, ...]:
        """Return the functions whose last part is a name."""
        return self.symbols.functions_named(name)

    def lineage(self, cls: av.Value) -> Iterator[av.Value]:
        """Yield a class and its bases, nearest first."""
        queue, seen = [cls], 0
        while queue and seen < _MAX_BASES:
            seen += 1
            current = queue.pop(0)
            yield current
            if isinstance(current, av.ClassValue):
                queue.extend(current.bases)

    def has_constant_member(self, name: str, cls: av.Value) -> bool:
        """Tell whether the data members that a class and its bases have of a name are constant."""
        lineage = [one.definition for one in self.lineage(cls) if isinstance(one, av.ClassValue)]
        found = [member for one in lineage for member in one.fields if member.name == name]
        return bool(found) and all(member.constant for member in found)

    def class_of(
        self, type: ir.TypeRef, frame: StackFrame
    ) -> av.ClassValue | av.LibraryClass | None:
        """Return the class that a type means, scanned or of a library."""
        resolved = self.resolve_type(type, frame)
        key = resolved.name, frame.scope
        if key not in self._class_cache:
            self._class_cache[key] = self._find_class(resolved, frame)
        found = self._class_cache[key]
        if isinstance(found, av.ClassValue) and found.name in self.symbols.specialisations:
            return self._specialisation(found, resolved, frame)
        return found

    def _specialisation(
        self, cls: av.ClassValue, written: ir.TypeRef, frame: StackFrame
    ) -> av.ClassValue:
        """Return the class that a template is specialised as for these arguments."""
        given = tuple(self.qualified_type(arg, frame) for arg in written.args)
        for one in self.symbols.specialisations[cls.name]:
            around = StackFrame(file=one.file, scope=one.name.rpartition("::")[0])
            if tuple(self.qualified_type(arg, around) for arg in one.specialised) == given:
                return self._class_value(one)
        return cls

    def _find_class(
        self, resolved: ir.TypeRef, frame: StackFrame
    ) -> av.ClassValue | av.LibraryClass | None:
        library = self.library_classes.get(resolved.name) if "::" in resolved.name else None
        if library is not None and library.over_source:
            return library
        definition = self.symbols.class_named(resolved.name, frame.scope)
        if definition is not None:
            return self._class_value(definition)
        plain = resolved.name.rpartition("::")[2]
        if plain in self._unqualified_classes:
            for candidate in self.symbols.candidates(resolved.name, frame.scope):
                if candidate in self.library_classes:
                    return self.library_classes[candidate]
        is_pointer = plain in POINTER_ALIASES
        return self.library_classes["std::shared_ptr"] if is_pointer else None

    def resolve_type(self, type: ir.TypeRef, frame: StackFrame) -> ir.TypeRef:
        """Return a type with template parameters and typedefs followed."""
        if frame.types:
            type = _substitute_parameters(type, frame.types)
        found = self.symbols.resolve_type(type, frame.scope)
        if not found.args:
            return found
        return ir.TypeRef(found.name, tuple([self.resolve_type(arg, frame) for arg in found.args]))

    def template_arguments(self, type: ir.TypeRef, frame: StackFrame) -> tuple[ir.TypeRef, ...]:
        """Return the template arguments of a type, classes by the names they have everywhere."""
        return tuple(
            self._qualified_type(arg, frame) for arg in self.resolve_type(type, frame).args
        )

    def qualified_type(self, type: ir.TypeRef, frame: StackFrame) -> ir.TypeRef:
        """Return a type by the names that it and its arguments have everywhere."""
        found = self._qualified_type(self.resolve_type(type, frame), frame)
        return ir.TypeRef(found.name, tuple(self.qualified_type(arg, frame) for arg in found.args))

    def takes_initialiser_list(self, cls: av.ClassValue) -> bool:
        """Tell whether a constructor of a class takes what stands in braces as one list."""
        first = [f.params[0].type for f in self.overloads(cls.constructor) if f.params]
        return any(type and type.name.endswith("initializer_list") for type in first)

    def _qualified_type(self, type: ir.TypeRef, frame: StackFrame) -> ir.TypeRef:
        found = self.symbols.class_named(type.name, frame.scope)
        return type if found is None else ir.TypeRef(found.name, type.args)

    def class_named(self, name: str) -> av.ClassValue | None:
        """Return a scanned class by its qualified name."""
        definition = self.symbols.class_named(name, "")
        return self._class_value(definition) if definition is not None else None

    def bound_method(self, cls: av.Value, name: str, owner: av.Value) -> av.Value | None:
        """Return the most derived method of a name, bound to its owner."""
        if isinstance(cls, av.LibraryClass):
            return (
                av.LibraryFunction(name, cls.methods[name], owner) if name in cls.methods else None
            )
        found = self._find_cached_method(cls, name) if isinstance(cls, av.ClassValue) else None
        if isinstance(found, _ScannedMethod):
            return bound_overloads(found.functions, owner, found.cls)
        return av.LibraryFunction(name, found.call, owner) if found is not None else None

    def _find_cached_method(
        self, cls: av.ClassValue, name: str
    ) -> _ScannedMethod | _LibraryMethod | None:
        """Return the most derived method of a name; what was found holds until a file comes."""
        key = cls.name, name
        if key not in self._method_cache:
            self._method_cache[key] = self._find_method(cls, name)
        return self._method_cache[key]

    def _find_method(self, cls: av.ClassValue, name: str) -> _ScannedMethod | _LibraryMethod | None:
        for ancestor in self.lineage(cls):
            if isinstance(ancestor, av.ClassValue):
                functions = self.overloads(f"{ancestor.name}::{name}")
                if functions:
                    return _ScannedMethod(functions, ancestor)
            elif isinstance(ancestor, av.LibraryClass) and name in ancestor.methods:
                return _LibraryMethod(ancestor.methods[name])
        return None

    def method_names(self, definition: ir.Class) -> list[str]:
        """Return the names of the methods that a class defines itself."""
        return self.symbols.method_names(definition.name)

    def bind_method(self, called: av.FunctionValue, owner: av.Instance) -> av.FunctionValue:
        """Return a method named by `&Class::method`, bound to an object of that class."""
        cls, _, name = called.function.name.rpartition("::")
        if not cls or called.function.static or cls not in self.ancestor_names(owner):
            return called
        found = self.bound_method(owner.type, name, owner)
        return found if isinstance(found, av.FunctionValue) else called

    def message_type(
        self, type: ir.TypeRef | None, scope: str, types: Mapping[str, ir.TypeRef]
    ) -> str:
        """Return the message that a parameter's type means where its function is written."""
        if type is None:
            return ""
        resolved = self.resolve_type(type, StackFrame(file="", scope=scope, types=types))
        resolved = self._adapter_message(resolved, scope)
        name = cpp_message_type(resolved)
        package, _, plain = name.rpartition("/")
        if name and self.files.has_message_type(package, plain):
            return name
        written = name.replace("/", "::") or resolved.name.partition("::")[0]
        return self._message_in_scope(written, scope) or name

    def _adapter_message(self, type: ir.TypeRef, scope: str) -> ir.TypeRef:
        """Return the message that a type adapter, or a type that has one, is sent as (REP 2007)."""
        if type.args and type.name.endswith(("rclcpp::TypeAdapter", "rclcpp::adapt_type::as")):
            return type.args[-1]
        if type.args and type.name.rpartition("::")[2] in _MESSAGE_POINTERS:
            return replace(type, args=(self._adapter_message(type.args[0], scope), *type.args[1:]))
        definition = self.symbols.class_named(type.name, scope)
        full = replace(type, name=definition.name) if definition is not None else type
        return self.symbols.aliases.get(ir.adapter_alias(str(full)), type)

    def _message_in_scope(self, written: str, scope: str) -> str:
        """Return the message that a name means in a namespace, or by `using` (`msg::String`)."""
        for candidate in self.symbols.candidates(written, scope):
            space, _, plain = candidate.rpartition("::")
            named = candidate in self.symbols.usings
            found = self._message_in_namespace(space, plain, named=named)
            if found:
                return found
        return ""

    def _has_message(self, package: str, folder: str, name: str) -> bool:
        """Tell whether a package defines a type, or the program includes the header of one."""
        header = message_header(package, folder, name)
        return bool(self.files.has_message_type(package, name)) or header in self.symbols.headers

    def _message_in_namespace(self, space: str, plain: str, *, named: bool) -> str:
        """Return the message of a namespace, `std_msgs::msg` or `std_msgs`, if it has one."""
        package, _, folder = space.partition("::")
        if folder in INTERFACE_FOLDERS:
            is_message = named or self._has_message(package, folder, plain)
            return f"{package}/{folder}/{plain}" if is_message else ""
        name = cpp_message_name(plain)
        return f"{space}/{name}" if self._has_message(space, "", name) else ""

    def template_bindings(self, called: av.FunctionValue) -> Mapping[str, ir.TypeRef]:
        """Return what a method's template parameters, and those of its class, mean."""
        own = template_types(called.function, called.types)
        if not isinstance(called.owner, av.Instance) or called.cls is None:
            return own
        written = called.owner.bindings.get(called.cls.name, called.owner.types)
        return {**own, **template_types(called.cls.definition, written)}

    def bind_template_parameters(
        self, called: av.FunctionValue, arguments: Arguments
    ) -> Mapping[str, ir.TypeRef]:
        """Bind template parameters: of the object's class, written out, or by the arguments."""
        function, types = called.function, dict(getattr(called.closure, "types", {}))
        types.update(self.template_bindings(called))
        written = called.types or arguments.types
        resolved = tuple(self.resolve_type(type, arguments.frame) for type in written)
        types.update(template_types(function, resolved))
        return types

    def ancestor_names(self, owner: av.Instance) -> set[str]:
        """Return the names of an object's class and its bases."""
        return {cls.name for cls in self.lineage(owner.type) if isinstance(cls, av.ClassValue)}

    def _class_value(self, definition: ir.Class) -> av.ClassValue:
        if definition.name not in self._classes:
            made = av.ClassValue(definition)
            self._classes[definition.name] = made
            frame = StackFrame(file=definition.file, scope=definition.name.rpartition("::")[0])
            made.bases = tuple(
                self.class_of(base, frame) or av.ExternalSymbol(base.name)
                for base in definition.bases
                if isinstance(base, ir.TypeRef)
            )
        return self._classes[definition.name]

    def overloads(self, name: str) -> tuple[ir.Function, ...]:
        """Return the functions of a qualified name, those with a body if there are any."""
        known = self._overload_cache.get(name)
        if known is None:
            known = self._overload_cache[name] = self._find_overloads(name)
        return known

    def _load_definitions(self, functions: list[ir.Function]) -> bool:
        """Look for the definitions of functions that are only declared so far."""
        answers = [self.symbols.load_definition(function) for function in list(functions)]
        return any(answers)

    def _find_overloads(self, name: str) -> tuple[ir.Function, ...]:
        functions = self.symbols.functions.get(name, [])
        defined = [function for function in functions if function.body is not None]
        if functions and not defined and self._load_definitions(functions):
            functions = self.symbols.functions.get(name, [])
            defined = [function for function in functions if function.body is not None]
        return tuple(_with_default_arguments(defined, functions) if defined else functions)


def unqualified_names(names: Iterable[str]) -> frozenset[str]:
    """Return the last parts of qualified names."""
    return frozenset(name.rpartition("::")[2] for name in names)


def bound_overloads(
    functions: tuple[ir.Function, ...], owner: av.Value, cls: av.ClassValue
) -> av.FunctionValue:
    """Return a method that may be one of several, bound to its owner."""
    return av.FunctionValue(functions[0], owner=owner, cls=cls, overloads=functions)


def _substitute_parameters(type: ir.TypeRef, bindings: Mapping[str, ir.TypeRef]) -> ir.TypeRef:
    """Return a type with the template parameter that it is, or begins with, replaced."""
    type = bindings.get(type.name, type)
    head, _, rest = type.name.partition("::")
    if rest and head in bindings:
        return ir.TypeRef(f"{bindings[head].name}::{rest}", type.args)
    return type


def template_types(
    definition: ir.Function | ir.Class, written: tuple[ir.TypeRef, ...]
) -> dict[str, ir.TypeRef]:
    """Return what template parameters mean: what is written, else their defaults."""
    if not definition.template and not definition.defaults:
        return {}
    return {**dict(definition.defaults), **dict(zip(definition.template, written, strict=False))}


def _with_default_arguments(
    defined: list[ir.Function], all_: list[ir.Function]
) -> Iterator[ir.Function]:
    """Yield the defined functions; default arguments stand where they are declared."""
    for function in defined:
        alike = [
            other
            for other in all_
            if other.body is None and len(other.params) == len(function.params)
        ]
        source = next((o for o in alike if any(p.default is not None for p in o.params)), None)
        yield _merge_defaults(function, source) if source is not None else function


def _merge_defaults(function: ir.Function, declared: ir.Function) -> ir.Function:
    params = tuple(
        replace(param, default=param.default or other.default)
        for param, other in zip(function.params, declared.params, strict=True)
    )
    return replace(function, params=params)
