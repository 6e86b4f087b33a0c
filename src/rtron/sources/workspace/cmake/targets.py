"""The commands that make targets, and those that say what belongs to them."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path

from rtron.sources.workspace.cmake.build import flags
from rtron.sources.workspace.cmake.command_call import Call, sections
from rtron.sources.workspace.cmake.values import split
from rtron.sources.workspace.cmake.variables import Handler
from rtron.sources.workspace.package_contents import TargetKind

_EXECUTABLE = (
    *("add_executable", "cuda_add_executable", "cs_add_executable", "cs_cuda_add_executable"),
    *("rosbuild_add_executable", "rosbuild_add_gtest", "rosbuild_add_gtest_build_flags"),
    *("catkin_add_gtest", "catkin_add_gmock", "catkin_add_executable_with_gtest"),
)
_LIBRARY = (
    *("add_library", "cuda_add_library", "cs_add_library", "cs_cuda_add_library"),
    "rosbuild_add_library",
)
_ROSTEST = ("add_rostest_gtest", "add_rostest_gmock")
_TYPES = frozenset({"STATIC", "SHARED", "MODULE", "OBJECT", "INTERFACE", "UNKNOWN", "GLOBAL"})
_OPTIONS = _TYPES | {"WIN32", "MACOSX_BUNDLE", "EXCLUDE_FROM_ALL"}
_VISIBILITY = frozenset({"PUBLIC", "PRIVATE", "INTERFACE"})
_LINKAGE = _VISIBILITY | {"LINK_PUBLIC", "LINK_PRIVATE", "LINK_INTERFACE_LIBRARIES"}
_CONFIGURATION = frozenset({"debug", "optimized", "general"})
_PLACEMENT = frozenset({"BEFORE", "AFTER", "SYSTEM"})
_PACKAGE_WORDS = frozenset({"COMPONENTS", "OPTIONAL_COMPONENTS", "REQUIRED", "QUIET", "EXACT"})
_CATKIN_WORDS = frozenset({"INCLUDE_DIRS", "LIBRARIES", "CATKIN_DEPENDS", "DEPENDS", "CFG_EXTRAS"})
_INSTALL_WORDS = frozenset(
    {"PROGRAMS", "DESTINATION", "RENAME", "PERMISSIONS", "CONFIGURATIONS", "COMPONENT", "OPTIONAL"}
)
_OUTPUTS = frozenset({"OUTPUT_NAME", "LIBRARY_OUTPUT_NAME", "RUNTIME_OUTPUT_NAME"})
_DEFINING = frozenset({"COMPILE_DEFINITIONS", "COMPILE_FLAGS", "COMPILE_OPTIONS"})


def add_target(kind: TargetKind, call: Call) -> None:
    """Carry out `add_executable`, `add_library` or a relative of theirs."""
    words = call.words
    if not call.items or "IMPORTED" in words:
        return
    name = call.items[0]
    if not (name.known and name.text):
        call.note(f"{call.name}({name.text} …)", "the target's name is not set in the file")
        return
    draft = call.build.target(name.text, kind, call.scope.folder, call.evidence)
    if words[1:2] == ["ALIAS"]:
        draft.links.update(dict.fromkeys(words[2:]))
        return
    for item in call.items[1:]:
        if not item.known and not item.text:
            what = f"sources of target {name.text}"
            call.note(what, "some stand in a variable that the file does not set")
        elif item.text not in _OPTIONS:
            call.build.add_source(draft, item.text, call.scope.folder, call.evidence)


def add_rostest(call: Call) -> None:
    """Carry out `add_rostest_gtest`: the second argument is a launch file."""
    add_target(TargetKind.EXECUTABLE, replace(call, items=call.items[:1] + call.items[2:]))


def add_sources(call: Call) -> None:
    """Carry out `target_sources`."""
    words = call.words
    draft = call.build.targets.get(words[0]) if words else None
    if draft is not None:
        for word in words[1:]:
            if word not in _VISIBILITY:
                call.build.add_source(draft, word, call.scope.folder, call.evidence)


def link(call: Call) -> None:
    """Carry out `target_link_libraries`."""
    words = call.words
    draft = call.build.targets.get(words[0]) if words else None
    if draft is not None:
        ignored = _LINKAGE | _CONFIGURATION
        names = (word for word in words[1:] if word not in ignored and "$" not in word)
        draft.links.update(dict.fromkeys(names))


def define_for_target(call: Call) -> None:
    """Carry out `target_compile_definitions` and `target_compile_options`."""
    words = call.words
    draft = call.build.targets.get(words[0]) if words else None
    if draft is not None:
        given = (word for word in words[1:] if word not in _LINKAGE and "$" not in word)
        draft.definitions.update(dict.fromkeys(_definitions(call.name, given)))


def define_for_folder(call: Call) -> None:
    """Carry out `add_definitions`, `add_compile_options` and `add_compile_definitions`."""
    bare = call.name == "add_compile_definitions"
    for word in call.words:
        call.build.define(call.scope.folder, f"-D{word}" if bare else word)


def undefine(call: Call) -> None:
    """Carry out `remove_definitions`."""
    defined = call.build.definitions.get(call.scope.folder, {})
    for name in flags(" ".join(call.words)):
        defined.pop(name, None)


def set_properties(call: Call) -> None:
    """Carry out `set_target_properties`: output names and definitions."""
    found = sections(call.words, frozenset({"PROPERTIES"}))
    properties = found.get("PROPERTIES", [])
    for name in found[""]:
        for key, value in zip(properties[::2], properties[1::2], strict=False):
            _set_property(call, name, key, value)


def set_property(call: Call) -> None:
    """Carry out `set_property TARGET …`."""
    found = sections(call.words, frozenset({"TARGET", "PROPERTY", "APPEND", "APPEND_STRING"}))
    key, *values = found.get("PROPERTY") or [""]
    for name in found.get("TARGET", []):
        _set_property(call, name, key, ";".join(values))


def include_directories(call: Call) -> None:
    """Carry out `include_directories` and `target_include_directories`."""
    of_target = call.name == "target_include_directories"
    for word in call.words[1 if of_target else 0 :]:
        path = word.removeprefix("$<BUILD_INTERFACE:").removesuffix(">")
        if word not in _VISIBILITY | _PLACEMENT and not path.startswith("$<"):
            call.build.add_include_dir(call.scope.folder / path)


def find_package(call: Call) -> None:
    """Carry out `find_package`: `X_LIBRARIES` becomes the package, or catkin's components."""
    words = call.words
    if not words:
        return
    found = sections(words[1:], _PACKAGE_WORDS)
    components = [part for word in _PACKAGE_WORDS for part in found.get(word, [])]
    names = components if words[0] in {"catkin", "catkin_simple"} else [words[0]]
    call.build.found.update(dict.fromkeys(names))
    variable = f"{words[0]}_LIBRARIES"
    old = call.scope.variables.get(variable)
    linked = dict.fromkeys((*(split(old.text) if old else ()), *names))
    call.set(variable, ";".join(linked), known=False)


def catkin_package(call: Call) -> None:
    """Carry out `catkin_package`: the folders of headers that others see."""
    for word in sections(call.words, _CATKIN_WORDS).get("INCLUDE_DIRS", []):
        call.build.add_include_dir(call.scope.folder / word)


def install(call: Call) -> None:
    """Remember the scripts that `install` and `catkin_install_python` install, and their names."""
    if call.words[:1] != ["PROGRAMS"]:
        return
    found = sections(call.words, _INSTALL_WORDS)
    names = found.get("RENAME") or []
    for word in found["PROGRAMS"]:
        path = call.scope.folder / word
        if call.build.files.is_file(path):
            call.build.installed.setdefault(names[0] if names else Path(word).name, path)


def _set_property(call: Call, name: str, key: str, value: str) -> None:
    draft = call.build.targets.get(name)
    if draft is None or not value:
        return
    if key in _OUTPUTS:
        draft.output = value
    elif key in _DEFINING:
        bare = split(value) if key == "COMPILE_DEFINITIONS" else flags(value)
        draft.definitions.update(dict.fromkeys(bare))


def _definitions(command: str, words: Iterable[str]) -> list[str]:
    if command == "target_compile_definitions":
        return [word.removeprefix("-D") for word in words]
    return flags(" ".join(words))


TARGET_COMMANDS: Mapping[str, Handler] = {
    **dict.fromkeys(_EXECUTABLE, partial(add_target, TargetKind.EXECUTABLE)),
    **dict.fromkeys(_LIBRARY, partial(add_target, TargetKind.LIBRARY)),
    **dict.fromkeys(_ROSTEST, add_rostest),
    "target_sources": add_sources,
    "target_link_libraries": link,
    "target_compile_definitions": define_for_target,
    "target_compile_options": define_for_target,
    "add_definitions": define_for_folder,
    "add_compile_options": define_for_folder,
    "add_compile_definitions": define_for_folder,
    "remove_definitions": undefine,
    "set_target_properties": set_properties,
    "set_property": set_property,
    "include_directories": include_directories,
    "target_include_directories": include_directories,
    "find_package": find_package,
    "catkin_package": catkin_package,
    "install": install,
    "catkin_install_python": install,
}
