"""Python's names, modules, classes and calls."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

from rtron.sources.code.interpreter.arguments import Arguments, NativeCall
from rtron.sources.code.interpreter.binding import bind, defaults
from rtron.sources.code.interpreter.calling import dispatch
from rtron.sources.code.interpreter.files import Files
from rtron.sources.code.interpreter.frame import Frame, Place
from rtron.sources.code.interpreter.machine import Machine
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
    ModuleValue,
    Native,
    NativeClass,
    Text,
    Value,
    options,
)
from rtron.sources.code.ir import (
    Assign,
    Class,
    Declare,
    Define,
    Function,
    Import,
    Lambda,
    Name,
    New,
    TypeRef,
    Unit,
)
from rtron.sources.code.natives.containers import LIST, PYTHON_MAP, bound
from rtron.sources.code.natives.enums import ENUM, member, with_members
from rtron.sources.code.natives.messages import is_message_package, message_type
from rtron.sources.code.natives.strings import PYTHON_TEXT, text_method

_MAX_BASES = 32


@dataclass(eq=False, slots=True, kw_only=True)
class PythonWorld:
    """The modules of one program; `natives` are the libraries that RTron knows."""

    files: Files
    natives: Mapping[str, Value]
    builtins: Mapping[str, Value]
    machine: Machine = field(init=False)
    _modules: dict[Path, ModuleValue] = field(default_factory=dict)
    _stars: dict[int, list[str]] = field(default_factory=dict)
    _named: dict[str, list[Function]] = field(default_factory=dict)

    by_reference = False

    def run(self, path: Path, name: str) -> ModuleValue:
        """Run a file's top level as the module `name`."""
        unit = self.files.unit(path)
        module = ModuleValue(name, file=unit.file)
        self._modules[path] = module
        frame = Frame(file=unit.file, variables=module.fields)
        frame.variables.update(__name__=Known(name), __file__=Known(str(path)))
        self._note(unit, path)
        self.machine.execute(unit.body, frame)
        return module

    def named(self, name: str) -> tuple[Function, ...]:
        """Return the functions with a name, in the modules that were loaded."""
        return tuple(self._named.get(name, ()))

    def lookup(self, name: Name, frame: Frame) -> Value:
        """Return what a name means: local, enclosing, of the module, built in."""
        around: Frame | None = frame
        while around is not None:
            if name.id in around.variables:
                found: Value = around.variables[name.id]
                return self.machine.seen(name.id, found) if around.closure is None else found
            root, around = around, around.closure
        if name.id in self.builtins:
            return self.builtins[name.id]
        return self._starred(name.id, root) or Hole(name.id)

    def place(self, name: str, frame: Frame) -> Place:
        """Return where an assignment to a name goes."""
        if name in frame.globals:
            around = frame
            while around.closure is not None:
                around = around.closure
                if name in around.variables:
                    break
            return Place(around.variables, name)
        return Place(frame.variables, name)

    def attribute(self, owner: Value, name: str, types: tuple[TypeRef, ...]) -> Value | None:
        """Return a member, bound to its owner."""
        del types
        if isinstance(owner, Instance):
            return self._of_instance(owner, name)
        if isinstance(owner, (ClassValue, NativeClass)):
            return _of_no_instance(owner, self._of_class(owner, name))
        if isinstance(owner, ModuleValue):
            return owner.fields.get(name) or self._submodule(owner, name)
        if isinstance(owner, Foreign):
            return self._foreign(f"{owner.name}.{name}")
        if isinstance(owner, Native):
            return self.natives.get(f"{owner.name}.{name}")
        if isinstance(owner, ListValue):
            return bound(LIST, owner, name)
        if isinstance(owner, MapValue):
            return bound(PYTHON_MAP, owner, name)
        if isinstance(owner, Text) or (isinstance(owner, Known) and isinstance(owner.value, str)):
            return text_method(PYTHON_TEXT, owner, name)
        return None

    def method_names(self, definition: Class) -> list[str]:
        """Return the names of the methods that a class defines itself."""
        return [f.name for f in functions_in(definition.body)]

    def new(self, node: New, frame: Frame) -> Value:
        """Python has no `new`."""
        raise NotImplementedError(node, frame)

    def declare(self, node: Declare, frame: Frame) -> None:
        """Python has no declarations."""
        raise NotImplementedError(node, frame)

    def define(self, node: Define, frame: Frame) -> None:
        """Bind a function or class by its name, under its decorators."""
        if isinstance(node.what, Class):
            value: Value = self._class(node.what, frame)
        else:
            named = defaults(node.what, lambda default: self.machine.evaluate(default, frame))
            value = FunctionValue(node.what, closure=frame, named=named)
        for decorator in reversed(node.decorators):
            value = self._decorated(self.machine.evaluate(decorator, frame), value, frame)
        self.machine.trail.set(*self.place(node.what.name, frame), value)

    def import_(self, node: Import, frame: Frame) -> None:
        """Bind what an import brings: a scanned module, or a library by its name."""
        module = self._module(_absolute(node), Path(frame.file))
        if node.name == "*":
            self._import_all(module, frame)
            return
        alias = node.alias or node.name or node.module.partition(".")[0]
        if node.name is None:
            value = module if node.alias else self._module(alias, Path(frame.file))
        else:
            value = self.attribute(module, node.name, ()) or Foreign(f"{node.module}.{node.name}")
        self.machine.trail.set(frame.variables, alias, value)

    def frame(self, called: FunctionValue, arguments: Arguments) -> Frame:
        """Return the frame of a call."""
        given = called.given if called.owner is None else (called.owner, *called.given)
        passed = Arguments(
            values=(*given, *arguments.values),
            keywords={**called.named, **arguments.keywords},
            line=arguments.line,
            frame=arguments.frame,
        )
        closure = called.closure or arguments.frame
        variables = bind(
            called.function.params, passed, lambda node: self.machine.evaluate(node, closure)
        )
        return Frame(
            file=called.function.file,
            function=called.function,
            variables=variables,
            closure=closure,
            cls=called.cls,
        )

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
        """Yield a class and its bases, nearest first."""
        queue, seen = [cls], 0
        while queue and seen < _MAX_BASES:
            seen += 1
            current = queue.pop(0)
            yield current
            if isinstance(current, ClassValue):
                queue.extend(base for bases in current.bases for base in options(bases))

    def _of_instance(self, owner: Instance, name: str) -> Value | None:
        if name in owner.fields:
            return self.machine.seen(name, owner.fields[name])
        if isinstance(owner.type, NativeClass):
            call = owner.type.methods.get(name)
            return Native(name, call, owner) if call else None
        found = self._of_class(owner.type, name)
        if isinstance(found, Instance) and found.type is PROPERTY:
            getter = found.fields["getter"]
            frame = Frame(file=owner.type.definition.file)
            return dispatch(self.machine, getter, Arguments(values=(owner,), frame=frame))
        return _bound_to(owner, found)

    def _of_class(self, owner: ClassValue | NativeClass, name: str) -> Value | None:
        """Return what stands in a class, unbound: a native method has its class for owner."""
        if name == "__name__":
            return Known(owner.name)
        for cls in self.lineage(owner):
            if isinstance(cls, ClassValue) and name in cls.fields:
                return _with_class(cls.fields[name], cls)
            if isinstance(cls, NativeClass) and name in cls.methods:
                return Native(name, cls.methods[name], cls)
        return None

    def _class(self, definition: Class, frame: Frame) -> ClassValue:
        bases = tuple(
            Hole("base") if isinstance(base, TypeRef) else self.machine.evaluate(base, frame)
            for base in definition.bases
        )
        body = Frame(file=frame.file, closure=frame)
        self.machine.execute(definition.body, body)
        made = ClassValue(definition, tuple(map(_as_class, bases)), body.variables, closure=frame)
        return with_members(made) if ENUM in self.lineage(made) else made

    def _decorated(self, decorator: Value, value: Value, frame: Frame) -> Value:
        if isinstance(decorator, Foreign):
            found = _DESCRIPTORS.get(decorator.name)
            return Instance(found, {"getter": value}) if found else value
        if not isinstance(decorator, (FunctionValue, Native, ClassValue)):
            return value
        made = dispatch(self.machine, decorator, Arguments(values=(value,), frame=frame))
        return value if isinstance(made, Hole) or made == NONE else made

    def _module(self, dotted: str, importer: Path) -> Value:
        top = dotted.partition(".")[0]
        if is_message_package(dotted) or any(
            name.partition(".")[0] == top for name in self.natives
        ):
            return Foreign(dotted)
        path = self.files.python_module(dotted, importer)
        if path is None:
            return Foreign(dotted)
        return self._modules.get(path) or self.run(path, dotted)

    def _submodule(self, owner: ModuleValue, name: str) -> Value | None:
        path = self.files.python_module(f"{owner.name}.{name}", Path(owner.file))
        if path is not None:
            return self._modules.get(path) or self.run(path, f"{owner.name}.{name}")
        return message_type(f"{owner.name}.{name}")

    def _foreign(self, dotted: str) -> Value:
        return self.natives.get(dotted) or message_type(dotted) or Foreign(dotted)

    def _import_all(self, module: Value, frame: Frame) -> None:
        if isinstance(module, ModuleValue):
            for name, value in list(module.fields.items()):
                if not name.startswith("__"):
                    self.machine.trail.set(frame.variables, name, value)
        elif isinstance(module, Foreign):
            self._stars.setdefault(id(frame.variables), []).append(module.name)

    def _starred(self, name: str, root: Frame) -> Value | None:
        """Return what one of the libraries imported with a star brings."""
        modules = self._stars.get(id(root.variables), [])
        for module in modules:
            if f"{module}.{name}" in self.natives:
                return self.natives[f"{module}.{name}"]
        packages = [module for module in modules if is_message_package(module)]
        for module in packages:
            if self.files.has_message(module.split(".", maxsplit=1)[0], name):
                return message_type(f"{module}.{name}")
        unknown = [
            m for m in packages if self.files.has_message(m.split(".", maxsplit=1)[0], name) is None
        ]
        sure = len(unknown) == 1 and name[:1].isupper()
        return message_type(f"{unknown[0]}.{name}") if sure else None

    def _note(self, unit: Unit, path: Path) -> None:
        for problem in unit.problems:
            self.machine.recorder.problem(path, problem)
        for name, function in called_as(unit.body):
            self._named.setdefault(name, []).append(function)


def called_as(body: tuple[object, ...], cls: str = "") -> Iterator[tuple[str, Function]]:
    """Yield every function with the plain name it is called by: `__init__` by its class's."""
    for statement in body:
        what = getattr(statement, "what", None)
        if isinstance(what, Function):
            yield (cls if what.name == "__init__" else what.name), what
            yield from called_as(what.body or ())
        elif isinstance(what, Class):
            yield from called_as(what.body, what.name)
        elif isinstance(statement, Assign) and isinstance(statement.value, Lambda):
            for target in statement.targets:
                yield getattr(target, "id", ""), statement.value.function
        else:
            for name in ("body", "orelse", "final"):
                yield from called_as(getattr(statement, name, ()) or ())


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
    if isinstance(found, FunctionValue) and found.cls is None:
        return replace(found, cls=cls)
    return found


def _absolute(node: Import) -> str:
    """Return the module an import means; a relative one is looked up beside the importing file."""
    return "." * node.level + node.module


def _with_setter(_: Machine, owner: Instance, arguments: Arguments) -> Value:
    return Instance(PROPERTY, {**owner.fields, "setter": arguments.get(0) or NONE})


PROPERTY = NativeClass("property", methods={"setter": _with_setter})
STATIC = NativeClass("staticmethod")
CLASSWISE = NativeClass("classmethod")
_DESCRIPTORS = {"property": PROPERTY, "staticmethod": STATIC, "classmethod": CLASSWISE}
