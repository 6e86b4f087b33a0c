"""Places whose text is a call that joins nodes in ROS 2, found by words, not by RTron's readers.

C++ calls write out the type (`create_publisher<T>(`), which tells them from a wrapper's definition.
Tests, examples, rviz's panels and what no build file names are no node sources.
"""

import re
from collections import defaultdict
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TypeAlias

Site: TypeAlias = tuple[str, int]
"""A file and a line."""
ParameterSite: TypeAlias = tuple[str, int, str]
"""A file, a line, and the name that stands there."""

_TYPED = r"\s*<[^;()]*>\s*\("
_CPP_FORMS = {
    "publisher": rf"\bcreate_publisher{_TYPED}",
    "subscription": rf"\bcreate_subscription{_TYPED}",
    "service": rf"\bcreate_service{_TYPED}",
    "client": rf"\b(?<!rclcpp_action::)create_client{_TYPED}",
    "action server": rf"\b(?:create_action_server|rclcpp_action::create_server){_TYPED}",
    "action client": rf"\b(?:create_action_client|rclcpp_action::create_client){_TYPED}",
}
_PYTHON_FORMS = {
    "publisher": r"\.\s*create_publisher\(",
    "subscription": r"\.\s*create_subscription\(",
    "service": r"\.\s*create_service\(",
    "client": r"\.\s*create_client\(",
    "action server": r"\bActionServer\(",
    "action client": r"\bActionClient\(",
}
KINDS = tuple(_CPP_FORMS)
_PARAMETER = re.compile(
    r"\bdeclare_(?:or_get_)?parameter\s*(?:<[^;()]*>)?\s*\(\s*[\"'](?P<name>[\w./-]+)[\"']\s*[,)]"
)
_HEADERS = frozenset({".hpp", ".h", ".hh"})
_CPP = _HEADERS | {".cpp", ".cc", ".cxx"}
_CPP_COMMENT = re.compile(r'"(?:\\.|[^"\\\n])*"|(?P<comment>/\*.*?\*/|//[^\n]*)', re.DOTALL)
_PYTHON_COMMENT = re.compile(r"(?P<comment>#[^\n]*)")
_TESTS = re.compile(
    r"(^|[_/])(tests?|testing|system_tests|benchmarks?|examples?|rviz_plugins?)(/|$)"
)
_BUILD_FILES = ("CMakeLists.txt", "*.cmake", "setup.py", "setup.cfg")
_WHOLE_FOLDERS = re.compile(r"\b(GLOB(_RECURSE)?|DIRECTORY|aux_source_directory)\b")


def call_sites(folder: Path) -> Mapping[str, frozenset[Site]]:
    """Return the sites below a folder, by kind."""
    found: dict[str, set[Site]] = defaultdict(set)
    for path in _sources(folder):
        forms = _PYTHON_FORMS if path.suffix == ".py" else _CPP_FORMS
        code = _code(path)
        for kind, form in forms.items():
            for match in re.finditer(form, code):
                found[kind].add((str(path), code.count("\n", 0, match.start()) + 1))
    return {kind: frozenset(found[kind]) for kind in KINDS}


def parameter_sites(folder: Path) -> frozenset[ParameterSite]:
    """Return the calls below a folder that declare a parameter whose name they write out."""
    codes = [(str(path), _code(path)) for path in _sources(folder)]
    return frozenset(
        (file, code.count("\n", 0, match.start()) + 1, match["name"])
        for file, code in codes
        for match in _PARAMETER.finditer(code)
    )


def _sources(folder: Path) -> Iterator[Path]:
    texts: dict[Path, str] = {}
    for path in sorted(folder.rglob("*")):
        location = str(path.relative_to(folder).parent)
        is_source = path.suffix in _CPP or path.suffix == ".py"
        if is_source and not _TESTS.search(location) and _is_built(path, folder, texts):
            yield path


def _is_built(path: Path, top: Path, texts: dict[Path, str]) -> bool:
    """Tell whether a build file of its package names a script or a source, or takes all there are.

    Headers and the modules of a Python package need no name. `texts` are kept by their package.
    """
    package = next((p for p in path.parents if (p / "package.xml").is_file()), top)
    if path.suffix in _HEADERS or (path.parent / "__init__.py").is_file() or package == top:
        return True
    if package not in texts:
        texts[package] = _build_text(package)
    if path.name in texts[package]:
        return True
    folder = rf"\b{re.escape(path.parent.name)}/?\s" if path.suffix == ".py" else ""
    return bool(_WHOLE_FOLDERS.search(texts[package]) and re.search(folder, texts[package]))


def _build_text(package: Path) -> str:
    """Return what a package's build files say, the project's name where they mean it."""
    files = (path for form in _BUILD_FILES for path in package.rglob(form))
    text = "\n".join(path.read_text("utf-8", "replace") for path in files)
    project = re.search(r"\bproject\s*\(\s*(\w+)", text)
    return text.replace("${PROJECT_NAME}", project[1]) if project else text


def _code(path: Path) -> str:
    """Return the text of a source without its comments."""
    text = path.read_bytes().decode("utf-8", "replace")
    return (_PYTHON_COMMENT if path.suffix == ".py" else _CPP_COMMENT).sub(_blank, text)


def _blank(found: re.Match[str]) -> str:
    return "\n" * found.group().count("\n") if found["comment"] else found.group()
