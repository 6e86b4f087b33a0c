"""What processes of a launch run beside programs: commands of a shell, and verbs of `ros2`.

docs.ros.org: launch, ExecuteProcess; the README files of ros2cli.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import groupby
from pathlib import Path

from rtron.sources.launch2.result import Start, StartKind
from rtron.sources.launch2.words import (
    RUN,
    parameters_in,
    remaps_in,
    run_node,
    special,
    split_words,
)

SILENT = frozenset({"gzclient", "sleep", "echo", "true", "cd", "source", ".", "export", "wait"})
"""Commands that join nothing; Gazebo's client draws the world."""
_SHELLS = frozenset({"bash", "sh", "dash", "zsh"})
_BETWEEN = frozenset({"&&", "||", ";", "|", "&"})
_VERBS: Mapping[str, frozenset[str]] = {
    "topic": frozenset({"pub", "echo", "hz", "bw", "delay"}),
    "service": frozenset({"call"}),
    "action": frozenset({"send_goal"}),
    "bag": frozenset({"play", "record"}),
}


def commands(process: Start) -> Iterator[Start]:
    """Yield a process for each command of a shell's line; another process as it is."""
    for is_between, group in groupby(process.arguments, _BETWEEN.__contains__):
        words = tuple(group)
        script = _script(words)
        if script:
            yield from commands(replace(process, arguments=script))
        elif not is_between:
            yield replace(process, arguments=words)


def _script(words: Sequence[str]) -> tuple[str, ...]:
    """Return the words of the script that a shell is given (`bash -c SCRIPT`); none for another."""
    if Path(words[0]).name not in _SHELLS:
        return ()
    flag = next((at for at, word in enumerate(words) if _takes_script(word)), len(words))
    return tuple(split_words("".join(words[flag + 1 : flag + 2])))


def joining(process: Start) -> Start | None:
    """Return the node that a command is: of `ros2 run`, or of a verb; None for another one."""
    program, *words = process.arguments or ("",)
    if Path(program).name != RUN[0]:
        return None
    if words[:1] == [RUN[1]]:
        node = run_node(process)
        return replace(node, sources=tuple(parameters_in(node.arguments, node.evidence)))
    kind, verb, *rest = (*words, "", "")
    return _verb(process, kind, verb, rest[:-2]) if verb in _VERBS.get(kind, ()) else None


def _verb(process: Start, kind: str, verb: str, words: Sequence[str]) -> Start:
    """Return a verb's node: its package is called after its kind."""
    remaps = tuple(remaps_in(words))
    return replace(
        process,
        kind=StartKind.NODE,
        package=f"{RUN[0]}{kind}",
        program=verb,
        arguments=tuple(words),
        name=special(words, "__node"),
        namespace=special(words, "__ns") or "/",
        remaps=remaps,
        shared=len(remaps),
    )


def _takes_script(word: str) -> bool:
    return word.startswith("-") and not word.startswith("--") and word.endswith("c")
