"""The commands that are carried out, and the variables that a package's CMake files begin with.

Of commands that are not known, those that may make a program are noted.

A function takes arguments by their keywords as CMake's manual says of cmake_parse_arguments.
"""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import takewhile
from pathlib import Path, PurePath

from rtron.sources.workspace.cmake.build import COMPILED
from rtron.sources.workspace.cmake.command_call import (
    CommandCall,
    ExpandedArgument,
    VariableScope,
    VariableValue,
    split_by_keyword,
    split_list,
)
from rtron.sources.workspace.cmake.targets import TARGET_COMMANDS, add_target
from rtron.sources.workspace.cmake.variables import VARIABLE_COMMANDS, Handler
from rtron.sources.workspace.package_contents import ComponentClass, TargetKind

_WORDS = frozenset({"PLUGIN", "EXECUTABLE", "EXECUTOR", "RESOURCE_INDEX", "NODE_PREFIX"})
_COMPILED = ("*.c", "*.cc", "*.cpp", "*.cxx")


def register_components(call: CommandCall) -> None:
    """Carry out `rclcpp_components_register_nodes(target class …)`."""
    _note_unknown_class(call)
    found = split_by_keyword(call.words, _WORDS)[""]
    for cls in found[1:]:
        _add_component(call, found[0], cls, "")


def register_component(call: CommandCall) -> None:
    """Carry out `rclcpp_components_register_node(target PLUGIN class EXECUTABLE name)`."""
    _note_unknown_class(call)
    found = split_by_keyword(call.words, _WORDS)
    executable = next(iter(found.get("EXECUTABLE", [])), "")
    for target, cls in zip(found[""][:1], found.get("PLUGIN", [])[:1], strict=False):
        _add_component(call, target, cls, executable)


def _note_unknown_class(call: CommandCall) -> None:
    if not all(item.known for item in call.items):
        what = f"{call.name}({' '.join(call.words)[:80]})"
        call.add_unresolved(what, "some of it is not set in the file")


def _add_component(call: CommandCall, target: str, cls: str, executable: str) -> None:
    made = ComponentClass(class_name=cls.removeprefix("::"), library=target, executable=executable)
    for name in filter(None, (made.class_name, executable)):
        call.build.note_left_out(name)
    call.build.components[made.class_name, executable] = made


def export_plugins(call: CommandCall) -> None:
    """Carry out `pluginlib_export_plugin_description_file(package file)`."""
    words = call.words
    if len(words) > 1:
        call.build.exports[words[0], call.scope.folder / words[1]] = None


def link_packages(call: CommandCall) -> None:
    """Carry out `ament_target_dependencies(target package …)`."""
    words = call.words
    draft = call.build.targets.get(words[0]) if words else None
    if draft is not None:
        names = (word for word in words[1:] if word not in {"PUBLIC", "INTERFACE", "SYSTEM"})
        draft.links.update(dict.fromkeys(names))


def add_auto_target(kind: TargetKind, call: CommandCall) -> None:
    """Carry out `ament_auto_add_library` or `…_executable`, with all files below a DIRECTORY.

    Either links the libraries of its package that stand before it (ament_cmake_auto).
    """
    libraries = [d.name for d in call.build.targets.values() if d.kind is TargetKind.LIBRARY]
    add_target(kind, replace(call, items=tuple(_expand_directories(call))))
    draft = call.build.targets.get(call.words[0]) if call.words else None
    if draft is not None:
        draft.links.update(dict.fromkeys(libraries))


def _expand_directories(call: CommandCall) -> Iterator[ExpandedArgument]:
    items = list(call.items)
    while items:
        item = items.pop(0)
        if item.text == "DIRECTORY" and items:
            folder = call.scope.folder / items.pop(0).text
            found = (
                call.build.files.glob(f"{folder}/{p}", recursive=True, with_folders=False)
                for p in _COMPILED
            )
            yield from (replace(item, text=str(path)) for paths in found for path in paths)
        elif item.text != "NO_TARGET_LINK_LIBRARIES":
            yield item


AMENT_COMMANDS: Mapping[str, Handler] = {
    "rclcpp_components_register_nodes": register_components,
    "rclcpp_components_register_node": register_component,
    "pluginlib_export_plugin_description_file": export_plugins,
    "ament_target_dependencies": link_packages,
    "ament_auto_add_library": partial(add_auto_target, TargetKind.LIBRARY),
    "ament_auto_add_executable": partial(add_auto_target, TargetKind.EXECUTABLE),
}


_HEAD_LENGTH = 4
"""The prefix, and the options, keywords of one value and keywords of several."""


@dataclass(slots=True)
class _KeywordArguments:
    """What stands behind each keyword, and what behind none."""

    options: dict[str, bool]
    one: dict[str, ExpandedArgument | None]
    several: dict[str, list[ExpandedArgument]]
    rest: list[ExpandedArgument] = field(default_factory=list)

    def read(self, items: Iterable[ExpandedArgument]) -> None:
        """Take the arguments; one for a single value that has its value is behind none."""
        current = ""
        for item in items:
            if item.text in self.options:
                self.options[item.text] = True
                current = ""
            elif item.text in self.one or item.text in self.several:
                current = item.text
            elif current in self.several:
                self.several[current].append(item)
            elif current:
                self.one[current] = item
                current = ""
            else:
                self.rest.append(item)


def parse_arguments(call: CommandCall) -> None:
    """Carry out `cmake_parse_arguments`, also in its form for the caller's own arguments."""
    own = call.items[:1] and call.items[0].text == "PARSE_ARGV"
    head = call.items[2:] if own else call.items
    if len(head) < _HEAD_LENGTH:
        return
    given = _caller_arguments(call) if own else head[_HEAD_LENGTH:]
    options, one, several = (split_list(item.text) for item in head[1:_HEAD_LENGTH])
    parsed = _KeywordArguments(
        dict.fromkeys(options, False), dict.fromkeys(one), {w: [] for w in several}
    )
    parsed.read(given)
    for name, (text, known) in _result_variables(parsed, _known_arguments(call.scope)).items():
        call.set(f"{head[0].text}_{name}", text, known=known)


def _result_variables(
    parsed: _KeywordArguments, known_arguments: Mapping[str, bool]
) -> dict[str, tuple[str, bool]]:
    lists = {**parsed.several, "UNPARSED_ARGUMENTS": parsed.rest}
    lists.update((name, [item] if item else []) for name, item in parsed.one.items())
    flags = {name: (str(found).upper(), True) for name, found in parsed.options.items()}
    return {
        **flags,
        **{name: _joined_items(items, known_arguments) for name, items in lists.items()},
    }


def _joined_items(
    items: Sequence[ExpandedArgument], known_arguments: Mapping[str, bool]
) -> tuple[str, bool]:
    known = all(item.known or known_arguments.get(item.text, False) for item in items)
    return ";".join(item.text for item in items), known


def _known_arguments(scope: VariableScope) -> dict[str, bool]:
    """Return which arguments are known by themselves: of the list of all only all may be."""
    values = (scope.lookup(f"ARGV{index}") for index in range(32))
    return {value.text: value.known for value in values if value is not None}


def _caller_arguments(call: CommandCall) -> list[ExpandedArgument]:
    """Return the caller's own arguments, from the given index on."""
    start = call.items[1].text if call.items[1:] else ""
    value = call.scope.variables.get("ARGV", VariableValue(""))
    found = [ExpandedArgument(text=text, known=value.known) for text in split_list(value.text)]
    return found[int(start) :] if start.isdecimal() and len(start) < 3 else found  # noqa: PLR2004


PARSING_COMMANDS: Mapping[str, Handler] = {"cmake_parse_arguments": parse_arguments}


COMMANDS = {**VARIABLE_COMMANDS, **PARSING_COMMANDS, **TARGET_COMMANDS, **AMENT_COMMANDS}
_PLATFORM_VARIABLES = {
    **dict.fromkeys(("WIN32", "APPLE", "MSVC", "ANDROID", "CYGWIN", "MINGW", "IOS"), "0"),
    **dict.fromkeys(("UNIX", "CATKIN_ENABLE_TESTING", "CMAKE_COMPILER_IS_GNUCXX"), "1"),
    **dict.fromkeys(("CMAKE_SYSTEM_PROCESSOR", "CMAKE_HOST_SYSTEM_PROCESSOR"), "x86_64"),
    "CMAKE_SYSTEM_NAME": "Linux",
    "CMAKE_CXX_COMPILER_ID": "GNU",
}
_MAKES_PROGRAM = re.compile("add_executable|_executable$|add_node|_node$|add_component|_component$")
_MAKES_NONE = re.compile(
    "lint|format|check|message|doc|tidy|uncrustify|copyright|translation|export"
    "|test|gmock|benchmark|try_"
    "|^(?:source_group|set_source_files_properties|configure_file|add_dependencies)$"
)
_OWN_COMMANDS = frozenset({"add_custom_target", "add_custom_command"})
_MAKES_FILES = re.compile(
    "(?:ament|build_name|catkin|cmake|cs|cuda|enable|find|gen|generate|get|git|include|link|mark|pkg"
    "|pluginlib|project|protobuf|python|qt\\d?|roslaunch|rosidl|separate|set|site|target|use|xacro)"
    "(?:_|$)|add_(?:message|service|action)_files|add_link_options|install|write_"
)
"""Commands of CMake and of ROS that make no program, and are not carried out."""
TARGET_MAKERS = frozenset(
    name
    for name in (*TARGET_COMMANDS, *AMENT_COMMANDS)
    if name.startswith(("install", "catkin_install", "rclcpp_components"))
    or name.endswith(("_executable", "_library", "_module"))
)
"""The commands that make a program, or install one."""


def initial_variables(name: str, folder: Path) -> dict[str, VariableValue]:
    """Return the variables of a package before its first command."""
    variables = {
        **_PLATFORM_VARIABLES,
        **dict.fromkeys(("CMAKE_SOURCE_DIR", "CMAKE_CURRENT_SOURCE_DIR"), str(folder)),
        **dict.fromkeys(("PROJECT_SOURCE_DIR", "CMAKE_CURRENT_LIST_DIR"), str(folder)),
        **dict.fromkeys(("PROJECT_NAME", "CMAKE_PROJECT_NAME"), name),
        "CATKIN_PACKAGE_BIN_DESTINATION": f"lib/{name}",
        "CATKIN_PACKAGE_LIB_DESTINATION": "lib",
        "CATKIN_PACKAGE_SHARE_DESTINATION": f"share/{name}",
        "CATKIN_PACKAGE_INCLUDE_DESTINATION": f"include/{name}",
        "CATKIN_GLOBAL_BIN_DESTINATION": "bin",
    }
    return {variable: VariableValue(text) for variable, text in variables.items()}


def note_unknown_command(call: CommandCall) -> None:
    """Note a command that is not known and is given sources of the package, or makes a program.

    Another one may make programs whose names it does not say: the package is open then.
    """
    if call.name in _OWN_COMMANDS:
        call.build.is_open |= _may_make_program(call)
        return
    if _MAKES_NONE.search(call.name):
        return
    sources = [word for word in call.words if PurePath(word).suffix.lower() in COMPILED]
    ours = [word for word in sources if call.build.files.is_file(call.scope.folder / word)]
    if not (ours or _MAKES_PROGRAM.search(call.name)):
        call.build.is_open |= not _MAKES_FILES.match(call.name)
        return
    of_source = f" of {PurePath(ours[0]).name}" if ours else ""
    what = f"{call.name}({' '.join(call.words[:1])} …)"
    call.add_unresolved(what, f"is not known here: what it makes{of_source} is missing")


def _may_make_program(call: CommandCall) -> bool:
    """Return whether a command that the package writes itself may make a program.

    A file with an ending is none, nor is what documents or checks.
    """
    words = list(call.words)
    if call.name == "add_custom_target":
        return "COMMAND" in words and not _MAKES_NONE.search(words[0].lower())
    outputs = words[words.index("OUTPUT") + 1 :] if "OUTPUT" in words else ()
    made = takewhile(lambda word: not word.isupper(), outputs)
    return any(not PurePath(each).suffix for each in made)
