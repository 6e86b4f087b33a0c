"""A package's Python modules and programs: what its setup.py and setup.cfg say.

Sources: ROS wiki, catkin, Python; setuptools, entry points. setup.py is parsed, never run.
"""

import ast
import configparser
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.bounded_file import read_regular_file
from rtron.sources.workspace.package_files import is_regular
from rtron.sources.workspace.setup_script import HOLE, SetupScript, SetupValue, is_known
from rtron.vocabulary import Evidence, UnresolvedItem

MAX_BYTES = 1024 * 1024

_ENTRY = re.compile(r"\s*([\w.-]+)\s*=\s*([\w.]+)\s*:\s*(\w+)")
_SCRIPTS = "console_scripts"


@dataclass(frozen=True, slots=True, kw_only=True)
class PythonPackage:
    """The folder of a package's modules, and each program's module and function by its name.

    `scripts` are the files that are installed as programs, by their names.
    """

    folder: Path
    entry_points: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    scripts: Mapping[str, Path] = field(default_factory=dict)
    unresolved: tuple[UnresolvedItem, ...] = ()


def read_python_package(package: Path, name: str) -> PythonPackage:
    """Return what the setup.py and setup.cfg of a package say; what is not understood is noted.

    In ROS 2 the modules' folder stands in the package's root, also without an `__init__.py`
    (PEP 420), called like the package or as the entry points say. In ROS 1 it lies in `src`.
    """
    setup, notes = _read_setup_script(package / "setup.py")
    configured, of_config = _read_setup_config(package / "setup.cfg")
    value, line = setup.arguments.get("entry_points", ({}, 0))
    try:
        written = [*_scripts(value), *configured]
    except configparser.Error:
        value, written = None, configured
    if not (is_known(value) and setup.is_complete):
        notes.append(_note(package / "setup.py", line, _ENTRIES_REASON))
    matched = filter(None, (_ENTRY.match(text.replace(HOLE, "")) for text in written))
    entries = {match[1]: (match[2], match[3]) for match in matched}
    folder = _root_folder(setup.arguments.get("package_dir", (None, 0))[0])
    if folder is None:
        modules = (module for module, _ in entries.values())
        folder = "" if _is_root(package, name, modules) else "src"
    return PythonPackage(
        folder=package / folder,
        entry_points=entries,
        scripts=dict(_installed_files(setup.arguments.get("scripts", ([], 0))[0], package)),
        unresolved=(*notes, *of_config),
    )


_ENTRIES_REASON = "not all of its entry points are understood: programs of it may be missing"


def _note(path: Path, line: int, why: str) -> UnresolvedItem:
    return UnresolvedItem(what=path.name, why=why, evidence=(Evidence(file=str(path), line=line),))


def _read_setup_script(path: Path) -> tuple[SetupScript, list[UnresolvedItem]]:
    setup = SetupScript()
    if not is_regular(path):
        return setup, []
    try:
        tree = ast.parse(read_regular_file(path, MAX_BYTES))
    except (InputError, SyntaxError, ValueError, RecursionError, MemoryError) as error:
        line = getattr(error, "lineno", getattr(error, "line", 0)) or 0
        return setup, [_note(path, line, f"cannot be read: {type(error).__name__}")]
    setup.read(tree)
    return setup, []


def _scripts(value: SetupValue) -> Iterator[str]:
    """Yield the entries of `console_scripts`, also of a text like an INI file."""
    if isinstance(value, str):
        section = _read_config(value.replace(HOLE, ""))
        yield from (f"{name}={entry}" for name, entry in section.items(_SCRIPTS))
    found = value.get(_SCRIPTS) if isinstance(value, dict) else None
    for entries in found if isinstance(found, list) else [found]:
        yield from entries.splitlines() if isinstance(entries, str) else ()


def _read_config(text: str) -> configparser.ConfigParser:
    reader = configparser.ConfigParser(interpolation=None)
    reader.optionxform = str  # type: ignore[assignment, method-assign]
    reader.read_string(text)
    return reader


def _installed_files(value: SetupValue, package: Path) -> Iterator[tuple[str, Path]]:
    for name in value if isinstance(value, list) else ():
        path = package / name if isinstance(name, str) else package
        if is_regular(path):
            yield path.name, path


def module_file(folder: Path, dotted: str) -> Path | None:
    """Return the file of a module below a folder: the package's `__init__.py` first."""
    parts = dotted.split(".")
    if not all(part.isidentifier() for part in parts):
        return None
    path = folder.joinpath(*parts)
    candidates = (path / "__init__.py", path.with_name(f"{parts[-1]}.py"))
    return next(filter(is_regular, candidates), None)


def _is_root(package: Path, name: str, modules: Iterable[str]) -> bool:
    """Tell whether the modules stand in a package's own folder."""
    if (package / "src" / name).is_dir():
        return False
    return any((package / name).glob("*.py")) or any(module_file(package, m) for m in modules)


def _root_folder(package_dir: SetupValue) -> str | None:
    """Return the folder of the root, or the one around the first package."""
    texts = package_dir if isinstance(package_dir, dict) else {}
    folders = {name: folder for name, folder in texts.items() if isinstance(folder, str)}
    around = (str(Path(folder).parent) for folder in folders.values())
    return folders.get("") or next(around, None)


def _read_setup_config(path: Path) -> tuple[list[str], list[UnresolvedItem]]:
    if not is_regular(path):
        return [], []
    try:
        text = read_regular_file(path, MAX_BYTES).decode("utf-8", "replace")
        entries = _read_config(text).get("options.entry_points", _SCRIPTS, fallback="")
        return entries.splitlines(), []
    except (InputError, configparser.Error) as error:
        why = f"cannot be read: {type(error).__name__}"
        return [], [_note(path, getattr(error, "lineno", 0) or 0, why)]
