"""Command lines as lists of words: those that a node starts, and a program's own."""

from collections.abc import Iterator

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.shell_script import launch_file_arguments, positional_words, split_words

_MIN_WORDS = 2
_ROS_TOOLS = frozenset({"roslaunch", "rosrun", "rostopic", "ros2", "rosbag"})
_ROS2_TOOLS = {"launch": "roslaunch", "run": "rosrun"}
"""The verbs of `ros2` that start nodes, and the commands of ROS 1 that take the same words."""
_ENDPOINT_VERBS = frozenset({"pub", "echo", "hz", "bw", "delay"})
_JOINING_VERBS = {
    "topic": {*_ENDPOINT_VERBS},
    "service": {"call", "echo"},
    "action": {"send_goal"},
    "component": {"load", "standalone"},
    "bag": {"play", "record"},
}
"""The verbs of `ros2` whose commands join nodes themselves."""
_SEPARATORS = frozenset({";", "&", "&&", "|", "||"})
_WRAPPERS = frozenset(
    [
        *("env", "exec", "nohup", "sudo", "time", "bash", "sh", "xterm", "gnome-terminal"),
        *("konsole", "terminator", "screen", "tmux", "new-session", "stdbuf", "nice", "python"),
        *("python2", "python3"),
    ]
)


def shell_words(command: str) -> list[str]:
    """Return a command line's words, separators of commands among them."""
    return split_words(command, ";&|")


def record_started(machine: AbstractMachine, words: list[str], at: Arguments) -> None:
    """Record what a command line starts; other commands are none of our business."""
    for tool, given in _tool_commands(words):
        _record_command(machine, tool, given, at)


def _record_command(machine: AbstractMachine, tool: str, given: list[str], at: Arguments) -> None:
    rest = [word for word in given if not word.startswith("-")]
    if tool == "ros2" and rest and rest[0] in _ROS2_TOOLS:
        _record_command(machine, _ROS2_TOOLS[rest[0]], given[1:], at)
    elif tool == "rostopic":
        _record_topic_tool(machine, given, at)
    elif tool in {"ros2", "rosbag"} and "{" not in "".join(rest[:_MIN_WORDS]):
        _note_command(machine, tool, rest, at)
    elif any("{" in word for word in (tool, *rest[:_MIN_WORDS])) or not rest:
        what = " ".join([tool, *rest[:_MIN_WORDS]])
        machine.recorder.add_unresolved(what, "the command is not known", at.evidence)
    elif tool == "rosrun" and len(rest) >= _MIN_WORDS:
        machine.recorder.add_start("/".join(rest[:2]), ("rosrun", *rest[2:]), at.evidence)
    elif tool == "roslaunch":
        machine.recorder.add_start(*launch_file_arguments(rest), at.evidence)


def _note_command(machine: AbstractMachine, tool: str, words: list[str], at: Arguments) -> None:
    """Note `ros2 topic pub …`, `rosbag record …`: what nodes these are is not told before."""
    implied = ["bag"] if tool == "rosbag" else []
    kind, verb, *_ = [*implied, *words, "", ""]
    if verb in _JOINING_VERBS.get(kind, ()):
        what, why = " ".join([tool, *words[:3]]), "what this command joins is not followed"
        machine.recorder.add_unresolved(what, why, at.evidence)


def _record_topic_tool(machine: AbstractMachine, words: list[str], at: Arguments) -> None:
    """Record `rostopic VERB TOPIC …`, a node whose name is another at every start."""
    named = positional_words(words)[:3]
    if named and named[0] not in _ENDPOINT_VERBS and "{" not in named[0]:
        return
    if len(named) < _MIN_WORDS or any("{" in word for word in named):
        what = " ".join(["rostopic", *named])
        machine.recorder.add_unresolved(what, "the command is not known", at.evidence)
        return
    started = ("rosrun", *words, "__name:=rostopic_*")
    machine.recorder.add_start("rostopic/rostopic", started, at.evidence)


def _tool_commands(words: list[str]) -> Iterator[tuple[str, list[str]]]:
    """Yield each tool that a command line runs, with its words; a shell's `-c` holds another."""
    words = [inner for word in words for inner in _inner_words(word)]
    while words:
        end = next((at for at, word in enumerate(words) if word in _SEPARATORS), len(words))
        command, words = words[:end], words[end + 1 :]
        while command and _is_prefix(command[0]):
            command.pop(0)
        tool = command[0].rpartition("/")[2] if command else ""
        if tool in _ROS_TOOLS or "{" in tool:
            yield tool, command[1:]


def _inner_words(word: str) -> list[str]:
    inner = shell_words(word) if " " in word else [word]
    program = inner[0].rpartition("/")[2] if inner else ""
    return inner if program in _ROS_TOOLS | _WRAPPERS else [word]


def _is_prefix(word: str) -> bool:
    return word.startswith("-") or "=" in word or word.rpartition("/")[2] in _WRAPPERS


def without_remappings(words: av.Value) -> av.ListValue:
    """Return the words without ROS 1's remappings among them."""
    items, certain = av.items_of(words)
    return av.list_of(
        (item for item in items if ":=" not in av.text_with_holes(item)), certain=certain
    )
