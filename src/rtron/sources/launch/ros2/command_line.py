"""The words of a command line, as far as they are ROS 2's own (docs.ros.org: ROS arguments)."""

import shlex
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import PurePath

from rtron.sources.launch.ros2.parameters.file import parse_value
from rtron.sources.launch.ros2.parameters.merge import ALL_NODES, ParameterSource
from rtron.sources.launch.ros2.result import LaunchStart, StartKind
from rtron.sources.launch.ros2.substitutions.substitution import SubstitutionEvaluator
from rtron.sources.launch.ros2.substitutions.template import (
    SubstitutionCall,
    Template,
    TemplateText,
    display_text,
    map_placeholders,
)
from rtron.sources.launch.ros2.xml_yaml import Element
from rtron.vocabulary import Evidence
from rtron.vocabulary.parameters import Parameter
from rtron.vocabulary.remap_rules import RemapRule, parse_remap_rules

ROS2_RUN = ("ros2", "run")
_BLANK_MARK = "\ue002"
_REMAP, _PARAMETER = frozenset({"-r", "--remap"}), frozenset({"-p", "--param"})


def split_words(text: str) -> list[str]:
    """Return the words of a command line; a hole is in one of them."""
    protected = map_placeholders(text, lambda name: name.replace(" ", _BLANK_MARK))
    try:
        words = shlex.split(protected)
    except ValueError:
        words = protected.split()
    return [word.replace(_BLANK_MARK, " ") for word in words]


def split_template(template: Template) -> list[Template]:
    """Return the words of a command line before it is evaluated: what a call gives stays whole.

    A blank beside a call ends the word that it stands in (launch: ExecuteProcess).
    """
    words: list[Template] = []
    word: Template = ()
    for part in template:
        if not isinstance(part, str):
            word = (*word, part)
            continue
        if part[:1].isspace() and word:
            words, word = [*words, word], ()
        first, *others = split_words(part) or [""]
        for other in others:
            words, word = [*words, (*word, *filter(None, [first]))], ()
            first = other
        word = (*word, first) if first else word
        if part[-1:].isspace() and word:
            words, word = [*words, word], ()
    return [*words, word] if word else words


def argument_remaps(words: Sequence[str]) -> Iterator[RemapRule]:
    """Yield the remap rules among the arguments of a node, which count before all others."""
    return parse_remap_rules(shlex.join(words), in_ros_args=False)


def special_remap(words: Sequence[str], key: str) -> str:
    """Return what `-r __node:=…` or `-r __ns:=…` says; empty if there is none."""
    for word, value in pairwise(words):
        if word in _REMAP and value.startswith(f"{key}:="):
            return display_text(value.partition(":=")[2])
    return ""


def argument_parameters(words: Sequence[str], location: Evidence) -> Iterator[ParameterSource]:
    """Yield the parameters among the arguments of a node."""
    for word, value in pairwise(words):
        name, assignment, text = value.partition(":=")
        if word in _PARAMETER and assignment:
            parameter = Parameter(value=parse_value(text), evidence=location)
            yield ParameterSource(entries=((ALL_NODES, {name: parameter}),))


def is_ros2_run(words: Sequence[str]) -> bool:
    """Tell whether a command is `ros2 run`."""
    return len(words) > 1 and (PurePath(words[0]).name, words[1]) == ROS2_RUN


def node_of_ros2_run(process: LaunchStart) -> LaunchStart:
    """Return the node that a process `ros2 run package executable …` is, without parameters."""
    package, program, *words = (*process.arguments[len(ROS2_RUN) :], "", "")
    arguments = tuple(word for word in words if word)
    return replace(
        process,
        kind=StartKind.NODE,
        package=package,
        program=program,
        arguments=arguments,
        name=special_remap(arguments, "__node"),
        namespace=special_remap(arguments, "__ns") or "/",
        remaps=tuple(argument_remaps(arguments)),
    )


_IN_PACKAGE = "exec-in-pkg"


def as_ros2_run(process: Element) -> Element:
    """Return a process as `ros2 run` starts it, if its first word is a program of a package.

    Where the program is installed is not known before a build, and need not be.
    """
    try:
        words = list(_process_words(process))
    except ValueError:
        return process
    first = words[0] if words else ()
    call = first[0] if len(first) == 1 else None
    if not isinstance(call, SubstitutionCall) or call.name != _IN_PACKAGE:
        return process
    try:
        program, package = call.arguments
    except ValueError:
        return process
    all_words = (*((word,) for word in ROS2_RUN), package, program, *words[1:])
    listed = (Element("cmd", {"value": word}, line=process.line) for word in all_words)
    other_children = (child for child in process.children if child.tag != "cmd")
    attributes = {key: text for key, text in process.attributes.items() if key != "cmd"}
    return replace(process, attributes=attributes, children=(*listed, *other_children))


def _process_words(process: Element) -> Iterator[Template]:
    """Yield the words of a process; raise ValueError where one is malformed."""
    yield from split_template(_parse_template(process.attributes.get("cmd", "")))
    for word in process.children_named("cmd"):
        yield _parse_template(word.attributes.get("value", ""))


def _parse_template(text: TemplateText) -> Template:
    return SubstitutionEvaluator({}).parse(text)
