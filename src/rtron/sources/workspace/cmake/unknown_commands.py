"""Commands that RTron does not know: those that may make a program are noted."""

import re
from pathlib import PurePath

from rtron.sources.workspace.cmake.ament import AMENT_COMMANDS
from rtron.sources.workspace.cmake.build import COMPILED
from rtron.sources.workspace.cmake.command_call import CommandCall
from rtron.sources.workspace.cmake.targets import TARGET_COMMANDS

_MAKES_PROGRAM = re.compile("add_executable|_executable$|add_node|_node$|add_component|_component$")
_MAKES_NONE = re.compile(
    "lint|format|check|message|doc|tidy|uncrustify|copyright|translation|export|test|try_"
    "|^(?:source_group|set_source_files_properties|add_custom_\\w+|configure_file|add_dependencies)$"
)
TARGET_MAKERS = frozenset(
    name
    for name in (*TARGET_COMMANDS, *AMENT_COMMANDS)
    if name.startswith(("install", "catkin_install", "rclcpp_components"))
    or name.endswith(("_executable", "_library", "_module"))
)
"""The commands that make a program, or install one."""


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
