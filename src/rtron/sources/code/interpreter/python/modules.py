"""Python's modules: running them, and what an import brings."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    ExternalSymbol,
    Instance,
    LibraryFunction,
    ListValue,
    MapValue,
    ModuleValue,
    Scalar,
    Value,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.source_provider import SourceProvider
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame
from rtron.sources.code.ir import (
    Assign,
    Class,
    Define,
    Function,
    Global,
    Import,
    Lambda,
    SourceLanguage,
    Try,
    Unit,
    While,
)
from rtron.sources.code.ir.python_references import aliases, callees, dynamic_calls, mentioned_names
from rtron.sources.code.ir.references import ir_nodes, written_names
from rtron.sources.code.library_models.common.message_types import (
    OTHER_PYTHON_LIBRARY,
    is_message_package,
    other_ros_reason,
    python_message_type,
)
from rtron.vocabulary import Evidence

_GENERATED = {"msg", "srv", "action", "cfg"}
_OPERATION = re.compile(r"__(?!init__|new__|main__|post_init__|call__)\w+__")


def _module_loops(unit: Unit) -> Iterator[Function]:
    """Yield the statements of a file's top level that loop, each as a function of its globals."""
    for line, statement in enumerate(unit.body):
        is_code = not isinstance(statement, Define)
        if is_code and any(isinstance(node, While) for node in ir_nodes(statement)):
            loop = Function(name="<loop>", file=unit.file, line=line, body=(statement,))
            names = Global(tuple(sorted(written_names(loop))))
            yield replace(loop, body=(names, statement))


@dataclass(eq=False, slots=True, kw_only=True)
class PythonModules:
    """The modules of one program; `library` are the libraries that RTron knows."""

    files: SourceProvider
    library: Mapping[str, Value]
    machine: AbstractMachine = field(init=False)
    _modules: dict[Path, ModuleValue] = field(default_factory=dict)
    _star_imports: dict[int, list[str]] = field(default_factory=dict)
    _functions_by_name: dict[str, list[Function]] = field(default_factory=dict)
    _aliases: dict[str, set[str]] = field(default_factory=dict)
    _operations: list[Function] = field(default_factory=list)
    _related_names: dict[tuple[str, int, str, int], frozenset[str]] = field(default_factory=dict)
    _unknown_calls: dict[tuple[str, int, str, int], bool] = field(default_factory=dict)

    def run_module(self, path: Path, name: str) -> ModuleValue:
        """Run a file's top level as the module `name`."""
        unit = self.files.lowered_unit(path, SourceLanguage.PYTHON)
        module = ModuleValue(name, file=unit.file)
        self._modules[path] = module
        frame = StackFrame(file=unit.file, variables=module.fields)
        frame.variables.update(__name__=Scalar(name), __file__=Scalar(str(path)))
        self._index_unit(unit, path)
        self.machine.module_loops += _module_loops(unit)
        self.machine.execute(unit.body, frame)
        return module

    def load_module(self, path: Path, name: str) -> ModuleValue:
        """Return the module of a file, which runs once."""
        return self._modules.get(path) or self.run_module(path, name)

    def version(self) -> int:
        """Return a number that changes when the program's functions do."""
        return len(self._modules)

    def program_functions(self) -> Iterator[tuple[str, Function]]:
        """Yield the functions of the modules that were loaded, and what they are called by."""
        for name, functions in self._functions_by_name.items():
            yield from ((name, function) for function in functions)

    def module_variables(self) -> Iterator[Mapping[str, Value]]:
        """Yield the variables of each module that was loaded."""
        yield from (module.fields for module in self._modules.values())

    def functions_named(self, name: str) -> tuple[Function, ...]:
        """Return the functions with a name, in the modules that were loaded."""
        return tuple(self._functions_by_name.get(name, ()))

    def related_names(self, function: Function) -> frozenset[str]:
        """Return the names of what a function may call, by whatever name it calls it."""
        key = (*function.key, self.version())
        if key not in self._related_names:
            self._related_names[key] = self._find_related(function)
        return self._related_names[key]

    def _find_related(self, function: Function) -> frozenset[str]:
        found, queue = set(mentioned_names(function)), list(callees(function))
        found.update(queue)
        while queue:
            behind = self._aliases.get(queue.pop(), set()) - found
            found |= behind
            queue.extend(behind)
        return frozenset(found)

    def calls_unknown(self, function: Function) -> bool:
        """Tell whether a function, or what it calls, calls what its source does not name.

        Any may, where one of Python's operations, `__getitem__`, joins nodes.
        """
        key = (*function.key, self.version())
        if key not in self._unknown_calls:
            found = self._has_joining_operation() or self._reaches_unknown(function)
            self._unknown_calls[key] = found
        return self._unknown_calls[key]

    def _reaches_unknown(self, function: Function) -> bool:
        seen, queue = set[tuple[str, int, str]](), [function]
        while queue:
            current = queue.pop()
            if any(name not in self._functions_by_name for name in dynamic_calls(current)):
                return True
            if current.key not in seen:
                seen.add(current.key)
                words = self.related_names(current)
                queue.extend(one for word in words for one in self.functions_named(word))
        return False

    def _has_joining_operation(self) -> bool:
        return any(self.machine.is_relevant(self.machine, each) for each in self._operations)

    def import_(self, node: Import, frame: StackFrame) -> None:
        """Bind what an import brings: a scanned module, or a library by its name."""
        importer = Path(frame.file)
        self._note_other_ros(node, frame)
        if node.name == "*":
            self._import_all(self._module(_module_name(node), importer), frame)
            return
        alias = node.alias or node.name or node.module.partition(".")[0]
        if node.name is None:
            module = self._module(node.module, importer)
            value = module if node.alias else self._module(alias, importer)
        else:
            value = self._from_module(_module_name(node), node.name, importer)
        if isinstance(value, ExternalSymbol):
            self._note_missing(node, importer)
            self._note_extension(node, importer)
        self.machine.undo_log.set(frame.variables, alias, value)

    def _note_extension(self, node: Import, importer: Path) -> None:
        """Note a module that is made of C++ in the workspace, and has nodes (pybind11)."""
        names = ((node.name or ""), node.module.rpartition(".")[2])
        for name in filter(None, names):
            sources = self.files.library_sources(name)
            word = _CPP_CLIENT_LIBRARY[self.machine.recorder.site.ros]
            for source in self.files.sources_containing(sources, word)[:1]:
                place = Evidence(file=str(importer), line=node.line)
                why = f"it is made of C++ ({source.name}): the nodes in it are not followed"
                made_of = Evidence(file=str(source))
                self.machine.recorder.add_unresolved(f"import of {name}", why, place, made_of)

    def _note_other_ros(self, node: Import, frame: StackFrame) -> None:
        ros, library = self.machine.recorder.site.ros, node.module.partition(".")[0]
        if OTHER_PYTHON_LIBRARY.get(ros) == library:
            place = Evidence(file=frame.file, line=node.line)
            self.machine.recorder.add_unresolved(f"import {library}", other_ros_reason(ros), place)

    def _from_module(self, dotted: str, name: str, importer: Path) -> Value:
        """Return a name of a module; a folder without `__init__.py` has modules alone (PEP 420)."""
        owner = self._module(dotted, importer)
        if isinstance(owner, ExternalSymbol) and not self.is_library(dotted):
            inner = self._module(f"{dotted}{'' if dotted.endswith('.') else '.'}{name}", importer)
            if isinstance(inner, ModuleValue):
                return inner
        return self._module_member(owner, name) or ExternalSymbol(f"{dotted}.{name}")

    def _module_member(self, owner: Value, name: str) -> Value | None:
        """Return a name of a module, scanned or of a library."""
        if isinstance(owner, ModuleValue):
            return owner.fields.get(name) or self._submodule(owner, name)
        if isinstance(owner, ExternalSymbol) and name == "__dict__" and self.is_library(owner.name):
            return MapValue(self._library_members(f"{owner.name}."))
        if isinstance(owner, ExternalSymbol):
            return self._library_member(f"{owner.name}.{name}")
        return self._function_member(owner, name) if isinstance(owner, LibraryFunction) else None

    def _function_member(self, owner: LibraryFunction, name: str) -> Value | None:
        """Return a member of what a library's function stands for: `Base.__init__` of its class."""
        if name == "__call__":
            return owner
        if name == "__name__":
            return Scalar(owner.name.rpartition(".")[2])
        if name == "__init__":
            return LibraryFunction(name, partial(initialise_base, owner))
        return self.library.get(f"{owner.name}.{name}")

    def _module(self, dotted: str, importer: Path) -> Value:
        path = self.files.python_module(dotted, importer)
        if path is None or (
            self.is_library(dotted) and not self._is_in_script_folder(path, dotted)
        ):
            return ExternalSymbol(dotted)
        return self.load_module(path, dotted)

    def _note_missing(self, node: Import, importer: Path) -> None:
        """Note a module of the workspace that is not there; what a build makes is none."""
        package, _, rest = _module_name(node).partition(".")
        inner = rest.strip(".") or node.name or ""
        missing = _module_name(node) if rest.strip(".") else f"{package}.{rest}{inner}"
        is_ours = not package or self.files.package_path(package) is not None
        is_made = self.is_library(missing) or not _GENERATED.isdisjoint(missing.split("."))
        if is_ours and inner and not is_made:
            place = Evidence(file=str(importer), line=node.line)
            why = "the workspace has no such module: what it joins is not known"
            self.machine.recorder.add_unresolved(f"import of {missing}", why, place)

    def is_library(self, dotted: str) -> bool:
        """Tell whether a module is one of a library that RTron knows, or has messages."""
        top = dotted.partition(".")[0]
        return is_message_package(dotted) or any(n.partition(".")[0] == top for n in self.library)

    def _is_in_script_folder(self, path: Path, dotted: str) -> bool:
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
            return self.load_module(path, f"{owner.name}.{name}")
        return python_message_type(f"{owner.name}.{name}")

    def _library_members(self, prefix: str) -> dict[str, Value]:
        """Return what RTron knows of a library, by its names there."""
        names = [name for name in self.library if name.startswith(prefix)]
        return {name.removeprefix(prefix): self.library[name] for name in names}

    def _library_member(self, dotted: str) -> Value:
        for name in (dotted, _reexported_name(dotted)):
            known = self.library.get(name) or python_message_type(name)
            if known is not None:
                return known
        return ExternalSymbol(dotted)

    def _import_all(self, module: Value, frame: StackFrame) -> None:
        if isinstance(module, ModuleValue):
            for name, value in _exported(module):
                self.machine.undo_log.set(frame.variables, name, value)
        elif isinstance(module, ExternalSymbol):
            self._star_imports.setdefault(id(frame.variables), []).append(module.name)

    def _star_imported_name(self, name: str, root: StackFrame) -> Value | None:
        """Return what one of the libraries imported with a star brings."""
        modules = self._star_imports.get(id(root.variables), [])
        for module in modules:
            if f"{module}.{name}" in self.library:
                return self.library[f"{module}.{name}"]
        packages = [module for module in modules if is_message_package(module)]
        for module in packages:
            if self.files.has_message_type(module.split(".", maxsplit=1)[0], name):
                return python_message_type(f"{module}.{name}")
        unknown = [
            m
            for m in packages
            if self.files.has_message_type(m.split(".", maxsplit=1)[0], name) is None
        ]
        sure = len(unknown) == 1 and name[:1].isupper()
        return python_message_type(f"{unknown[0]}.{name}") if sure else None

    def _index_unit(self, unit: Unit, path: Path) -> None:
        for problem in unit.problems:
            self.machine.recorder.add_problem(path, problem)
        for name, function in named_functions(unit.body):
            self._functions_by_name.setdefault(name, []).append(function)
            if _OPERATION.fullmatch(function.name):
                self._operations.append(function)
        for name, behind in aliases(unit.body):
            self._aliases.setdefault(name, set()).update(behind)


def initialise_base(
    base: LibraryFunction, machine: AbstractMachine, _: object, arguments: Arguments
) -> Value:
    """`Base.__init__(self, …)` of a class of a library."""
    made, owner = base.call(machine, base.owner, arguments.without_first(1)), arguments.get(0)
    if isinstance(made, Instance) and isinstance(owner, Instance):
        for name, value in made.fields.items():
            machine.undo_log.set(owner.fields, name, value)
    return NONE


_CPP_CLIENT_LIBRARY = {1: "NodeHandle", 2: "rclcpp"}
"""What stands in C++ that has nodes, by the ROS of a launch."""
_MAKERS = {"__init__", "__new__", "__post_init__"}


def named_functions(body: tuple[object, ...], cls: str = "") -> Iterator[tuple[str, Function]]:
    """Yield every function with the plain name it is called by: `__init__` by its class's.

    What a class's objects are called by is their class's name, too.
    """
    for statement in body:
        definition = statement.definition if isinstance(statement, Define) else None
        if isinstance(definition, Function):
            yield (cls if definition.name in _MAKERS else definition.name), definition
            yield from named_functions(definition.body or ())
        elif isinstance(definition, Class):
            yield from named_functions(definition.body, definition.name)
        elif isinstance(statement, Assign) and isinstance(statement.value, Lambda):
            for target in statement.targets:
                yield getattr(target, "id", ""), statement.value.function
        else:
            for name in ("body", "orelse", "final"):
                yield from named_functions(getattr(statement, name, ()) or ())
            for _, _, handler in statement.handlers if isinstance(statement, Try) else ():
                yield from named_functions(handler)


def _exported(module: ModuleValue) -> list[tuple[str, Value]]:
    """Return what `from module import *` brings: what `__all__` lists, else what is not private."""
    listed = module.fields.get("__all__")
    if isinstance(listed, ListValue) and not listed.open:
        names = [item.value for item in listed.items if isinstance(item, Scalar)]
        return [(name, module.fields[name]) for name in names if name in module.fields]
    return [(name, value) for name, value in module.fields.items() if not name.startswith("_")]


def _reexported_name(dotted: str) -> str:
    """Return `a.b.C` for `a.b.c.C`: a package has what its modules define; others stay."""
    module, _, name = dotted.rpartition(".")
    package, _, last = module.rpartition(".")
    is_class = bool(package) and name[:1].isupper() and not last[:1].isupper()
    return f"{package}.{name}" if is_class else dotted


def _module_name(node: Import) -> str:
    """Return the module an import means; a relative one is looked up beside the importing file."""
    return "." * node.level + node.module
