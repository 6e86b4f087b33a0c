"""The commands that are carried out, and the variables that a package's CMake files begin with.

Of commands that are not known, those that may make a program are noted.
"""

import re
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
    "|^(?:source_group|set_source_files_properties|add_custom_\\w+|configure_file|add_dependencies)$"
)
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
    """Note a command that is not known and is given sources of the package, or makes a program."""
    if _MAKES_NONE.search(call.name):
        return
    sources = [word for word in call.words if PurePath(word).suffix.lower() in COMPILED]
    ours = [word for word in sources if call.build.files.is_file(call.scope.folder / word)]
    if not (ours or _MAKES_PROGRAM.search(call.name)):
        return
    of_source = f" of {PurePath(ours[0]).name}" if ours else ""
    what = f"{call.name}({' '.join(call.words[:1])} …)"
    call.add_unresolved(what, f"is not known here: what it makes{of_source} is missing")
