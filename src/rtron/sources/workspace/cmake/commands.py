"""The commands that are carried out, and the variables that a package's CMake files begin with.

Of commands that are not known, those that may make a program are noted.
"""

import re
from itertools import takewhile
from pathlib import Path, PurePath

from rtron.sources.workspace.cmake.ament import AMENT_COMMANDS
from rtron.sources.workspace.cmake.build import COMPILED
from rtron.sources.workspace.cmake.command_call import CommandCall
from rtron.sources.workspace.cmake.keyword_arguments import PARSING_COMMANDS
from rtron.sources.workspace.cmake.targets import TARGET_COMMANDS
from rtron.sources.workspace.cmake.values import VariableValue
from rtron.sources.workspace.cmake.variables import VARIABLE_COMMANDS

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
