"""The workspace as the interpreter sees it: files lowered once, headers and modules found."""

import re
from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path, PurePath

from rtron.errors import InputError
from rtron.messages.common.definition_registry import standard_names
from rtron.sources.bounded_file import read_regular_file
from rtron.sources.code import ir
from rtron.sources.code.frontends.cpp import lower_cpp
from rtron.sources.code.frontends.parameter_library import (
    DESCRIPTION_SUFFIXES,
    described_libraries,
    generated_code,
)
from rtron.sources.code.frontends.python import lower_python
from rtron.sources.code.interpreter.execution.source_provider import PluginSource
from rtron.sources.workspace import Workspace
from rtron.sources.workspace.package_contents import BuildTarget, TargetKind
from rtron.sources.workspace.package_files import is_inside

MAX_BYTES = 4 * 2**20
MAX_CACHED = 64 * 2**20

_METHOD = re.compile(rb"\b(\w+)(?:<[^<>;(){}]{0,200}>)?::~?(?:\w+)\s*\(")
_FUNCTION = re.compile(rb"^(?:[A-Za-z_][\w:<>,&* ]{0,200}[\s&*])?(\w+)\s*\(", re.MULTILINE)


@dataclass(eq=False, slots=True)
class SourceTexts:
    """Reads sources; each is read once, as long as all that is kept is not too much."""

    _cache: dict[Path, bytes] = field(default_factory=dict)
    _size: int = 0

    def sources_containing(self, sources: Iterable[Path], word: str) -> tuple[Path, ...]:
        """Return those of some sources whose text has a word."""
        plain = word.encode("utf-8", "surrogateescape")
        letters = re.escape(plain)
        word_pattern = re.compile(
            rb"%b(?<=\b%b)\b" % (letters, letters)
        )  # letters first: found faster
        texts = ((path, self._source_text(path)) for path in sources)
        return tuple(path for path, text in texts if plain in text and word_pattern.search(text))

    def _source_text(self, path: Path) -> bytes:
        known = self._cache.get(path)
        if known is None:
            known = _read_source(path)
            if self._size + len(known) <= MAX_CACHED:
                self._cache[path] = known
                self._size += len(known)
        return known


def sources_by_definition(targets: Iterable[BuildTarget]) -> Mapping[str, tuple[Path, ...]]:
    """Return the sources of libraries that may define a class or function, by its plain name."""
    libraries = (target for target in targets if target.kind is TargetKind.LIBRARY)
    found: dict[str, list[Path]] = defaultdict(list)
    for path in dict.fromkeys(path for target in libraries for path in target.sources):
        for word in _defined_names(path):
            found[word].append(path)
    return {word: tuple(paths) for word, paths in found.items()}


def _defined_names(path: Path) -> set[str]:
    text = _read_source(path)
    return {word.decode() for form in (_METHOD, _FUNCTION) for word in form.findall(text)}


def _read_source(path: Path) -> bytes:
    try:
        return read_regular_file(path, MAX_BYTES)
    except InputError:
        return b""


MAX_DATA = 2**20
_MAX_SOURCE = 16 * 2**20
_TEST_PACKAGE = re.compile("(^|_)tests?($|_)")


@dataclass(eq=False, slots=True)
class WorkspaceSources:
    """Answers the interpreter from a Workspace."""

    workspace: Workspace
    definitions: tuple[str, ...] = ()
    _sources: dict[str, Mapping[str, tuple[Path, ...]]] = field(default_factory=dict)
    _texts: SourceTexts = field(default_factory=SourceTexts)
    _folders: tuple[Path, ...] = ()
    _described: dict[str, Mapping[str, Path]] = field(default_factory=dict)
    _units: dict[tuple[Path, ir.SourceLanguage, tuple[str, ...]], ir.Unit] = field(
        default_factory=dict
    )

    def with_macros(self, definitions: tuple[str, ...]) -> "WorkspaceSources":
        """Return the same files for a target that defines macros, `NAME` or `NAME=value`."""
        return replace(self, definitions=definitions)

    def lowered_unit(self, path: Path, language: ir.SourceLanguage) -> ir.Unit:
        """Return a file, lowered; one that cannot be read is empty, with a Problem."""
        try:
            text = read_regular_file(path, _MAX_SOURCE)
        except InputError as error:
            problem = ir.SourceProblem(0, f"cannot be read: {error.reason}")
            return ir.Unit(file=str(path), language=language, problems=(problem,))
        definitions = tuple(one for one in self.definitions if _may_use_macro(text, one))
        key = (path, language, definitions)
        if key not in self._units:
            self._units[key] = _lower(path, text, language, definitions)
        return self._units[key]

    def header(self, include: str, includer: Path) -> Path | None:
        """Return the file that `#include` means; of a generated one, what it is made of."""
        text = include.strip('<>"')
        found = self.workspace.header(text, includer)
        folder = PurePath(text).parent.name
        return found or self._described_parameters(folder, PurePath(text).stem, includer)

    def python_module(self, dotted: str, importer: Path) -> Path | None:
        """Return the file of a module; of a generated one, what it is made of."""
        package, name = dotted.partition(".")[0], dotted.rpartition(".")[2]
        found = self._module_file(dotted, importer)
        return found or self._described_parameters(package, name, importer)

    def _module_file(self, dotted: str, importer: Path) -> Path | None:
        """Return the file of a module; a relative one is looked up beside the importing file.

        So is one that is found nowhere else: Python 2, and with it ROS 1 until Melodic, looks there
        first (PEP 328).
        """
        if not dotted.startswith("."):
            package = self.workspace.package_of(importer) or ""
            found = self.workspace.python_module(dotted, package, importer)
            if found or not (importer.parent / "__init__.py").is_file():
                return found
            dotted = f".{dotted}"
        found = _relative_module_file(dotted, importer)
        return found if found and self.workspace.package_of(found) else None

    def _described_parameters(self, package: str, name: str, includer: Path) -> Path | None:
        """Return the description that a file of a package, or of the own one, is generated of."""
        owner = package if package in self.workspace.packages else None
        owner = owner or self.workspace.package_of(includer)
        if owner is None:
            return None
        if owner not in self._described:
            self._described[owner] = described_libraries(self.workspace.packages[owner])
        path = self._described[owner].get(name)
        return path if path and self.is_in_package(path) else None

    def has_message_type(self, package: str, name: str) -> bool | None:
        """Tell whether a package, of the workspace or a standard one, defines a message type."""
        known = self.workspace.messages(package) or standard_names(package)
        return name in known if known else None

    def package_path(self, package: str) -> Path | None:
        """Return where a package lies."""
        return self.workspace.packages.get(package)

    def package_names(self) -> tuple[str, ...]:
        """Return the names of the packages of the workspace."""
        return tuple(sorted(self.workspace.packages))

    def is_dependency(self, package: str, path: Path) -> bool:
        """Tell whether the package of a file says that it depends on another, or it is here."""
        own = self.workspace.package_of(path)
        return package in self.workspace.packages or (
            own is not None and package in self.workspace.manifest(own).depends
        )

    def is_in_package(self, path: Path) -> bool:
        """Tell whether a path exists and lies in a package, links followed."""
        if not self._folders:
            self._folders = tuple(each.resolve() for each in self.workspace.packages.values())
        return is_inside(path, self._folders)

    def read_text(self, path: Path) -> str | None:
        """Return a data file that lies in a package, links followed; an installed one's source."""
        path = self.workspace.installed_source(path)
        if not self.is_in_package(path) or not path.is_file():
            return None
        try:
            return read_regular_file(path, MAX_DATA).decode("utf-8", "replace")
        except InputError:
            return None

    def find_plugin(self, name: str, base: str) -> PluginSource | None:
        """Return the class that pluginlib knows by a name or type."""
        found = self.workspace.plugin(name, base)
        if found is None or found.program is None:
            return None
        return PluginSource(found.plugin_class.type, found.program.sources)

    def is_plugin(self, name: str) -> bool:
        """Tell whether a class of this name or type is registered, for whatever base."""
        return self.workspace.is_plugin(name)

    def plugin_names(self, base: str) -> tuple[str, ...]:
        """Return the names of all plugins of a base class, but for those of packages for tests."""
        found = self.workspace.plugins(base)
        names = (one.name for one in found if not _TEST_PACKAGE.search(one.package))
        return tuple(dict.fromkeys(names))

    def library_sources(self, name: str) -> tuple[Path, ...]:
        """Return the sources of the library that a file name means."""
        found = self.workspace.library(name)
        return found.sources if found is not None else ()

    def libraries_containing(self, word: str) -> tuple[tuple[Path, ...], ...]:
        """Return the sources of each library that has a word in one of them."""
        packages = (self.workspace.contents(package) for package in self.workspace.packages)
        targets = (target for contents in packages if contents for target in contents.targets)
        libraries = [target.sources for target in targets if target.kind is TargetKind.LIBRARY]
        return tuple(
            sources for sources in libraries if self._texts.sources_containing(sources, word)
        )

    def sources_containing(self, sources: tuple[Path, ...], word: str) -> tuple[Path, ...]:
        """Return those of some sources whose text has a word."""
        return self._texts.sources_containing(sources, word)

    def sources_defining(self, header: Path, word: str) -> tuple[Path, ...]:
        """Return the sources of a header's package that may define a class or function."""
        package = self.workspace.package_of(header)
        if package is None:
            return ()
        if package not in self._sources:
            contents = self.workspace.contents(package)
            self._sources[package] = sources_by_definition(contents.targets if contents else ())
        return self._sources[package].get(word, ())


def _lower(
    path: Path, text: bytes, language: ir.SourceLanguage, definitions: tuple[str, ...]
) -> ir.Unit:
    if path.suffix in DESCRIPTION_SUFFIXES:
        text = generated_code(text, path, language)
    if language is ir.SourceLanguage.PYTHON:
        return lower_python(str(path), text)
    pairs = (definition.partition("=") for definition in definitions)
    return lower_cpp(str(path), text, {name: value or "1" for name, _, value in pairs})


def _may_use_macro(text: bytes, definition: str) -> bool:
    """Tell whether a macro can matter to a file: by its name, or one that is pasted together."""
    return b"##" in text or definition.partition("=")[0].encode() in text


def _relative_module_file(dotted: str, importer: Path) -> Path | None:
    level = len(dotted) - len(dotted.lstrip("."))
    folder = importer.parents[min(level, len(importer.parents)) - 1]
    names = [name for name in dotted.split(".") if name]
    base = folder.joinpath(*names)
    files = [base / "__init__.py"]
    for path in [base.with_suffix(".py"), *files] if names else files:
        if path.is_file():
            return path
    return None
