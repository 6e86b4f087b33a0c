"""What processes of a launch join beside programs: verbs of `ros2`.

The README files of ros2cli.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from rtron.sources.launch.ros2.command_line import argument_remaps, special_remap
from rtron.sources.launch.ros2.result import LaunchStart, StartKind

_COMMANDS_WITHOUT_NODE = frozenset(
    {"gzclient", "sleep", "echo", "true", "cd", "source", ".", "export", "wait"}
)
"""Commands that join nothing; Gazebo's client draws the world."""
_ROS2 = "ros2"
_VERBS: Mapping[str, frozenset[str]] = {
    "topic": frozenset({"pub", "echo", "hz", "bw", "delay"}),
    "service": frozenset({"call"}),
    "action": frozenset({"send_goal"}),
    "bag": frozenset({"play", "record"}),
}


def joins_nothing(command: Sequence[str]) -> bool:
    """Tell whether a command joins nothing; one that runs others in its words may."""
    runs_others = any("`" in word or "$(" in word for word in command)
    return not runs_others and Path("".join(command[:1])).name in {"", *_COMMANDS_WITHOUT_NODE}


def ros2_verb_node(process: LaunchStart) -> LaunchStart | None:
    """Return the node that a verb of `ros2` is; None for another command."""
    program, kind, verb, *words = (*process.arguments, "", "", "")
    if Path(program).name != _ROS2 or verb not in _VERBS.get(kind, ()):
        return None
    return _verb_node(process, kind, verb, words[:-3])


def _verb_node(process: LaunchStart, kind: str, verb: str, words: Sequence[str]) -> LaunchStart:
    """Return a verb's node: its package is called after its kind."""
    remaps = tuple(argument_remaps(words))
    return replace(
        process,
        kind=StartKind.NODE,
        package=f"{_ROS2}{kind}",
        program=verb,
        arguments=tuple(words),
        name=special_remap(words, "__node"),
        namespace=special_remap(words, "__ns") or "/",
        remaps=remaps,
        global_remap_count=len(remaps),
    )
