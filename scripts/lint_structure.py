"""Check that names are the field's words and that folders, modules and functions stay small.

Each finding is printed with its place. The exit code is 1 where a limit is exceeded.
"""

import ast
import builtins
import re
import sys
from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parent.parent
SOURCE = ROOT / "src" / "rtron"
FOLDERS = [ROOT / name for name in ("src", "tests", "bench", "evaluation")]
WORDS = frozenset((Path(__file__).parent / "insider_words.txt").read_text("utf-8").split())

LIMITS = {
    "insider word in a name": 10,
    "class name used twice": 5,
    "small module with one importer": 14,
    "error in a docstring that does not exist": 0,
    "folder of over 25 modules": 0,
    "function of over 40 lines": 0,
    "module of over 400 lines": 0,
}
MOST_MODULES = 25
MOST_FUNCTION_LINES = 40
MOST_MODULE_LINES = 400
SMALL_MODULE_LINES = 60

_PART = re.compile(r"[A-Z]+(?=[A-Z][a-z])|[A-Z]?[a-z]+|[A-Z]+")
_ERROR = re.compile(r"\b[A-Z][a-z]\w*Error\b")
_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)

Finding = tuple[str, str]
"""A key of `LIMITS`, and what was found where."""


@dataclass(frozen=True)
class Module:
    """A Python file of the source."""

    path: Path
    text: str
    tree: ast.Module

    @property
    def name(self) -> str:
        """The dotted name under which others import it."""
        parts = self.path.relative_to(SOURCE.parent).with_suffix("").parts
        return ".".join(parts).removesuffix(".__init__")

    @property
    def lines(self) -> int:
        """How many lines the file has."""
        return self.text.count("\n")


def read_modules() -> list[Module]:
    """Return every module of the source, in order of path."""
    texts = [(path, path.read_text("utf-8")) for path in sorted(SOURCE.rglob("*.py"))]
    return [Module(path, text, ast.parse(text)) for path, text in texts]


def insider_words(modules: list[Module]) -> Iterator[Finding]:
    """Yield each name that carries an insider word, once a module and kind of name."""
    for module in modules:
        names = {("module", module.path.stem): 1}
        for node in ast.walk(module.tree):
            for kind, name in _defined(node):
                names.setdefault((kind, name), node.lineno)
        for (kind, name), line in names.items():
            if WORDS & {part.lower() for part in _PART.findall(name)}:
                yield "insider word in a name", f"{_place(module.path)}:{line} {kind} {name}"


def _defined(node: ast.AST) -> Iterator[tuple[str, str]]:
    match node:
        case ast.FunctionDef() | ast.AsyncFunctionDef():
            yield "function", node.name
        case ast.ClassDef():
            yield "class", node.name
        case ast.arg():
            yield "parameter", node.arg
        case ast.Name(ctx=ast.Store()):
            yield "variable", node.id
        case ast.Attribute(ctx=ast.Store()):
            yield "attribute", node.attr


def repeated_classes(modules: list[Module]) -> Iterator[Finding]:
    """Yield each class name that stands more than once, parallel modules of ROS 1 and 2 aside."""
    places: dict[str, dict[str, str]] = defaultdict(dict)
    for module in modules:
        for node in ast.walk(module.tree):
            if isinstance(node, ast.ClassDef):
                place = f"{_place(module.path)}:{node.lineno}"
                places[node.name].setdefault(_parallel(module.path), place)
    for name, where in sorted(places.items()):
        if len(where) > 1:
            yield "class name used twice", f"{name}: {', '.join(where.values())}"


def _parallel(path: Path) -> str:
    """Return what two modules share that are the ROS 1 and ROS 2 variants of one thing."""
    return re.sub(r"/(common|ros1|ros2)/", "/*/", path.as_posix())


def small_modules(modules: list[Module]) -> Iterator[Finding]:
    """Yield each small module that only one other imports."""
    importers = _importers(modules)
    for module in modules:
        small = module.lines < SMALL_MODULE_LINES and not module.path.stem.startswith("__")
        if small and len(importers[module.name]) == 1:
            (importer,) = importers[module.name]
            place = f"{_place(module.path)}: {module.lines} lines, imported by {importer}"
            yield "small module with one importer", place


def _importers(modules: list[Module]) -> dict[str, set[str]]:
    """Return who imports each module."""
    known = {module.name for module in modules}
    importers: dict[str, set[str]] = defaultdict(set)
    for module in modules:
        for imported in _imports(module.tree) & known - {module.name}:
            importers[imported].add(module.name)
    return importers


def _imports(tree: ast.Module) -> set[str]:
    names: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
    return names


def unknown_errors(modules: list[Module]) -> Iterator[Finding]:
    """Yield each error that a docstring names and that no code knows: renames leave them behind."""
    nodes = [node for module in modules for node in ast.walk(module.tree)]
    known = {node.name for node in nodes if isinstance(node, (ast.ClassDef, ast.alias))}
    known |= {node.id for node in nodes if isinstance(node, ast.Name)} | set(dir(builtins))
    for module in modules:
        for name in sorted(set(_ERROR.findall(_docstrings(module.tree))) - known):
            yield "error in a docstring that does not exist", f"{_place(module.path)}: {name}"


def _docstrings(tree: ast.Module) -> str:
    kinds = (ast.Module, ast.ClassDef, *_FUNCTIONS)
    documented = [node for node in ast.walk(tree) if isinstance(node, kinds)]
    return "\n".join(filter(None, map(ast.get_docstring, documented)))


def large_folders() -> Iterator[Finding]:
    """Yield each folder with too many modules side by side."""
    for top in FOLDERS:
        sizes = Counter(path.parent for path in top.rglob("*.py") if path.stem != "__init__")
        for folder, size in sizes.items():
            if size > MOST_MODULES:
                yield "folder of over 25 modules", f"{_place(folder)}: {size}"


def long_code(modules: list[Module]) -> Iterator[Finding]:
    """Yield each module and each function of the source with too many lines."""
    for module in modules:
        if module.lines > MOST_MODULE_LINES:
            yield "module of over 400 lines", f"{_place(module.path)}: {module.lines}"
        for node in ast.walk(module.tree):
            if isinstance(node, _FUNCTIONS) and _length(node) > MOST_FUNCTION_LINES:
                place = f"{_place(module.path)}:{node.lineno} {node.name}: {_length(node)}"
                yield "function of over 40 lines", place


def _length(node: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    """Return the lines of a function's code: a command's options and help are none."""
    first = node.body[ast.get_docstring(node) is not None :] or node.body
    return (node.end_lineno or node.lineno) - first[0].lineno + 1


def _place(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def main() -> int:
    """Print what was found where a limit is exceeded or `--all` is given; return the exit code."""
    modules = read_modules()
    found: dict[str, list[str]] = {kind: [] for kind in LIMITS}
    checks = (insider_words, repeated_classes, small_modules, unknown_errors, long_code)
    for kind, text in [*large_folders(), *(each for check in checks for each in check(modules))]:
        found[kind].append(text)
    for kind, texts in found.items():
        if len(texts) > LIMITS[kind] or "--all" in sys.argv:
            print(*texts, sep="\n")
        print(f"{kind}: {len(texts)}, at most {LIMITS[kind]}")
    return int(any(len(texts) > LIMITS[kind] for kind, texts in found.items()))


if __name__ == "__main__":
    sys.exit(main())
