"""The commands that make targets, and those that say what belongs to them."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path, PurePath

from rtron.sources.workspace.cmake.build import COMPILED, defined_macros, generator_words
from rtron.sources.workspace.cmake.command_call import CommandCall, split_by_keyword, split_list
from rtron.sources.workspace.cmake.variables import Handler
from rtron.sources.workspace.package_contents import TargetKind

_EXECUTABLE = (
    *("add_executable", "cuda_add_executable", "cs_add_executable", "cs_cuda_add_executable"),
    *("rosbuild_add_executable", "rosbuild_add_gtest", "rosbuild_add_gtest_build_flags"),
    "catkin_add_executable_with_gtest",
)
_CATKIN_TESTS = ("catkin_add_gtest", "catkin_add_gmock")
_LIBRARY = (
    *("add_library", "cuda_add_library", "cs_add_library", "cs_cuda_add_library"),
    "rosbuild_add_library",
)
_PYTHON_MODULE = (
    *("pybind11_add_module", "nanobind_add_module"),
    *("python_add_library", "python3_add_library"),
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
    [
        *("PROGRAMS", "DESTINATION", "RENAME", "PERMISSIONS", "CONFIGURATIONS", "COMPONENT"),
        *("OPTIONAL", "FILES", "DIRECTORY", "USE_SOURCE_PERMISSIONS", "FILES_MATCHING", "PATTERN"),
    ]
)
_OUTPUT_PROPERTIES = frozenset({"OUTPUT_NAME", "LIBRARY_OUTPUT_NAME", "RUNTIME_OUTPUT_NAME"})
_DEFINITION_PROPERTIES = frozenset({"COMPILE_DEFINITIONS", "COMPILE_FLAGS", "COMPILE_OPTIONS"})


def add_target(kind: TargetKind, call: CommandCall) -> None:
    """Carry out `add_executable`, `add_library` or a relative of theirs."""
    words = call.words
    if not call.items or "IMPORTED" in words:
        return
    name = call.items[0]
    if not (name.known and name.text):
        call.build.is_open |= kind is TargetKind.EXECUTABLE
        call.add_unresolved(
            f"{call.name}({name.text} …)", "the target's name is not set in the file"
        )
        return
    draft = call.build.add_target(name.text, kind, call.scope.folder)
    if words[1:2] == ["ALIAS"]:
        draft.links.update(dict.fromkeys(words[2:]))
        return
    for item in call.items[1:]:
        if not item.known and not item.text:
            what = f"sources of target {name.text}"
            call.add_unresolved(what, "some stand in a variable that the file does not set")
        elif item.text not in _OPTIONS:
            call.build.add_source(draft, item.text, call.scope.folder, call.evidence)


def add_from_sources(kind: TargetKind, call: CommandCall) -> None:
    """Carry out a command with words of its own: of its arguments the sources alone count."""
    items = (item for item in call.items[1:] if not item.known or _is_source(item.text))
    add_target(kind, replace(call, items=(*call.items[:1], *items)))


def _is_source(text: str) -> bool:
    return "<" in text or PurePath(text).suffix.lower() in COMPILED


def add_rostest(call: CommandCall) -> None:
    """Carry out `add_rostest_gtest`: the second argument is a launch file."""
    add_target(TargetKind.EXECUTABLE, replace(call, items=call.items[:1] + call.items[2:]))


def add_sources(call: CommandCall) -> None:
    """Carry out `target_sources`."""
    words = call.words
    draft = call.build.targets.get(words[0]) if words else None
    if draft is not None:
        for word in words[1:]:
            if word not in _VISIBILITY:
                call.build.add_source(draft, word, call.scope.folder, call.evidence)


def link_libraries(call: CommandCall) -> None:
    """Carry out `target_link_libraries`."""
    words = call.words
    draft = call.build.targets.get(words[0]) if words else None
    if draft is not None:
        ignored = _LINKAGE | _CONFIGURATION
        for word in words[1:]:
            names = generator_words(word) if "<" in word else [] if "$" in word else [word]
            draft.links.update(dict.fromkeys(name for name in names if name not in ignored))


def add_target_definitions(call: CommandCall) -> None:
    """Carry out `target_compile_definitions` and `target_compile_options`."""
    words = call.words
    draft = call.build.targets.get(words[0]) if words else None
    if draft is not None:
        given = (word for word in words[1:] if word not in _LINKAGE and "$" not in word)
        draft.definitions.update(dict.fromkeys(_macro_definitions(call.name, given)))


def add_folder_definitions(call: CommandCall) -> None:
    """Carry out `add_definitions`, `add_compile_options` and `add_compile_definitions`."""
    bare = call.name == "add_compile_definitions"
    for word in call.words:
        call.build.add_definitions(call.scope.folder, f"-D{word}" if bare else word)


def remove_definitions(call: CommandCall) -> None:
    """Carry out `remove_definitions`."""
    defined = call.build.definitions.get(call.scope.folder, {})
    for name in defined_macros(" ".join(call.words)):
        defined.pop(name, None)


def set_properties(call: CommandCall) -> None:
    """Carry out `set_target_properties`: output names and definitions."""
    found = split_by_keyword(call.words, frozenset({"PROPERTIES"}))
    properties = found.get("PROPERTIES", [])
    for name in found[""]:
        for key, value in zip(properties[::2], properties[1::2], strict=False):
            _set_property(call, name, key, value)


def set_property(call: CommandCall) -> None:
    """Carry out `set_property TARGET …`."""
    found = split_by_keyword(
        call.words, frozenset({"TARGET", "PROPERTY", "APPEND", "APPEND_STRING"})
    )
    key, *values = found.get("PROPERTY") or [""]
    for name in found.get("TARGET", []):
        _set_property(call, name, key, ";".join(values))


def include_directories(call: CommandCall) -> None:
    """Carry out `include_directories` and `target_include_directories`."""
    of_target = call.name == "target_include_directories"
    for word in call.words[1 if of_target else 0 :]:
        path = word.removeprefix("$<BUILD_INTERFACE:").removesuffix(">")
        if word not in _VISIBILITY | _PLACEMENT and not path.startswith("$<"):
            call.build.add_include_dir(call.scope.folder / path)


def find_package(call: CommandCall) -> None:
    """Carry out `find_package`: `X_LIBRARIES` becomes the package, or catkin's components."""
    words = call.words
    if not words:
        return
    found = split_by_keyword(words[1:], _PACKAGE_WORDS)
    components = [part for word in _PACKAGE_WORDS for part in found.get(word, [])]
    names = components if words[0] in {"catkin", "catkin_simple"} else [words[0]]
    variable = f"{words[0]}_LIBRARIES"
    old = call.scope.variables.get(variable)
    linked = dict.fromkeys((*(split_list(old.text) if old else ()), *names))
    call.set(variable, ";".join(linked), known=False)


def catkin_package(call: CommandCall) -> None:
    """Carry out `catkin_package`: the folders of headers that others see."""
    for word in split_by_keyword(call.words, _CATKIN_WORDS).get("INCLUDE_DIRS", []):
        call.build.add_include_dir(call.scope.folder / word)


def record_install(call: CommandCall) -> None:
    """Remember what `install` and `catkin_install_python` install: scripts, and shared files."""
    if call.words[:1] == ["PROGRAMS"]:
        _record_scripts(call)
    elif call.words[:1] in (["FILES"], ["DIRECTORY"]):
        _record_shared_files(call)


def _record_shared_files(call: CommandCall) -> None:
    """Remember where files and folders are installed in the package's share folder.

    Of a folder whose name ends with a slash the content is (CMake's manual, install).
    """
    found = split_by_keyword(call.words, _INSTALL_WORDS)
    share = call.scope.lookup("CATKIN_PACKAGE_SHARE_DESTINATION")
    place = PurePath(next(iter(found.get("DESTINATION", ())), "").strip("/"))
    if share is None or not place.is_relative_to(share.text):
        return
    place = place.relative_to(share.text)
    for word in (*found.get("FILES", ()), *found.get("DIRECTORY", ())):
        name = next(iter(found.get("RENAME", ())), PurePath(word).name)
        installed = place if word.endswith("/") else place / name
        call.build.shared[installed, call.scope.folder / word] = None


def _record_scripts(call: CommandCall) -> None:
    if any(not (item.known or item.text) for item in call.items):
        why = "some stand in a variable that the file does not set"
        call.add_unresolved(f"programs of {call.name}()", why)
    found = split_by_keyword(call.words, _INSTALL_WORDS)
    names = found.get("RENAME") or []
    for word in found["PROGRAMS"]:
        path, name = call.scope.folder / word, names[0] if names else Path(word).name
        if call.build.files.is_file(path) and name not in call.build.installed:
            call.build.note_left_out(name)
            call.build.installed[name] = path
        elif not call.build.files.is_file(path) and "<" not in word:
            why = "is not in the package: generated or missing"
            call.add_unresolved(f"program {name} of {call.name}()", why)


def _set_property(call: CommandCall, name: str, key: str, value: str) -> None:
    draft = call.build.targets.get(name)
    if draft is None or not value:
        return
    if key in _OUTPUT_PROPERTIES:
        draft.output_name = value
    elif key in _DEFINITION_PROPERTIES:
        bare = split_list(value) if key == "COMPILE_DEFINITIONS" else defined_macros(value)
        draft.definitions.update(dict.fromkeys(bare))


def _macro_definitions(command: str, words: Iterable[str]) -> list[str]:
    if command == "target_compile_definitions":
        return [word.removeprefix("-D") for word in words]
    return defined_macros(" ".join(words))


TARGET_COMMANDS: Mapping[str, Handler] = {
    **dict.fromkeys(_EXECUTABLE, partial(add_target, TargetKind.EXECUTABLE)),
    **dict.fromkeys(_LIBRARY, partial(add_target, TargetKind.LIBRARY)),
    **dict.fromkeys(_ROSTEST, add_rostest),
    **dict.fromkeys(_CATKIN_TESTS, partial(add_from_sources, TargetKind.EXECUTABLE)),
    **dict.fromkeys(_PYTHON_MODULE, partial(add_from_sources, TargetKind.LIBRARY)),
    "target_sources": add_sources,
    "target_link_libraries": link_libraries,
    "target_compile_definitions": add_target_definitions,
    "target_compile_options": add_target_definitions,
    "add_definitions": add_folder_definitions,
    "add_compile_options": add_folder_definitions,
    "add_compile_definitions": add_folder_definitions,
    "remove_definitions": remove_definitions,
    "set_target_properties": set_properties,
    "set_property": set_property,
    "include_directories": include_directories,
    "target_include_directories": include_directories,
    "find_package": find_package,
    "catkin_package": catkin_package,
    "install": record_install,
    "catkin_install_python": record_install,
}
