"""Making C++ objects: of native classes, and of scanned ones, bases and members first."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    ClassValue,
    FunctionValue,
    Hole,
    Instance,
    ListValue,
    NativeClass,
    Value,
)
from rtron.sources.code.interpreter.cpp.calls import CppCalls
from rtron.sources.code.interpreter.cpp.iterators import item_at
from rtron.sources.code.interpreter.cpp.overload_resolution import choose
from rtron.sources.code.interpreter.cpp.types import template_types
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.assignment import place_of
from rtron.sources.code.interpreter.execution.calls import note_handed
from rtron.sources.code.interpreter.execution.source_provider import Plugin
from rtron.sources.code.interpreter.execution.stack_frame import Frame
from rtron.sources.code.ir import (
    Call,
    Declare,
    Expr,
    Function,
    Name,
    New,
    TypeRef,
)
from rtron.sources.code.library_models.common.containers import copied

_MAX_DEEP = 24
_MAX_SAME = 3


@dataclass(eq=False, slots=True, kw_only=True)
class CppObjects(CppCalls):
    """The objects of one program."""

    _making: list[str] = field(default_factory=list)

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
            return self.constructed(found, arguments, resolved.args)
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
        note_handed(self.machine, resolved.name, arguments)
        return Hole(resolved.name, type=resolved)

    def instantiate(self, called: Value, arguments: Arguments) -> Value:
        """Make an object of a scanned class: bases, members, then its constructor."""
        if isinstance(called, ClassValue):
            return self.constructed(called, arguments, arguments.types)
        return Hole("object")

    def plugin(self, name: str, base: str, arguments: Arguments) -> Value | None:
        """Make the object of a plugin, its library's sources taken in first."""
        found = self.files.plugin(name, base)
        if found is None:
            return None
        cls = self._taken_in(found)
        return self.constructed(cls, Arguments(frame=arguments.frame), ()) if cls else None

    def taken_in(self, sources: tuple[Path, ...], name: str) -> tuple[Function, ...]:
        """Take in sources, and return the functions of a name that they define."""
        for source in sources:
            self.symbols.load(source)
        ours = set(map(str, sources))
        return tuple(f for f in self.symbols.functions.get(name, ()) if f.file in ours)

    def _taken_in(self, found: Plugin) -> ClassValue | None:
        """Take in a plugin's sources: those that name its class, the others only if need be."""
        sources = found.sources
        if self.symbols.everywhere:
            sources = self.files.naming(sources, found.cls.partition("<")[0].rpartition("::")[2])
        for source in sources:
            self.symbols.load(source)
        cls = self._aliased_class(found.cls)
        for source in found.sources if cls is None else ():
            self.symbols.load(source)
        return cls or self._aliased_class(found.cls)

    def _aliased_class(self, name: str) -> ClassValue | None:
        """Return a class by its name, `using Plugin = Template<T>` followed."""
        found = self.class_of(TypeRef(name.partition("<")[0].strip()), Frame(file=""))
        return found if isinstance(found, ClassValue) else None

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

    def initial(self, node: Declare, frame: Frame) -> Value:
        """Return what a variable or member begins with."""
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

    def constructed(
        self, cls: ClassValue, arguments: Arguments, types: tuple[TypeRef, ...]
    ) -> Instance:
        """Return an object of a scanned class, made from values."""
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
        """Run one class's part of making an object; `among` are its constructors to choose from.

        A class that holds or extends itself is made a few times only.
        """
        if len(self._making) >= _MAX_DEEP or self._making.count(cls.name) >= _MAX_SAME:
            return
        self._making.append(cls.name)
        try:
            self._construct_by(made, cls, arguments, among)
        finally:
            self._making.pop()

    def _construct_by(
        self,
        made: Instance,
        cls: ClassValue,
        arguments: Arguments,
        among: tuple[Function, ...],
    ) -> None:
        self.machine.hand_on(arguments)
        made.bindings.setdefault(cls.name, made.types)
        plain = cls.name.rpartition("::")[2]
        constructors = among or self.overloads(f"{cls.name}::{plain}")
        if not constructors:
            self._members(made, cls, {}, self._class_frame(made, cls), arguments)
            self._aggregate(made, cls, arguments)
            return
        chosen = choose(constructors, arguments)
        frame = self.frame(FunctionValue(chosen, owner=made, cls=cls), arguments)
        initialisers = dict(chosen.initialisers)
        own = next((key for key in initialisers if _is_own(key, cls)), None)
        if own is not None:
            self._delegated(made, cls, self._given_to(initialisers[own], frame), chosen)
        else:
            self._members(made, cls, initialisers, frame)
        self.machine.run(chosen, frame)

    def _delegated(
        self, made: Instance, cls: ClassValue, arguments: Arguments, by: Function
    ) -> None:
        """`Foo(int a) : Foo(a, 0)`: another constructor of the class runs first."""
        plain = cls.name.rpartition("::")[2]
        others = [f for f in self.overloads(f"{cls.name}::{plain}") if f is not by]
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
                if isinstance(base, (ClassValue, NativeClass)):
                    made.bindings[base.name] = self.written_args(reference, frame)
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
            return self.initial(member, frame)
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

    def _arguments(self, node: New, frame: Frame) -> Arguments:
        values = tuple([item_at(self.machine.evaluate(arg, frame)) for arg in node.args])
        places = tuple([place_of(self.machine, arg, frame) for arg in node.args])
        return Arguments(values=values, places=places, line=node.line, frame=frame)


def _is_own(name: str, cls: ClassValue) -> bool:
    """Tell whether an initialiser names the class itself: another constructor runs first."""
    return f"::{cls.name}".endswith(f"::{name}")


def _is_made(node: Expr) -> bool:
    return isinstance(node, (New, Call))
