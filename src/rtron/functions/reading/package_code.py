"""What the code of packages says of them: build files, sources and launch files, read as text.

Nothing is run, built or followed: a type counts wherever a file names it as the ROS tutorials write
publishers and subscribers (roscpp, rospy, rclcpp, rclpy) and launch files (roslaunch, launch).
"""

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from itertools import islice
from pathlib import Path

from rtron.errors import InputError
from rtron.functions.repository import SourcePackage, SourceRepository
from rtron.sources.bounded_file import read_regular_file
from rtron.sources.launch.common.xml_document import parse_xml
from rtron.sources.workspace.manifest import parse_manifest
from rtron.sources.workspace.package_files import PackageFiles, list_files

MAX_FILES = 500
MAX_BYTES = 2**18
MAX_FACTS = 5000
_CPP = frozenset({".cpp", ".cc", ".cxx", ".c", ".h", ".hpp", ".hh", ".hxx"})
_TESTS = re.compile(r"(?:^|/)tests?/")

_SHIPPED = {
    **dict.fromkeys(_CPP | {".py"}, "code"),
    **dict.fromkeys((".msg", ".srv", ".action", ".idl"), "interfaces"),
    **dict.fromkeys((".urdf", ".xacro", ".dae", ".stl", ".obj"), "models"),
    **dict.fromkeys((".world", ".sdf"), "worlds"),
    **dict.fromkeys((".yaml", ".rviz"), "settings"),
}

_CPP_COMMENT = re.compile(r"//[^\n]*")
_CPP_INCLUDE = re.compile(r'#\s*include\s*[<"](\w+)/(?:([A-Z]\w*)\.h|msg/(\w+)\.hpp)[>"]')
_CPP_HEADER = re.compile(r'#\s*include\s*[<"]([\w./-]{1,100})[>"]')
_CPP_PLUGIN = re.compile(
    r"\bPLUGINLIB_(?:EXPORT_CLASS\s*\(|DECLARE_CLASS\s*\((?:[^,()]+,){2})[^,()]+,\s*:{0,2}([\w:]+)"
)
_CPP_SIMULATED = re.compile(r"\b(?:GZ_REGISTER|GAZEBO_REGISTER|GZ_ADD|IGNITION_ADD)_\w*PLUGIN\b")
_CPP_TYPE = r"\s*<\s*(?::{0,2}(\w+)::(?:msg::)?)?(\w+)"
_CPP_PUBLISHES = re.compile(r"\b(?:advertise|create_publisher|Publisher)" + _CPP_TYPE)
_CPP_SUBSCRIBES = re.compile(
    r"\b(?:subscribe|create_subscription|Subscri(?:ber|ption))"
    + _CPP_TYPE
    + r"|\b(\w+)::(\w+?)(?:::)?ConstPtr\s*&"
)
_CPP_IMAGES = re.compile(r"\bimage_transport::(?:Camera)?(Publisher|Subscriber)\b")

_PY_COMMENT = re.compile(r"#[^\n]*")
_PY_IMPORT = re.compile(
    r"^[ \t]*from[ \t]+(\w+)\.msg[ \t]+import[ \t]+(\([^()]{0,2000}\)|[^\n]+)", re.MULTILINE
)
_PY_MODULE = re.compile(r"^[ \t]*(?:import|from)[ \t]+(\w+)", re.MULTILINE)
_PY_NAME = (
    r"\(\s*(?:[^,()]{1,200},\s*)?(?:data_class\s*=\s*|msg_type\s*=\s*)?(?:\w+\.){0,3}(\w+)\s*[,)]"
)
_PY_PUBLISHES = re.compile(r"\b(?:Publisher|create_publisher)" + _PY_NAME)
_PY_SUBSCRIBES = re.compile(r"\b(?:Subscriber|create_subscription)" + _PY_NAME)

_CMAKE_PACKAGES = re.compile(r"\bfind_package\s*\(([^()]{1,4000})\)", re.IGNORECASE)
_CMAKE_PLUGINS = re.compile(r"\bpluginlib_export_plugin_description_file\s*\(\s*(\w+)")
_CMAKE_VENDOR = re.compile(
    r"\b(?:ExternalProject_Add|ament_vendor|FetchContent_Declare)\s*\(", re.IGNORECASE
)
_CMAKE_WORDS = frozenset({"REQUIRED", "COMPONENTS", "QUIET", "CONFIG", "MODULE", "EXACT", "catkin"})
_LAUNCHED = re.compile(r"\b(?:pkg|package)\s*=\s*[\"'](\w+)[\"']")


def read_code(repository: SourceRepository) -> SourceRepository:
    """Return a repository with what the code of its packages says; one that is no folder as it is.

    A file that cannot be read, has more than MAX_BYTES or comes after MAX_FILES says nothing, and
    of a package no more than MAX_FACTS count.
    """
    packages = tuple(_with_code(package) for package in repository.packages)
    return replace(repository, packages=packages)


def _with_code(package: SourcePackage) -> SourcePackage:
    if package.folder is None:
        return package
    facts = _each_once(_package_facts(package.folder))
    return replace(package, code=frozenset(islice(facts, MAX_FACTS)))


def _each_once(facts: Iterable[str]) -> Iterator[str]:
    seen: set[str] = set()
    for fact in facts:
        if fact not in seen:
            seen.add(fact)
            yield fact


def _package_facts(folder: Path) -> Iterator[str]:
    yield from _exports(folder)
    files = list_files(folder, ())
    yield from (f"ships {kind}" for kind in _shipped_kinds(folder, files))
    for name in islice(filter(_is_code, files.names), MAX_FILES):
        yield from _file_facts(name, _read_text(files, folder / name))


def _exports(folder: Path) -> Iterator[str]:
    try:
        manifest = parse_manifest(parse_xml(folder / "package.xml"), folder)
    except InputError:
        return  # whoever read the package has told so
    yield from (f"exports {export.tag}" for export in manifest.exports)


def _shipped_kinds(folder: Path, files: PackageFiles) -> frozenset[str]:
    """Return the kinds of files that a package has; what only builds or launches is no code."""
    by_kind = (
        (_SHIPPED.get(Path(name).suffix.lower()), name)
        for name in files.names
        if ".launch." not in name and Path(name).name != "setup.py" and not _TESTS.search(name)
    )
    return frozenset(kind for kind, name in by_kind if kind and files.is_file(folder / name))


def _is_code(name: str) -> bool:
    is_read = name == "CMakeLists.txt" or Path(name).suffix in {*_CPP, ".py", ".launch", ".xml"}
    return is_read and not _TESTS.search(name)


def _read_text(files: PackageFiles, path: Path) -> str:
    try:
        data = read_regular_file(path, MAX_BYTES) if files.is_file(path) else b""
    except InputError:
        return ""  # a file too large to be written by hand, or gone: the others tell
    return data.decode("utf-8", errors="replace")


def _file_facts(name: str, text: str) -> Iterator[str]:
    suffix = Path(name).suffix
    if suffix in _CPP:
        yield from _cpp_facts(_CPP_COMMENT.sub("", text))
    elif suffix == ".py":
        yield from _python_facts(_PY_COMMENT.sub("", text))
    elif name == "CMakeLists.txt":
        yield from _cmake_facts(_PY_COMMENT.sub("", text))
    if suffix in {".launch", ".xml"} or ".launch." in name:
        yield from (f"launches {package}" for package in _LAUNCHED.findall(text))


def _cpp_facts(text: str) -> Iterator[str]:
    included = {
        name or _type_name(header): package for package, name, header in _CPP_INCLUDE.findall(text)
    }
    yield from (f"uses {package}/{name}" for name, package in included.items())
    yield from (f"includes {header}" for header in _CPP_HEADER.findall(text))
    yield from (f"plugs {base}" for base in _CPP_PLUGIN.findall(text))
    yield from ("plugs gazebo" for _ in _CPP_SIMULATED.findall(text))
    for package, name in _CPP_PUBLISHES.findall(text):
        yield from _cpp_type("publishes", package, name, included)
    for package, name, of_callback, named in _CPP_SUBSCRIBES.findall(text):
        yield from _cpp_type("subscribes", package or of_callback, name or named, included)
    for kind in _CPP_IMAGES.findall(text):
        yield f"{'publishes' if kind == 'Publisher' else 'subscribes'} sensor_msgs/Image"


def _cpp_type(kind: str, package: str, name: str, included: Mapping[str, str]) -> Iterator[str]:
    """Yield the fact of a type; one without its package is of the header that has its name."""
    if package or name in included:
        yield f"{kind} {package or included[name]}/{name}"


def _python_facts(text: str) -> Iterator[str]:
    types = dict(_python_types(text))
    yield from (f"uses {type}" for type in types.values())
    yield from (f"imports {module}" for module in _PY_MODULE.findall(text))
    for kind, pattern in (("publishes", _PY_PUBLISHES), ("subscribes", _PY_SUBSCRIBES)):
        yield from (f"{kind} {types[name]}" for name in pattern.findall(text) if name in types)


def _python_types(text: str) -> Iterator[tuple[str, str]]:
    """Yield the names under which a module imports message types, and the types."""
    for package, names in _PY_IMPORT.findall(text):
        for each in names.strip("()").split(","):
            name, _, alias = each.strip().partition(" as ")
            if name:
                yield (alias or name).strip(), f"{package}/{name.strip()}"


def _cmake_facts(text: str) -> Iterator[str]:
    for arguments in _CMAKE_PACKAGES.findall(text):
        words: Mapping[str, None] = dict.fromkeys(arguments.split())
        yield from (f"depends {word.lower()}" for word in words if word not in _CMAKE_WORDS)
    yield from ("builds elsewhere" for _ in _CMAKE_VENDOR.findall(text))
    yield from (f"exports {tag}" for tag in _CMAKE_PLUGINS.findall(text))


def _type_name(header: str) -> str:
    """Return the type of a header: rosidl names `LaserScan`'s `laser_scan.hpp`."""
    return header.title().replace("_", "")
