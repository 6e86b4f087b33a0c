"""Python's modules: running them, and what an import brings."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from rtron.sources.code.interpreter.abstract_values.value_types import (
    Foreign,
    Known,
    MapValue,
    ModuleValue,
    Native,
    Value,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.source_provider import Files
from rtron.sources.code.interpreter.execution.stack_frame import Frame
from rtron.sources.code.ir import Assign, Class, Function, Import, Lambda, Language, Unit
from rtron.sources.code.library_models.common.message_types import is_message_package, message_type


@dataclass(eq=False, slots=True, kw_only=True)
class PythonModules:
    """The modules of one program; `natives` are the libraries that RTron knows."""

    files: Files
    natives: Mapping[str, Value]
    machine: Machine = field(init=False)
    _modules: dict[Path, ModuleValue] = field(default_factory=dict)
    _stars: dict[int, list[str]] = field(default_factory=dict)
    _named: dict[str, list[Function]] = field(default_factory=dict)

    def run(self, path: Path, name: str) -> ModuleValue:
        """Run a file's top level as the module `name`."""
        unit = self.files.unit(path, Language.PYTHON)
        module = ModuleValue(name, file=unit.file)
        self._modules[path] = module
        frame = Frame(file=unit.file, variables=module.fields)
        frame.variables.update(__name__=Known(name), __file__=Known(str(path)))
        self._note(unit, path)
        self.machine.execute(unit.body, frame)
        return module

    def size(self) -> int:
        """Return a number that changes when the program's functions do."""
        return len(self._modules)

    def own_functions(self) -> Iterator[tuple[str, Function]]:
        """Yield the functions of the modules that were loaded, and what they are called by."""
        for name, functions in self._named.items():
            yield from ((name, function) for function in functions)

    def named(self, name: str) -> tuple[Function, ...]:
        """Return the functions with a name, in the modules that were loaded."""
        return tuple(self._named.get(name, ()))

    def import_(self, node: Import, frame: Frame) -> None:
        """Bind what an import brings: a scanned module, or a library by its name."""
        importer = Path(frame.file)
        if node.name == "*":
            self._import_all(self._module(_absolute(node), importer), frame)
            return
        alias = node.alias or node.name or node.module.partition(".")[0]
        if node.name is None:
            module = self._module(node.module, importer)
            value = module if node.alias else self._module(alias, importer)
        else:
            value = self._from_module(_absolute(node), node.name, importer)
        self.machine.trail.set(frame.variables, alias, value)

    def _from_module(self, dotted: str, name: str, importer: Path) -> Value:
        """Return a name of a module; a folder without `__init__.py` has modules alone (PEP 420)."""
        owner = self._module(dotted, importer)
        if isinstance(owner, Foreign) and not self.is_library(dotted):
            inner = self._module(f"{dotted}{'' if dotted.endswith('.') else '.'}{name}", importer)
            if isinstance(inner, ModuleValue):
                return inner
        return self._of_module(owner, name) or Foreign(f"{dotted}.{name}")

    def _of_module(self, owner: Value, name: str) -> Value | None:
        """Return a name of a module, scanned or of a library."""
        if isinstance(owner, ModuleValue):
            return owner.fields.get(name) or self._submodule(owner, name)
        if isinstance(owner, Foreign) and name == "__dict__" and self.is_library(owner.name):
            return MapValue(self._members(f"{owner.name}."))
        if isinstance(owner, Foreign):
            return self._foreign(f"{owner.name}.{name}")
        return self.natives.get(f"{owner.name}.{name}") if isinstance(owner, Native) else None

    def _module(self, dotted: str, importer: Path) -> Value:
        path = self.files.python_module(dotted, importer)
        if path is None or (self.is_library(dotted) and not self._is_beside(path, dotted)):
            return Foreign(dotted)
        return self._modules.get(path) or self.run(path, dotted)

    def is_library(self, dotted: str) -> bool:
        """Tell whether a module is one of a library that RTron knows, or has messages."""
        top = dotted.partition(".")[0]
        return is_message_package(dotted) or any(n.partition(".")[0] == top for n in self.natives)

    def _is_beside(self, path: Path, dotted: str) -> bool:
        """Tell whether a module lies in the script's folder, which Python looks into first."""
        script = next(iter(self._modules), path)
        parts = len(dotted.split(".")) + (path.name == "__init__.py")
        return path != script and path.parents[parts - 1] == script.parent

    def _submodule(self, owner: ModuleValue, name: str) -> Value | None:
        """Return a module of a package, which lies beside its `__init__.py`."""
        file = Path(owner.file)
        beside = file.name == "__init__.py"
        dotted = f".{name}" if beside else f"{owner.name}.{name}"
        path = self.files.python_module(dotted, file)
        if path is not None:
            return self._modules.get(path) or self.run(path, f"{owner.name}.{name}")
        return message_type(f"{owner.name}.{name}")

    def _members(self, prefix: str) -> dict[str, Value]:
        """Return what RTron knows of a library, by its names there."""
        names = [name for name in self.natives if name.startswith(prefix)]
        return {name.removeprefix(prefix): self.natives[name] for name in names}

    def _foreign(self, dotted: str) -> Value:
        for name in (dotted, _exported(dotted)):
            known = self.natives.get(name) or message_type(name)
            if known is not None:
                return known
        return Foreign(dotted)

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


def _exported(dotted: str) -> str:
    """Return `a.b.C` for `a.b.c.C`: a package has what its modules define; others stay."""
    module, _, name = dotted.rpartition(".")
    package, _, last = module.rpartition(".")
    is_class = bool(package) and name[:1].isupper() and not last[:1].isupper()
    return f"{package}.{name}" if is_class else dotted


def _absolute(node: Import) -> str:
    """Return the module an import means; a relative one is looked up beside the importing file."""
    return "." * node.level + node.module
