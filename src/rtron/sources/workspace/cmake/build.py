"""What the evaluation of a package's CMake files has brought to light so far."""

import re
from dataclasses import dataclass, field
from pathlib import Path, PurePath

from rtron.sources.workspace.package_contents import (
    BuildTarget,
    ComponentClass,
    LeftOut,
    TargetKind,
)
from rtron.sources.workspace.package_files import PackageFiles
from rtron.vocabulary import Evidence, UnresolvedItem

MAX_NOTES = 200

COMPILED = frozenset({".c", ".cc", ".cpp", ".cxx", ".c++", ".cp", ".cu"})
_GENERATOR_WORD = re.compile(r"(?:[^$<>:,]|::)+")
_FLAG = re.compile(r"[-/]D\s*([A-Za-z_]\w*(?:=\S*)?)")


@dataclass(slots=True, kw_only=True)
class TargetBuilder:
    """A target while it is put together; the values of the dicts mean nothing."""

    name: str
    kind: TargetKind
    folder: Path
    sources: dict[Path, None] = field(default_factory=dict)
    links: dict[str, None] = field(default_factory=dict)
    definitions: dict[str, None] = field(default_factory=dict)
    output_name: str = ""


@dataclass(slots=True, kw_only=True)
class PackageBuild:
    """The targets, folders, installed scripts and shared files of one package.

    `left_out_by` is why a build with the defaults does not come to what is read now. With
    `is_open`, commands of its own make programs of which nothing is known.
    """

    files: PackageFiles
    targets: dict[str, TargetBuilder] = field(default_factory=dict)
    definitions: dict[Path, dict[str, None]] = field(default_factory=dict)
    include_dirs: dict[Path, None] = field(default_factory=dict)
    installed: dict[str, Path] = field(default_factory=dict)
    shared: dict[tuple[PurePath, Path], None] = field(default_factory=dict)
    components: dict[tuple[str, str], ComponentClass] = field(default_factory=dict)
    exports: dict[tuple[str, Path], None] = field(default_factory=dict)
    left_out: dict[str, LeftOut] = field(default_factory=dict)
    left_out_by: LeftOut | None = None
    is_open: bool = False
    unresolved: list[UnresolvedItem] = field(default_factory=list)

    def add_unresolved(self, what: str, why: str, evidence: Evidence) -> None:
        """Note what could not be resolved, MAX_NOTES times at most."""
        if len(self.unresolved) < MAX_NOTES:
            self.unresolved.append(UnresolvedItem(what=what, why=why, evidence=(evidence,)))

    def add_target(self, name: str, kind: TargetKind, folder: Path) -> TargetBuilder:
        """Return a target, a new one if there is none of that name."""
        new = TargetBuilder(name=name, kind=kind, folder=folder)
        if name not in self.targets:
            self.note_left_out(name)
        return self.targets.setdefault(name, new)

    def note_left_out(self, name: str) -> None:
        """Remember of something new that a build with the defaults leaves it out, if it does."""
        if self.left_out_by is not None:
            self.left_out.setdefault(name, self.left_out_by)

    def add_source(self, draft: TargetBuilder, text: str, folder: Path, evidence: Evidence) -> None:
        """Add a source as spelled in `folder`; headers and the like are not compiled."""
        if "<" in text:
            self._add_generated(draft, text, folder, evidence)
            return
        path = folder / text
        if path.suffix.lower() in COMPILED and self.files.is_file(path):
            draft.sources[_resolved_path(path)] = None
        elif not path.suffix or path.suffix.lower() in COMPILED:
            self._add_unsuffixed(draft, path, evidence)

    def _add_generated(
        self, draft: TargetBuilder, text: str, folder: Path, evidence: Evidence
    ) -> None:
        """Add the sources, or the objects of a target, in a generator expression, all of them."""
        words = generator_words(text)
        paths = [folder / word for word in words if Path(word).suffix.lower() in COMPILED]
        paths = list(filter(self.files.is_file, paths))
        draft.sources.update((_resolved_path(path), None) for path in paths)
        if "TARGET_OBJECTS" in text:
            draft.links.update(dict.fromkeys(words))
        elif not paths:
            what = f"sources of target {draft.name}"
            self.add_unresolved(what, "a generator expression says some", evidence)

    def add_include_dir(self, path: Path) -> None:
        """Add a folder of headers, if it is one of ours."""
        if self.files.is_folder(path):
            self.include_dirs[_resolved_path(path)] = None

    def add_definitions(self, folder: Path, text: str) -> None:
        """Define the macros of a text of compiler flags for the targets of a folder."""
        self.definitions.setdefault(folder, {}).update(dict.fromkeys(defined_macros(text)))

    def build_targets(self) -> tuple[BuildTarget, ...]:
        """Return the targets, with the definitions of their folders."""
        return tuple(self._build_target(draft) for draft in self.targets.values())

    def _build_target(self, draft: TargetBuilder) -> BuildTarget:
        folders = (draft.folder, *draft.folder.parents)
        shared = (name for folder in folders for name in self.definitions.get(folder, ()))
        return BuildTarget(
            name=draft.name,
            kind=draft.kind,
            sources=tuple(draft.sources),
            links=tuple(draft.links),
            definitions=tuple(dict.fromkeys((*draft.definitions, *shared))),
            output_name=draft.output_name or draft.name,
        )

    def _add_unsuffixed(self, draft: TargetBuilder, path: Path, evidence: Evidence) -> None:
        found = [path.with_name(path.name + suffix) for suffix in sorted(COMPILED)]
        found = [candidate for candidate in found if self.files.is_file(candidate)]
        draft.sources.update((_resolved_path(candidate), None) for candidate in found[:1])
        if not found:
            what = f"source {path.name} of target {draft.name}"
            self.add_unresolved(what, "is not in the package: generated or missing", evidence)


def generator_words(text: str) -> list[str]:
    """Return the words in a generator expression that stand in no upper case."""
    return [word for word in _GENERATOR_WORD.findall(text) if not word.isupper()]


def defined_macros(text: str) -> list[str]:
    """Return the macros that a text of compiler flags defines, as `NAME` or `NAME=value`."""
    return _FLAG.findall(text)


def _resolved_path(path: Path) -> Path:
    """Return a path without `..`, which no symbolic link in it may change."""
    return path.resolve() if ".." in path.parts else path
