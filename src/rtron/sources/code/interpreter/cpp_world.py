"""C++'s names, types, objects and calls."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

from rtron.sources.code.interpreter.arguments import Arguments
from rtron.sources.code.interpreter.assignment import place_of
from rtron.sources.code.interpreter.binding import bind
from rtron.sources.code.interpreter.calling import dispatch
from rtron.sources.code.interpreter.files import Files
from rtron.sources.code.interpreter.frame import Frame, Place
from rtron.sources.code.interpreter.iterators import begin, end, item_at
from rtron.sources.code.interpreter.machine import Machine
from rtron.sources.code.interpreter.overloads import choose
from rtron.sources.code.interpreter.symbols import Symbols
from rtron.sources.code.interpreter.values import (
    NONE,
    ClassValue,
    Foreign,
    FunctionValue,
    Hole,
    Instance,
    Known,
    ListValue,
    MapValue,
    Native,
    NativeClass,
    Placeholder,
    Text,
    Value,
)
from rtron.sources.code.ir import (
    Call,
    Class,
    Declare,
    Define,
    Expr,
    Function,
    Import,
    Name,
    New,
    Param,
    TypeRef,
)
from rtron.sources.code.natives.cpp_std import CONSTANTS, PARAMETER_KIND, PLACEHOLDERS, kind_of
from rtron.sources.code.natives.containers import CPP_MAP, LIST, bound, copied
from rtron.sources.code.natives.messages import cpp_message, cpp_message_name
from rtron.sources.code.natives.strings import CPP_TEXT, text_method

_MAX_BASES = 32


@dataclass(eq=False, slots=True, kw_only=True)
class CppWorld:
    """One program: its symbols, and the libraries that RTron knows."""

    files: Files
    symbols: Symbols
    functions: Mapping[str, Native]
    native_classes: Mapping[str, NativeClass]
    machine: Machine = field(init=False)
    _classes: dict[str, ClassValue] = field(default_factory=dict)
    _globals: dict[str, Value] = field(default_factory=dict)

    by_reference = True

    def named(self, name: str) -> tuple[Function, ...]:
        """Return the functions whose last part is a name."""
        return self.symbols.named(name)

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
            for candidate in self.symbols.candidates(name, frame.scope):
                if candidate in self.symbols.variables:
                    return Place(self._globals, candidate)
        return Place(frame.variables, name)

    def attribute(self, owner: Value, name: str, types: tuple[TypeRef, ...]) -> Value | None:
        """Return a member, bound to its owner; through an iterator, of what it points at."""
        if isinstance(owner, Instance):
            target = item_at(owner)
            if target is not owner and not name.startswith("operator"):
                return self.attribute(target, name, types)
            return self._of_instance(owner, name, types)
        if name == "getType":
            return Native(name, kind_of, owner)
        if isinstance(owner, (ListValue, MapValue)):
            walk = {"begin": begin, "end": end, "cbegin": begin, "cend": end}.get(name)
            if walk is not None:
                return Native(name, walk, owner)
            return bound(LIST if isinstance(owner, ListValue) else CPP_MAP, owner, name)
        if isinstance(owner, Text) or (isinstance(owner, Known) and isinstance(owner.value, str)):
            return text_method(CPP_TEXT, owner, name)
        return None

    def new(self, node: New, frame: Frame) -> Value:
        """Make an object of a type."""
        arguments = self._arguments(node, frame)
        return self.make(node.type, arguments)

    def make(self, type: TypeRef, arguments: Arguments) -> Value:
        """Make an object of a type from values."""
        frame = arguments.frame
        found = self.class_of(type, frame)
        resolved = self.resolved(type, frame)
        if isinstance(found, ClassValue):
            return self._constructed(found, arguments, resolved.args)
        if found is not None and found.make is not None:
            typed = Arguments(
                values=arguments.values,
                places=arguments.places,
                types=resolved.args,
                line=arguments.line,
                frame=frame,
            )
            return found.make(self.machine, typed)
        for value in arguments.values:
            self.machine.escape(value)
        if found is not None:
            return Instance(found, {}, resolved.args)
        return Hole(resolved.name, type=resolved)

    def declare(self, node: Declare, frame: Frame) -> None:
        """Make a local variable."""
        if node.reference and node.value is not None:
            place = place_of(self.machine, node.value, frame)
            if place is not None and place.key in place.holder:
                frame.aliases[node.name] = place
                return
        frame.aliases.pop(node.name, None)
        self.machine.trail.set(frame.variables, node.name, self._initial(node, frame))

    def define(self, node: Define, frame: Frame) -> None:
        """C++ defines nothing while it runs."""
        raise NotImplementedError(node, frame)

    def import_(self, node: Import, frame: Frame) -> None:
        """C++ imports nothing while it runs."""
        raise NotImplementedError(node, frame)

    def frame(self, called: FunctionValue, arguments: Arguments) -> Frame:
        """Return the frame of a call: parameters bound, references to the caller's places."""
        function = called.function
        passed = _given(called, arguments)
        outer = called.closure
        frame = Frame(
            file=function.file,
            function=function,
            closure=outer if isinstance(outer, Frame) else None,
            this=called.owner if called.owner is not None else getattr(outer, "this", None),
            cls=called.cls,
            scope=getattr(outer, "scope", "") or function.name.rpartition("::")[0],
            types=self._bound_types(called, passed),
        )
        default = Frame(file=function.file, scope=frame.scope, this=frame.this, types=frame.types)
        frame.variables = bind(
            function.params, passed, lambda node: self.machine.evaluate(node, default)
        )
        for at, param in enumerate(function.params):
            place = passed.place(at)
            if param.reference and place is not None:
                frame.aliases[param.name] = place
            elif not param.reference and param.kind == "plain":
                value = frame.variables[param.name]
                frame.variables[param.name] = self._by_value(value, param, frame)
        return frame

    def _by_value(self, value: Value, param: Param, frame: Frame) -> Value:
        """Return what a parameter without & and * holds: a copy."""
        if isinstance(value, ListValue):
            return ListValue(dict(value.fields), value.kind)
        if isinstance(value, MapValue):
            return replace(value, fields=dict(value.fields))
        if isinstance(value, Instance) and isinstance(value.type, ClassValue) and param.type:
            if self.class_of(param.type, frame) is value.type:
                return copied(value)
        return value

    def instantiate(self, called: Value, arguments: Arguments) -> Value:
        """Make an object of a scanned class: bases, members, then its constructor."""
        if isinstance(called, ClassValue):
            return self._constructed(called, arguments, arguments.types)
        return Hole("object")

    def lineage(self, cls: Value) -> Iterator[Value]:
        """Yield a class and its bases, nearest first."""
        queue, seen = [cls], 0
        while queue and seen < _MAX_BASES:
            seen += 1
            current = queue.pop(0)
            yield current
            if isinstance(current, ClassValue):
                queue.extend(current.bases)

    def class_of(self, type: TypeRef, frame: Frame) -> ClassValue | NativeClass | None:
        """Return the class that a type means, scanned or native."""
        resolved = self.resolved(type, frame)
        if "::" in resolved.name and resolved.name in self.native_classes:
            return self.native_classes[resolved.name]
        definition = self.symbols.class_named(resolved.name, frame.scope)
        if definition is not None:
            return self._class(definition)
        for candidate in self.symbols.candidates(resolved.name, frame.scope):
            if candidate in self.native_classes:
                return self.native_classes[candidate]
        return None

    def resolved(self, type: TypeRef, frame: Frame) -> TypeRef:
        """Return a type with template parameters and typedefs followed."""
        type = frame.types.get(type.name, type)
        head, _, rest = type.name.partition("::")
        if rest and head in frame.types:
            type = TypeRef(f"{frame.types[head].name}::{rest}", type.args)
        found = self.symbols.type(type, frame.scope)
        return TypeRef(found.name, tuple(self.resolved(arg, frame) for arg in found.args))

    def class_named(self, name: str) -> ClassValue | None:
        """Return a scanned class by its qualified name."""
        definition = self.symbols.class_named(name, "")
        return self._class(definition) if definition is not None else None

    def method(self, cls: Value, name: str, owner: Value) -> Value | None:
        """Return the most derived method of a name, bound to its owner."""
        for ancestor in self.lineage(cls):
            if isinstance(ancestor, ClassValue):
                functions = self._overloads(f"{ancestor.name}::{name}")
                if functions:
                    return _bound_overloads(functions, owner, ancestor)
            elif isinstance(ancestor, NativeClass) and name in ancestor.methods:
                return Native(name, ancestor.methods[name], owner)
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

    def message_in(
        self, type: TypeRef | None, scope: str, types: Mapping[str, TypeRef]
    ) -> str:
        """Return the message that a parameter's type means where its function is written."""
        if type is None:
            return ""
        resolved = self.resolved(type, Frame(file="", scope=scope, types=types))
        name = cpp_message(resolved)
        package, _, plain = name.rpartition("/")
        if name and self.files.has_message(package, plain):
            return name
        return self._opened_message(plain or resolved.name.partition("::")[0]) or name

    def _opened_message(self, plain: str) -> str:
        """`using vector_map_msgs::PointArray`, `using namespace std_msgs` bring a plain name."""
        for using in self.symbols.usings:
            package, _, name = using.rpartition("::")
            for owner, what in ((package, name), (using, plain)):
                if what == plain and self.files.has_message(owner, cpp_message_name(plain)):
                    return f"{owner}/{cpp_message_name(plain)}"
        return ""

    def plugin(self, name: str, base: str, arguments: Arguments) -> Value | None:
        """Make the object of a plugin, its library's sources taken in first."""
        found = self.files.plugin(name, base)
        if found is None:
            return None
        for source in found.sources:
            self.symbols.load(source)
        cls = self.class_named(found.cls)
        return self._constructed(cls, Arguments(frame=arguments.frame), ()) if cls else None

    def _lines(self, owner: Instance) -> set[str]:
        return {cls.name for cls in self.lineage(owner.type) if isinstance(cls, ClassValue)}

    def default(
        self, type: TypeRef | None, frame: Frame, *, pointer: bool = False, line: int = 0
    ) -> Value:
        """Return what a variable without an initialiser holds."""
        if type is None or pointer:
            return NONE if pointer else Hole("?")
        found = self.class_of(type, frame)
        if found is None:
            return Hole(type.name.rpartition("::")[2], type=self.resolved(type, frame))
        return self.make(type, Arguments(line=line, frame=frame))

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
            return None
        functions = self._overloads(f"{definition.name}::{method}")
        if not functions:
            return None
        return _bound_overloads(functions, frame.this, self._class(definition))

    def _outer(self, name: Name, frame: Frame) -> Value:
        bound_type = frame.types.get(name.id)
        if bound_type is not None and bound_type.name.lstrip("-").isdigit():
            return Known(int(bound_type.name))
        if bound_type is not None:
            return self._type_value(bound_type, frame) or Hole(name.id)
        if name.id in CONSTANTS:
            return CONSTANTS[name.id]
        if "::" in name.id and name.id in self.functions:
            return self._native(name.id, name)
        for candidate in self.symbols.candidates(name.id, frame.scope):
            found = self._global(candidate, name)
            if found is not None:
                return found
        followed = self.resolved(TypeRef(name.id), frame).name
        if followed != name.id and "::" in followed:
            return self._global(followed, name) or self._made_by(name, frame)
        return self._made_by(name, frame)

    def _made_by(self, name: Name, frame: Frame) -> Value:
        if name.id in PLACEHOLDERS:
            return PLACEHOLDERS[name.id]
        if name.id.startswith(PARAMETER_KIND):
            return Known(name.id.removeprefix(PARAMETER_KIND))
        return self._type_value(TypeRef(name.id, name.types), frame) or Foreign(name.id)

    def _global(self, name: str, node: Name) -> Value | None:
        if name in self._globals:
            return self.machine.seen(name.rpartition("::")[2], self._globals[name])
        if name in self.symbols.variables:
            return self._initialised(name)
        if name in self.symbols.enums:
            value = self.symbols.enums[name]
            return Hole(name) if value is None else Known(value)
        functions = self._overloads(name)
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

    def _initialised(self, name: str) -> Value:
        declared, file = self.symbols.variables[name]
        scope = name.rpartition("::")[0]
        self._globals[name] = Hole(name)
        self._globals[name] = self._initial(declared, Frame(file=file, scope=scope))
        return self._globals[name]

    def _initial(self, node: Declare, frame: Frame) -> Value:
        if node.value is None:
            return self.default(node.type, frame, pointer=node.pointer, line=node.line)
        value = self.machine.evaluate(node.value, frame)
        if isinstance(node.value, Name):
            value = item_at(value)
        if node.type is not None and not node.pointer and isinstance(value, ListValue):
            return self._converted(node.type, value, node, frame)
        if node.type is not None and not (node.pointer or node.reference or _is_made(node.value)):
            return copied(value)
        return value

    def _converted(self, type: TypeRef, value: ListValue, node: Declare, frame: Frame) -> Value:
        """`std::map<…> m = {{"a", 1}}`: the list makes an object of the declared type."""
        found = self.class_of(type, frame)
        if isinstance(found, NativeClass) and found.make is not None:
            resolved = self.resolved(type, frame)
            arguments = Arguments(values=(value,), types=resolved.args, line=node.line, frame=frame)
            return found.make(self.machine, arguments)
        if isinstance(found, ClassValue):
            return self.make(type, Arguments(values=value.items, line=node.line, frame=frame))
        return value

    def _constructed(
        self, cls: ClassValue, arguments: Arguments, types: tuple[TypeRef, ...]
    ) -> Instance:
        made = Instance(cls, {}, types)
        self.machine.instances.append(made)
        self._construct(made, cls, arguments)
        return made

    def _construct(
        self,
        made: Instance,
        cls: ClassValue,
        arguments: Arguments,
        among: tuple[Function, ...] = (),
    ) -> None:
        """Run one class's part of making an object; `among` are its constructors to choose from."""
        made.bindings.setdefault(cls.name, made.types)
        plain = cls.name.rpartition("::")[2]
        constructors = among or self._overloads(f"{cls.name}::{plain}")
        if not constructors:
            self._members(made, cls, {}, self._class_frame(made, cls), arguments)
            self._aggregate(made, cls, arguments)
            return
        chosen = choose(constructors, arguments)
        frame = self.frame(FunctionValue(chosen, owner=made, cls=cls), arguments)
        initialisers = dict(chosen.initialisers)
        if plain in initialisers:
            self._delegated(made, cls, self._given_to(initialisers[plain], frame), chosen)
        else:
            self._members(made, cls, initialisers, frame)
        self.machine.run(chosen, frame)

    def _delegated(
        self, made: Instance, cls: ClassValue, arguments: Arguments, by: Function
    ) -> None:
        """`Foo(int a) : Foo(a, 0)`: another constructor of the class runs first."""
        plain = cls.name.rpartition("::")[2]
        others = [f for f in self._overloads(f"{cls.name}::{plain}") if f is not by]
        if others:
            self._construct(made, cls, arguments, tuple(others))

    def _members(
        self,
        made: Instance,
        cls: ClassValue,
        initialisers: Mapping[str, tuple[object, ...]],
        frame: Frame,
        inherited: Arguments | None = None,
    ) -> None:
        """Make the bases and members; a class without constructors hands on what it is given."""
        for base, reference in zip(cls.bases, cls.definition.bases, strict=True):
            if isinstance(reference, TypeRef):
                name = reference.name
                given = initialisers.get(name, initialisers.get(name.rpartition("::")[2], ()))
                made.bindings[base.name] = self.resolved(reference, frame).args
                self._base_part(made, base, inherited or self._given_to(given, frame))
        for member in cls.definition.fields:
            if not member.static:
                made.fields[member.name] = self._field(member, initialisers, frame)

    def _aggregate(self, made: Instance, cls: ClassValue, arguments: Arguments) -> None:
        """`Point{1, 2}` of a class without constructors and bases: its members, in order."""
        if not cls.bases:
            names = [member.name for member in cls.definition.fields if not member.static]
            made.fields.update(zip(names, arguments.values, strict=False))

    def _given_to(self, given: tuple[object, ...], frame: Frame) -> Arguments:
        line = frame.function.line if frame.function else 0
        return self._arguments(New(TypeRef("base"), given, line), frame)  # type: ignore[arg-type]

    def _base_part(self, made: Instance, base: Value, arguments: Arguments) -> None:
        if isinstance(base, ClassValue):
            self._construct(made, base, arguments)
        elif isinstance(base, NativeClass) and base.make is not None:
            part = base.make(self.machine, arguments)
            made.fields.update(part.fields if isinstance(part, Instance) else {})

    def _field(
        self, member: Declare, initialisers: Mapping[str, tuple[object, ...]], frame: Frame
    ) -> Value:
        if member.name not in initialisers:
            return self._initial(member, frame)
        given = initialisers[member.name]
        line = frame.function.line if frame.function else member.line
        node = New(member.type or TypeRef("auto"), given, line)  # type: ignore[arg-type]
        if member.pointer or member.reference or member.type is None:
            values = self._arguments(node, frame).values
            return values[0] if values else NONE
        arguments = self._arguments(node, frame)
        if len(arguments.values) == 1 and self.class_of(member.type, frame) is None:
            return arguments.values[0]
        return self.make(member.type, arguments)

    def _class_frame(self, made: Instance, cls: ClassValue) -> Frame:
        written = made.bindings.get(cls.name, made.types)
        types = template_types(cls.definition, written)
        return Frame(file=cls.definition.file, scope=cls.name, this=made, cls=cls, types=types)

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

    def _overloads(self, name: str) -> tuple[Function, ...]:
        functions = self.symbols.functions.get(name, [])
        defined = [function for function in functions if function.body is not None]
        return tuple(_with_defaults(defined, functions) if defined else functions)

    def _bound_types(self, called: FunctionValue, arguments: Arguments) -> Mapping[str, TypeRef]:
        """Bind template parameters: of the object's class, written out, or by the arguments."""
        function, types = called.function, dict(getattr(called.closure, "types", {}))
        types.update(self.types_of(called))
        written = called.types or arguments.types
        resolved = tuple(self.resolved(type, arguments.frame) for type in written)
        types.update(template_types(function, resolved))
        return types

    def types_of(self, called: FunctionValue) -> Mapping[str, TypeRef]:
        """Return what a method's template parameters, and those of its class, mean."""
        own = template_types(called.function, called.types)
        if not isinstance(called.owner, Instance) or called.cls is None:
            return own
        written = called.owner.bindings.get(called.cls.name, called.owner.types)
        return {**own, **template_types(called.cls.definition, written)}

    def _arguments(self, node: New, frame: Frame) -> Arguments:
        values = tuple(item_at(self.machine.evaluate(arg, frame)) for arg in node.args)
        places = tuple(place_of(self.machine, arg, frame) for arg in node.args)
        return Arguments(values=values, places=places, line=node.line, frame=frame)

    def _in_closure(self, name: str, frame: Frame) -> bool:
        return (
            name in frame.variables
            or name in frame.aliases
            or (frame.closure is not None and self._in_closure(name, frame.closure))
        )


def template_types(
    definition: Function | Class, written: tuple[TypeRef, ...]
) -> dict[str, TypeRef]:
    """Return what template parameters mean: what is written, else their defaults."""
    return {**dict(definition.defaults), **dict(zip(definition.template, written, strict=False))}


def _is_made(node: Expr) -> bool:
    return isinstance(node, (New, Call))


def _bound_overloads(
    functions: tuple[Function, ...], owner: Value, cls: ClassValue
) -> FunctionValue:
    return FunctionValue(functions[0], owner=owner, cls=cls, overloads=functions)


def _given(called: FunctionValue, arguments: Arguments) -> Arguments:
    """Return the arguments, what boost::bind gave put in their places."""
    if not called.given:
        return arguments
    left = list(arguments.values)
    values = [
        (left.pop(0) if left else Hole("?")) if isinstance(value, Placeholder) else value
        for value in called.given
    ]
    return Arguments(values=(*values, *left), line=arguments.line, frame=arguments.frame)


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
