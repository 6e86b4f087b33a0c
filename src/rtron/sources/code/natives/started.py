"""What a node starts by a command line: `roslaunch PKG FILE`, `rosrun PKG TYPE`."""

import shlex

from rtron.sources.code.interpreter.arguments import Arguments
from rtron.sources.code.interpreter.machine import Machine

_MIN_WORDS = 2


def shell_words(command: str) -> list[str]:
    """Return a command line's words."""
    try:
        return shlex.split(command)
    except ValueError:
        return command.split()


def started_by_words(machine: Machine, words: list[str], at: Arguments) -> None:
    """Record what a command line starts; other commands are none of our business."""
    names = [word.rpartition("/")[2] for word in words]
    for tool in ("roslaunch", "rosrun"):
        if tool not in names:
            continue
        rest = [word for word in words[names.index(tool) + 1 :] if not word.startswith("-")]
        if any("{" in word for word in rest[:_MIN_WORDS]) or not rest:
            what = " ".join([tool, *rest[:_MIN_WORDS]])
            machine.recorder.unresolved(what, "the command is not known", at.evidence)
        elif tool == "rosrun" and len(rest) >= _MIN_WORDS:
            machine.recorder.start("/".join(rest[:2]), ("rosrun", *rest[2:]), at.evidence)
        elif tool == "roslaunch":
            machine.recorder.start(*_launch(rest), at.evidence)
        return


def _launch(words: list[str]) -> tuple[str, tuple[str, ...]]:
    if words[0].endswith((".launch", ".xml")) or len(words) == 1:
        return words[0], tuple(words[1:])
    return "/".join(words[:2]), tuple(words[2:])
