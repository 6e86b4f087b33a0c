"""Processes of a launch that are programs of packages (docs.ros.org: ExecutableInPackage)."""

from collections.abc import Iterator
from dataclasses import replace

from rtron.sources.launch.ros2.command_line import ROS2_RUN, split_template
from rtron.sources.launch.ros2.substitutions.substitution import SubstitutionEvaluator
from rtron.sources.launch.ros2.substitutions.template import (
    SubstitutionCall,
    Template,
    TemplateText,
)
from rtron.sources.launch.ros2.xml_yaml.element import Element

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
    if (
        not isinstance(call, SubstitutionCall)
        or call.name != _IN_PACKAGE
        or len(call.arguments) != 2
    ):  # noqa: PLR2004
        return process
    program, package = call.arguments
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
