"""The names of a C++ program: all its files, and the headers they include, in one table."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from rtron.sources.code import ir
from rtron.sources.code.interpreter.execution.source_provider import SourceProvider
from rtron.sources.code.library_models.common.message_types import INTERFACE_FOLDERS, message_header

MAX_FILES = 600
MODELLED_FOLDERS = frozenset(
    [
        *("ros", "actionlib", "bondcpp", "diagnostic_updater", "dynamic_reconfigure"),
        *("image_transport", "interactive_markers", "message_filters", "nodelet"),
        *("nodelet_topic_tools", "pluginlib", "realtime_tools", "tf", "tf2_ros"),
        *("camera_info_manager", "rclcpp", "rclcpp_action", "rclcpp_components"),
        *("rclcpp_lifecycle", "behaviortree_cpp", "behaviortree_cpp_v3", "tf2"),
        "tf2_geometry_msgs",
    ]
)
"""Headers of libraries that `library_models` replace: their own source is not run."""
_MAX_ALIASES = 12


@dataclass(eq=False, slots=True)
class SymbolTable:
    """Functions, classes, variables, aliases and enumerators, by their qualified names.

    `local_scopes` are the functions that have classes or aliases of their own, `unread` the files
    that were one too many, `headers` what all of them include.
    """

    files: SourceProvider
    sources: tuple[Path, ...] = ()
    functions: dict[str, list[ir.Function]] = field(default_factory=dict)
    classes: dict[str, ir.Class] = field(default_factory=dict)
    variables: dict[str, tuple[ir.Declare, str]] = field(default_factory=dict)
    aliases: dict[str, ir.TypeRef] = field(default_factory=dict)
    enums: dict[str, int | None] = field(default_factory=dict)
    usings: list[str] = field(default_factory=list)
    exports: list[tuple[str, str]] = field(default_factory=list)
    units: dict[Path, ir.Unit] = field(default_factory=dict)
    _by_unqualified_name: dict[str, list[ir.Function]] = field(default_factory=dict)
    _methods: dict[str, list[str]] = field(default_factory=dict)
    _candidates: dict[tuple[str, str], tuple[str, ...]] = field(default_factory=dict)
    _resolved_types: dict[tuple[ir.TypeRef, str], ir.TypeRef] = field(default_factory=dict)
    _resolved_plain_types: dict[tuple[str, str], ir.TypeRef] = field(default_factory=dict)
    _class_cache: dict[tuple[str, str], ir.Class | None] = field(default_factory=dict)
    _program_files: dict[str, bool] = field(default_factory=dict)
    _unqualified_names: set[str] = field(default_factory=set)
    version: int = 0
    _dependent_caches: list[dict[Any, Any]] = field(default_factory=list)
    _searched: set[tuple[str, str]] = field(default_factory=set)
    local_scopes: set[str] = field(default_factory=set)
    stray: list[tuple[ir.Evaluate, str]] = field(default_factory=list)
    specialisations: dict[str, list[ir.Class]] = field(default_factory=dict)
    unread: list[Path] = field(default_factory=list)
    headers: set[str] = field(default_factory=set)
    _switches_by_label: dict[str, set[int]] = field(default_factory=dict)

    def new_cache(self) -> dict[Any, Any]:
        """Return a dict that is emptied whenever a file brings other names."""
        self._dependent_caches.append({})
        return self._dependent_caches[-1]

    def load(self, path: Path) -> None:
        """Take in a file and the headers it includes, headers first."""
        if path in self.units:
            return
        if len(self.units) >= MAX_FILES and path not in self.sources:
            self.unread.append(path)
            return
        unit = self.files.lowered_unit(path, ir.SourceLanguage.CPP)
        self.units[path] = unit
        self.headers.update(include.strip('<>"') for include in unit.includes)
        for include in unit.includes:
            if include.strip('<>"').partition("/")[0] in MODELLED_FOLDERS:
                continue
            header = self.files.header(include, path)
            if header is not None:
                self.load(header)
        self._add_unit(unit)

    def are_equal(self, first: str, second: str) -> bool | None:
        """Tell whether two names of headers that are not here have one value; None if not known.

        A name equals itself, and the labels of one `switch` differ.
        """
        if first == second:
            return True
        switches = self._switches_by_label
        is_apart = not switches.get(first, set()).isdisjoint(switches.get(second, set()))
        return False if is_apart else None

    def load_definition(self, function: ir.Function) -> bool:
        """Take in the sources that may define a function which is only declared so far.

        Those of its header's package; tell whether there are any.
        """
        owner, _, plain = function.name.rpartition("::")
        word = owner.rpartition("::")[2] if owner in self.classes else plain
        if (function.file, word) in self._searched:
            return False
        self._searched.add((function.file, word))
        found = self.files.sources_defining(Path(function.file), word)
        missing = [path for path in found if path not in self.units]
        for path in missing:
            self.load(path)
        return bool(missing)

    def unexpanded_macros(self) -> Iterator[tuple[Path, int, str, Path]]:
        """Yield where a macro of another file that makes endpoints stands, not expanded."""
        macros = {name: path for path, unit in self.units.items() for name in unit.endpoint_macros}
        for path, unit in self.units.items() if macros else ():
            for name, line in unit.unexpanded:
                if name in macros and macros[name] != path:
                    yield path, line, name, macros[name]

    def functions_named(self, plain: str) -> tuple[ir.Function, ...]:
        """Return the functions whose last part is a name."""
        return tuple(self._by_unqualified_name.get(plain, ()))

    def is_program_file(self, file: str) -> bool:
        """Tell whether a file is one of the program's sources, or a header of its package."""
        if file not in self._program_files:
            path = Path(file)
            self._program_files[file] = path in self.sources or any(
                path.is_relative_to(folder)
                for source in self.sources
                for folder in source.parents[:2]
            )
        return self._program_files[file]

    def is_known_name(self, name: str) -> bool:
        """Tell whether anything has this name's last part: if not, it means nothing here."""
        return name.rpartition("::")[2] in self._unqualified_names

    def method_names(self, cls: str) -> list[str]:
        """Return the names of the methods defined for a class."""
        return self._methods.get(cls, [])

    def candidates(self, name: str, scope: str) -> tuple[str, ...]:
        """Return the qualified names that a name may mean in a scope, nearest first."""
        key = name, scope
        if key not in self._candidates:
            self._candidates[key] = tuple(dict.fromkeys(self._candidates_of(name, scope)))
        return self._candidates[key]

    def _candidates_of(self, name: str, scope: str) -> Iterator[str]:
        if name.startswith("::"):
            yield name[2:]
            return
        parts = scope.split("::") if scope else []
        for depth in range(len(parts), -1, -1):
            yield "::".join((*parts[:depth], name))
        head = name.partition("::")[0]
        for using in self.usings:
            if using.endswith(head) and using.rpartition("::")[2] == head:
                yield using + name[len(head) :]
            yield f"{using}::{name}"

    def resolve_type(self, type: ir.TypeRef, scope: str) -> ir.TypeRef:
        """Return a type with its typedefs and namespace aliases followed."""
        if not type.args:
            return self._resolve_plain(type, scope)
        key = type, scope
        if key not in self._resolved_types:
            self._resolved_types[key] = self._follow_aliases(type, scope)
        return self._resolved_types[key]

    def _resolve_plain(self, type: ir.TypeRef, scope: str) -> ir.TypeRef:
        """Return what a type without arguments means: a text is faster to look up than a type."""
        key = type.name, scope
        found = self._resolved_plain_types.get(key)
        if found is None:
            found = self._resolved_plain_types[key] = self._follow_aliases(type, scope)
        return found

    def _follow_aliases(self, type: ir.TypeRef, scope: str) -> ir.TypeRef:
        for at in range(_MAX_ALIASES):
            known = self._alias_target(type, scope)
            if known is None:
                return self._qualified_type(type, scope) if at else type
            type, scope = known
        return type

    def _qualified_type(self, type: ir.TypeRef, scope: str) -> ir.TypeRef:
        """Return the type that an alias means by its full name, which holds in any scope."""
        found = (
            name
            for name in self.candidates(type.name, scope)
            if name in self.classes or self._is_included_message(name)
        )
        name = next(found, None)
        return type if name is None else ir.TypeRef(name, type.args)

    def _is_included_message(self, name: str) -> bool:
        """Tell whether a name is of a message of ROS 2 whose header a file includes."""
        package, _, rest = name.partition("::")
        folder, _, plain = rest.partition("::")
        header = message_header(package, folder, plain.partition("::")[0])
        return folder in INTERFACE_FOLDERS and header in self.headers

    def class_named(self, name: str, scope: str) -> ir.Class | None:
        """Return the scanned class that a name means."""
        key = name, scope
        if key not in self._class_cache:
            if not self.is_known_name(name):
                return None
            found = (self.classes.get(candidate) for candidate in self.candidates(name, scope))
            self._class_cache[key] = next(filter(None, found), None)
        return self._class_cache[key]

    def _alias_target(self, type: ir.TypeRef, scope: str) -> tuple[ir.TypeRef, str] | None:
        for candidate in self.candidates(type.name, scope) if self.is_known_name(type.name) else ():
            if candidate in self.classes:
                return None
            found = self.aliases.get(candidate)
            if found is not None and found != type:
                inner = candidate.rpartition("::")[0]
                given = {ir.alias_parameter(at): arg for at, arg in enumerate(type.args)}
                target = ir.substituted(found, given)
                return ir.TypeRef(target.name, target.args or type.args), inner
        return self._namespace_alias_target(type, scope)

    def _namespace_alias_target(
        self, type: ir.TypeRef, scope: str
    ) -> tuple[ir.TypeRef, str] | None:
        """`namespace mf = message_filters;`: `mf::Subscriber` is `message_filters::Subscriber`."""
        head, _, rest = type.name.partition("::")
        if not rest or head not in self._unqualified_names:
            return None
        for candidate in self.candidates(head, scope):
            found = self.aliases.get(candidate)
            if found is not None and found.name != head:
                return ir.TypeRef(f"{found.name}::{rest}", type.args), ""
        return None

    def _clear_caches(self) -> None:
        """Forget what names meant, since a file brings others."""
        self.version += 1
        caches: list[dict[Any, Any]] = [self._resolved_types, self._resolved_plain_types]
        for cache in (*caches, self._class_cache, *self._dependent_caches):
            cache.clear()

    def _add_usings(self, names: Iterable[str]) -> None:
        new = [name for name in dict.fromkeys(names) if name not in self.usings]
        if new:
            self.usings.extend(new)
            self._candidates.clear()

    def _add_unit(self, unit: ir.Unit) -> None:
        self._clear_caches()
        named = (*dict(unit.aliases), *dict(unit.enums), *(cls.name for cls in unit.classes))
        self._unqualified_names.update(name.rpartition("::")[2] for name in named)
        self.aliases.update(unit.aliases)
        self.enums.update(unit.enums)
        self._add_usings(unit.usings)
        for definition in unit.classes:
            self.classes.setdefault(definition.name, definition)
            if definition.specialised:
                primary = definition.name.partition("<")[0]
                self.specialisations.setdefault(primary, []).append(definition)
            for member in definition.fields:
                if member.static:
                    name = f"{definition.name}::{member.name}"
                    self._add_variable(replace(member, name=name, static=False), unit.file)
        self._clear_caches()
        for function in map(self._qualify, unit.functions):
            self.functions.setdefault(function.name, []).append(function)
            owner, _, plain = function.name.rpartition("::")
            self._unqualified_names.add(plain)
            self._by_unqualified_name.setdefault(plain, []).append(function)
            if function.body is not None:
                self._methods.setdefault(owner, []).append(plain)
        local = (*(cls.name for cls in unit.classes), *dict(unit.aliases))
        owners = {name.rpartition("::")[0] for name in local}
        self.local_scopes.update(owner for owner in owners if owner in self.functions)
        for statement in unit.body:
            if isinstance(statement, ir.Declare):
                self._add_variable(statement, unit.file)
            elif isinstance(statement, ir.Evaluate):
                self.stray.append((statement, unit.file))
        self.exports.extend(unit.exports)
        self._add_labels(unit)

    def _add_labels(self, unit: ir.Unit) -> None:
        for labels in unit.labels:
            for label in labels:
                self._switches_by_label.setdefault(label, set()).add(id(labels))

    def _qualify(self, function: ir.Function) -> ir.Function:
        """Return a function under its full name: `using namespace a; B::run() {}` is a::B::run."""
        owner, _, plain = function.name.rpartition("::")
        if not owner or owner in self.classes:
            return function
        definition = self.class_named(owner, "")
        if definition is None:
            return function
        return replace(function, name=f"{definition.name}::{plain}")

    def _add_variable(self, declared: ir.Declare, file: str) -> None:
        self._unqualified_names.add(declared.name.rpartition("::")[2])
        known, first = self.variables.get(declared.name, (declared, file))
        constant = known.constant and declared.constant
        if known.value is None:
            known, first = declared, file
        self.variables[declared.name] = (replace(known, constant=constant), first)
