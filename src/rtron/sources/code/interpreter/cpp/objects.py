"""Making C++ objects: of library classes, and of scanned ones, bases and members first."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from rtron.sources.code import ir
from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.cpp.braces import construct_braced, is_braces, type_of_target
from rtron.sources.code.interpreter.cpp.calls import CppCalls
from rtron.sources.code.interpreter.cpp.iterators import ITERATOR, dereference, is_end
from rtron.sources.code.interpreter.cpp.overload_resolution import choose_overload
from rtron.sources.code.interpreter.cpp.symbol_table import MODELLED_FOLDERS
from rtron.sources.code.interpreter.cpp.types import template_types
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.assignment import slot_of
from rtron.sources.code.interpreter.execution.calls import note_passed_handle
from rtron.sources.code.interpreter.execution.source_provider import PluginSource
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame
from rtron.sources.code.library_models.common.containers import copy_instance

_MAX_DEPTH = 24
_MAX_RECURSION = 3


@dataclass(eq=False, slots=True, kw_only=True)
class CppObjects(CppCalls):
    """The objects of one program."""

    _construction_stack: list[str] = field(default_factory=list)

    def new(self, node: ir.New, frame: StackFrame) -> av.Value:
        """Make an object of a type."""
        arguments = self._evaluate_arguments(node, frame)
        given = arguments.values
        if node.braced and given and not _is_range_or_copy(node, given):
            by_name = isinstance(node.args[0], ir.MappingExpr)
            value = given[0] if by_name else av.list_of(given, ir.BRACES)
            if self.class_of(node.type, frame) is not None:
                return construct_braced(self.machine, node.type, value, arguments)
        return self.construct(node.type, arguments)

    def convert_braces(
        self, type: ir.TypeRef | None, value: av.Value, frame: StackFrame
    ) -> av.Value:
        """Return what braces make of a type."""
        return construct_braced(self.machine, type, value, Arguments(frame=frame))

    def braces_for(self, target: ir.Expr, value: av.Value, frame: StackFrame) -> av.Value:
        """Return what braces make that are assigned."""
        return self.convert_braces(type_of_target(self.machine, target, frame), value, frame)

    def construct(self, type: ir.TypeRef, arguments: Arguments) -> av.Value:
        """Make an object of a type from values."""
        frame = arguments.frame
        found = self.class_of(type, frame)
        resolved = self.resolve_type(type, frame)
        if isinstance(found, av.ClassValue):
            return self.construct_instance(found, arguments, resolved.args)
        if found is not None and found.construct is not None:
            typed = Arguments(
                values=arguments.values,
                slots=arguments.slots,
                types=resolved.args,
                line=arguments.line,
                frame=frame,
            )
            return found.construct(self.machine, typed)
        self.machine.escape_arguments(arguments)
        if found is not None:
            return av.Instance(found, {}, resolved.args)
        note_passed_handle(self.machine, resolved.name, arguments)
        return av.Unknown(resolved.name, type=resolved)

    def instantiate(self, called: av.Value, arguments: Arguments) -> av.Value:
        """Make an object of a scanned class: bases, members, then its constructor."""
        if isinstance(called, av.ClassValue):
            return self.construct_instance(called, arguments, arguments.types)
        return av.Unknown("object")

    def create_plugin(self, name: str, base: str, arguments: Arguments) -> av.Value | None:
        """Make the object of a plugin, its library's sources taken in first."""
        found = self.files.find_plugin(name, base)
        if found is None:
            return None
        cls = self._load_plugin_class(found)
        return self.construct_instance(cls, arguments.with_values(), ()) if cls else None

    def missing_package(self, name: str) -> str:
        """Return the package that has what is called by a name, if it tells and is not here."""
        first, _, rest = name.partition("::")
        is_known = first in MODELLED_FOLDERS or self.files.package_path(first) is not None
        return first if rest and not is_known else ""

    def load_functions(self, sources: tuple[Path, ...], name: str) -> tuple[ir.Function, ...]:
        """Take in sources, and return the functions of a name that they define."""
        for source in sources:
            self.symbols.load(source)
        ours = set(map(str, sources))
        return tuple(f for f in self.symbols.functions.get(name, ()) if f.file in ours)

    def _load_plugin_class(self, found: PluginSource) -> av.ClassValue | None:
        """Take in a plugin's sources: those that name its class, the others only if need be."""
        plain = found.class_name.partition("<")[0].rpartition("::")[2]
        for source in self.files.sources_containing(found.sources, plain):
            self.symbols.load(source)
        cls = self._class_by_alias(found.class_name)
        for source in found.sources if cls is None else ():
            self.symbols.load(source)
        return cls or self._class_by_alias(found.class_name)

    def _class_by_alias(self, name: str) -> av.ClassValue | None:
        """Return a class by its name, `using Plugin = Template<T>` followed."""
        found = self.class_of(ir.TypeRef(name.partition("<")[0].strip()), StackFrame(file=""))
        return found if isinstance(found, av.ClassValue) else None

    def default_value(
        self, type: ir.TypeRef | None, frame: StackFrame, *, pointer: bool = False, line: int = 0
    ) -> av.Value:
        """Return what a variable without an initialiser holds."""
        if type is None or pointer:
            return av.NONE if pointer else av.UNKNOWN
        found = self.class_of(type, frame)
        if found is None:
            return av.Unknown(type.name.rpartition("::")[2], type=self.resolve_type(type, frame))
        return self.construct(type, Arguments(line=line, frame=frame))

    def initial_value(self, node: ir.Declare, frame: StackFrame) -> av.Value:
        """Return what a variable or member begins with."""
        if node.value is None:
            return self.default_value(node.type, frame, pointer=node.pointer, line=node.line)
        value = self.machine.evaluate(node.value, frame)
        if isinstance(node.value, ir.Name):
            value = dereference(value)
        if node.type is not None and not node.pointer and is_braces(value):
            at = Arguments(line=node.line, frame=frame)
            return construct_braced(self.machine, node.type, value, at)
        if node.type is not None and not (
            node.pointer or node.reference or _is_temporary(node.value)
        ):
            return copy_instance(value)
        return value

    def construct_instance(
        self, cls: av.ClassValue, arguments: Arguments, types: tuple[ir.TypeRef, ...]
    ) -> av.Instance:
        """Return an object of a scanned class, made from values, or as a copy of another one."""
        copied = copy_instance(arguments.value(0)) if self._is_copy(cls, arguments) else None
        if isinstance(copied, av.Instance):
            return copied
        made = av.Instance(cls, {}, types)
        self.machine.instances.append(made)
        self._run_class_part(made, cls, arguments)
        return made

    def _is_copy(self, cls: av.ClassValue, arguments: Arguments) -> bool:
        """Tell whether an object is made of one of its class, which has no constructor for that."""
        given = len(arguments.values) == 1 and _is_instance_of(arguments.values[0], cls.name)
        declared = (f.params[0].type for f in self.overloads(cls.constructor) if f.params)
        return given and not any(type and _is_named(type, cls.name) for type in declared)

    def _run_class_part(
        self,
        made: av.Instance,
        cls: av.ClassValue,
        arguments: Arguments,
        candidates: tuple[ir.Function, ...] = (),
    ) -> None:
        """Run one class's part of making an object; `candidates` are its constructors.

        A class that holds or extends itself is made a few times only.
        """
        if (
            len(self._construction_stack) >= _MAX_DEPTH
            or self._construction_stack.count(cls.name) >= _MAX_RECURSION
        ):
            self._note_unmade(cls, arguments)
            return
        self._construction_stack.append(cls.name)
        try:
            self._run_constructor(made, cls, arguments, candidates)
        finally:
            self._construction_stack.pop()

    def _note_unmade(self, cls: av.ClassValue, arguments: Arguments) -> None:
        """Note an object that is made within too many others, if to make it could join nodes."""
        made = self.overloads(cls.constructor)
        if any(self.machine.is_relevant(self.machine, function) for function in made):
            why = "is made within too many others, or within itself"
            self.machine.recorder.add_unresolved(cls.name, why, arguments.evidence)

    def _run_constructor(
        self,
        made: av.Instance,
        cls: av.ClassValue,
        arguments: Arguments,
        candidates: tuple[ir.Function, ...],
    ) -> None:
        self.machine.note_passed_functions(arguments)
        made.bindings.setdefault(cls.name, made.types)
        constructors = candidates or self.overloads(cls.constructor)
        if not constructors:
            self._initialise_members(made, cls, {}, self._class_frame(made, cls), arguments)
            self._initialise_aggregate(made, cls, arguments)
            return
        chosen = choose_overload(constructors, arguments)
        frame = self.call_frame(av.FunctionValue(chosen, owner=made, cls=cls), arguments)
        initialisers = dict(chosen.initialisers)
        own = next((key for key in initialisers if _is_delegation(key, cls)), None)
        if own is not None:
            self._delegate_constructor(
                made, cls, self._initialiser_arguments(initialisers[own], frame), chosen
            )
        else:
            self._initialise_members(made, cls, initialisers, frame)
        self.machine.run(chosen, frame)

    def _delegate_constructor(
        self, made: av.Instance, cls: av.ClassValue, arguments: Arguments, delegating: ir.Function
    ) -> None:
        """`Foo(int a) : Foo(a, 0)`: another constructor of the class runs first."""
        others = [f for f in self.overloads(cls.constructor) if f is not delegating]
        if others:
            self._run_class_part(made, cls, arguments, tuple(others))

    def _initialise_members(
        self,
        made: av.Instance,
        cls: av.ClassValue,
        initialisers: Mapping[str, tuple[object, ...]],
        frame: StackFrame,
        inherited: Arguments | None = None,
    ) -> None:
        """Make the bases and members; a class without constructors hands on what it is given."""
        for base, reference in zip(cls.bases, cls.definition.bases, strict=True):
            if isinstance(reference, ir.TypeRef):
                given = self._given_to_base(reference, base, initialisers, frame)
                if isinstance(base, (av.ClassValue, av.LibraryClass)):
                    made.bindings[base.name] = self.template_arguments(reference, frame)
                passed = inherited or self._initialiser_arguments(given, frame)
                self._initialise_base(made, base, passed)
        for member in cls.definition.fields:
            if not member.static:
                made.fields[member.name] = self._member_value(member, initialisers, frame)

    def _given_to_base(
        self,
        reference: ir.TypeRef,
        base: av.Value,
        initialisers: Mapping[str, tuple[object, ...]],
        frame: StackFrame,
    ) -> tuple[object, ...]:
        """Return what a base's constructor gets: by one of its names, or by what means the base."""
        given = _given_to_base(initialisers, reference.name)
        if given:
            return given
        named = (key for key in initialisers if self.class_of(ir.TypeRef(key), frame) is base)
        key = next(named, None)
        return initialisers[key] if key is not None else ()

    def _initialise_aggregate(
        self, made: av.Instance, cls: av.ClassValue, arguments: Arguments
    ) -> None:
        """`Point{1, 2}`, `Point{.y = 2}` of a class without constructors and bases."""
        if cls.bases:
            return
        frame = self._class_frame(made, cls)
        members = [member for member in cls.definition.fields if not member.static]
        given = dict(zip([member.name for member in members], arguments.values, strict=False))
        first = arguments.get(0)
        if isinstance(first, av.MapValue) and not first.iterates_pairs:
            given = first.fields
        for member in members:
            if member.name in given:
                value = self.convert_braces(member.type, given[member.name], frame)
                made.fields[member.name] = value

    def _initialiser_arguments(self, given: tuple[object, ...], frame: StackFrame) -> Arguments:
        line = frame.function.line if frame.function else 0
        args = given[0].items if given and isinstance(given[0], ir.SequenceExpr) else given
        return self._evaluate_arguments(ir.New(ir.TypeRef("base"), args, line), frame)  # type: ignore[arg-type]

    def _initialise_base(self, made: av.Instance, base: av.Value, arguments: Arguments) -> None:
        if isinstance(base, av.ClassValue):
            self._run_class_part(made, base, arguments)
        elif isinstance(base, av.LibraryClass) and base.construct is not None:
            typed = replace(arguments, types=made.bindings.get(base.name, ()))
            part = base.construct(self.machine, typed)
            made.fields.update(part.fields if isinstance(part, av.Instance) else {})

    def _member_value(
        self, member: ir.Declare, initialisers: Mapping[str, tuple[object, ...]], frame: StackFrame
    ) -> av.Value:
        if member.name not in initialisers:
            return self.initial_value(member, frame)
        given = initialisers[member.name]
        line = frame.function.line if frame.function else member.line
        braced = len(given) == 1 and isinstance(given[0], ir.SequenceExpr)
        args = given[0].items if braced and isinstance(given[0], ir.SequenceExpr) else given
        node = ir.New(member.type or ir.TypeRef("auto"), args, line, braced)  # type: ignore[arg-type]
        if member.pointer or member.reference or member.type is None:
            values = self._evaluate_arguments(node, frame).values
            return values[0] if values else av.NONE
        if len(args) == 1 and self.class_of(member.type, frame) is None:
            return self._evaluate_arguments(node, frame).values[0]
        return self.new(node, frame)

    def _class_frame(self, made: av.Instance, cls: av.ClassValue) -> StackFrame:
        written = made.bindings.get(cls.name, made.types)
        types = template_types(cls.definition, written)
        return StackFrame(file=cls.definition.file, scope=cls.name, this=made, cls=cls, types=types)

    def _evaluate_arguments(self, node: ir.New, frame: StackFrame) -> Arguments:
        values: list[av.Value] = []
        for arg in node.args:
            value = self.machine.evaluate(arg, frame)
            values.extend(av.items_of(value)[0] if isinstance(arg, ir.Star) else (value,))
        if not any(map(is_end, values)):
            values = [dereference(value) for value in values]
        slots = tuple([slot_of(self.machine, arg, frame) for arg in node.args])
        return Arguments(values=tuple(values), slots=slots, line=node.line, frame=frame)


def _is_instance_of(value: av.Value | None, name: str) -> bool:
    """Tell whether a value is an object of a scanned class of a plain name."""
    type = value.type if isinstance(value, av.Instance) else None
    return isinstance(type, av.ClassValue) and _is_named(type, name)


def _is_named(type: av.ClassValue | ir.TypeRef, name: str) -> bool:
    """Tell whether a class has a plain name."""
    return type.name.rpartition("::")[2] == name.rpartition("::")[2]


def _is_range_or_copy(node: ir.New, values: tuple[av.Value, ...]) -> bool:
    """`std::vector<T> v{other}` copies, `v{xs.begin(), xs.end()}` takes a range."""
    copies = len(values) == 1 and not isinstance(node.args[0], (ir.SequenceExpr, ir.MappingExpr))
    first = values[0] if values else None
    copied = copies and (
        isinstance(first, (av.ListValue, av.MapValue)) or _is_instance_of(first, node.type.name)
    )
    return copied or (isinstance(first, av.Instance) and first.type is ITERATOR)


def _is_delegation(name: str, cls: av.ClassValue) -> bool:
    """Tell whether an initialiser names the class itself: another constructor runs first."""
    full = f"::{cls.name}"
    constructor = full + full[full.rindex("::") :]
    return full.endswith(f"::{name}") or constructor.endswith(f"::{name}")


def _is_temporary(node: ir.Expr) -> bool:
    return isinstance(node, (ir.New, ir.Call))


def _given_to_base(initialisers: Mapping[str, tuple[object, ...]], name: str) -> tuple[object, ...]:
    """Return what a base gets, by any of its names: `B(x)`, `ns::B(x)`, and `B::B(x)` in itself."""
    plain = name.rpartition("::")[2]
    given = (args for key, args in initialisers.items() if key.rpartition("::")[2] == plain)
    return initialisers.get(name) or next(given, ())
