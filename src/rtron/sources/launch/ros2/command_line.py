"""The words of a command line, as far as they are ROS 2's own (docs.ros.org: ROS arguments)."""

import shlex
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import PurePath

from rtron.sources.launch.ros2.parameters.file import yaml_value
from rtron.sources.launch.ros2.parameters.merge import ALL, ParameterSource
from rtron.sources.launch.ros2.result import Start, StartKind
from rtron.sources.launch.ros2.substitutions.template import Pieces, shown, with_holes
from rtron.vocabulary import Evidence
from rtron.vocabulary.parameters import Parameter
from rtron.vocabulary.remap_rules import Rule, rules_in

RUN = ("ros2", "run")
_BLANK = "\ue002"
_REMAP, _PARAMETER = frozenset({"-r", "--remap"}), frozenset({"-p", "--param"})


def split_words(text: str) -> list[str]:
    """Return the words of a command line; a hole is in one of them."""
    whole = with_holes(text, lambda name: name.replace(" ", _BLANK))
    try:
        words = shlex.split(whole)
    except ValueError:
        words = whole.split()
    return [word.replace(_BLANK, " ") for word in words]


def split_pieces(pieces: Pieces) -> list[Pieces]:
    """Return the words of a command line before it is evaluated: what a call gives stays whole.

    A blank beside a call ends the word that it stands in (launch: ExecuteProcess).
    """
    found: list[Pieces] = []
    word: Pieces = ()
    for piece in pieces:
        if not isinstance(piece, str):
            word = (*word, piece)
            continue
        if piece[:1].isspace() and word:
            found, word = [*found, word], ()
        first, *others = split_words(piece) or [""]
        for other in others:
            found, word = [*found, (*word, *filter(None, [first]))], ()
            first = other
        word = (*word, first) if first else word
        if piece[-1:].isspace() and word:
            found, word = [*found, word], ()
    return [*found, word] if word else found


def remaps_in(words: Sequence[str]) -> Iterator[Rule]:
    """Yield the remap rules among the arguments of a node, which count before all others."""
    return rules_in(shlex.join(words), ros=False)


def special(words: Sequence[str], key: str) -> str:
    """Return what `-r __node:=…` or `-r __ns:=…` says; empty if there is none."""
    for word, value in pairwise(words):
        if word in _REMAP and value.startswith(f"{key}:="):
            return shown(value.partition(":=")[2])
    return ""


def parameters_in(words: Sequence[str], place: Evidence) -> Iterator[ParameterSource]:
    """Yield the parameters among the arguments of a node."""
    for word, value in pairwise(words):
        name, given, text = value.partition(":=")
        if word in _PARAMETER and given:
            parameter = Parameter(value=yaml_value(text), evidence=place)
            yield ParameterSource(entries=((ALL, {name: parameter}),))


def is_run(words: Sequence[str]) -> bool:
    """Tell whether a command is `ros2 run`."""
    return len(words) > 1 and (PurePath(words[0]).name, words[1]) == RUN


def run_node(process: Start) -> Start:
    """Return the node that a process `ros2 run package executable …` is, without parameters."""
    package, program, *words = (*process.arguments[len(RUN) :], "", "")
    arguments = tuple(word for word in words if word)
    return replace(
        process,
        kind=StartKind.NODE,
        package=package,
        program=program,
        arguments=arguments,
        name=special(arguments, "__node"),
        namespace=special(arguments, "__ns") or "/",
        remaps=tuple(remaps_in(arguments)),
        shared=len(tuple(remaps_in(arguments))),
    )
