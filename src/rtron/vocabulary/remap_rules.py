"""How ROS 2 expands names and reads remap rules (design.ros2.org: topic and service names).

rcl's rules, which are other ones than those of ROS 1: the first that matches a name counts, none is
applied to what another gave, and each may be for one node only.
"""

import re
import shlex
from collections.abc import Iterable, Iterator
from itertools import pairwise
from typing import TypeAlias

from rtron.vocabulary.launch import Remap, canonical_name

UNKNOWN_NAME = "*"
"""Stands for a name, or a namespace, that only the running launch knows."""

RemapRule: TypeAlias = tuple[str, str]
"""A remap rule: what is led, which may begin with a node's name, and where to."""

_RULE = re.compile(r"(?:(\w+):(?!//))?(.+?):=(.+)")
_SCHEME = re.compile(r"ros(topic|service)://")


def expand_name(name: str, node: str) -> str:
    """Return a name as rcl expands it at a node, before remapping."""
    namespace, _, base = node.rpartition("/")
    name = _SCHEME.sub("", name)
    for placeholder, value in (("{node}", base), ("{namespace}", namespace), ("{ns}", namespace)):
        name = name.replace(placeholder, value)
    if name.startswith("~"):
        return canonical_name(node + name[1:])
    return canonical_name(name if name.startswith("/") else f"{namespace}/{name}")


def parse_remap_rules(text: str, *, in_ros_args: bool) -> Iterator[RemapRule]:
    """Yield the remap rules in a node's arguments, which count before all others.

    `in_ros_args` says that the arguments begin as ROS arguments.
    """
    try:
        arguments = shlex.split(text)
    except ValueError:
        arguments = text.split()
    for argument, following in pairwise([*arguments, ""]):
        in_ros_args = argument == "--ros-args" or (in_ros_args and argument != "--")
        remaps = in_ros_args and argument in {"-r", "--remap"}
        rule = _RULE.fullmatch(following) if remaps else None
        if rule and not rule[2].startswith("__"):
            yield f"{rule[1]}:{rule[2]}" if rule[1] else rule[2], rule[3]


def remaps_for_node(rules: Iterable[RemapRule], node: str) -> Iterator[Remap]:
    """Yield the rules that concern a node, in order; the first one for a name counts.

    Each may concern a node whose name is not known.
    """
    base = node.rpartition("/")[2]
    for written, target in rules:
        rule = _RULE.fullmatch(f"{written}:={target}")
        if rule and (rule[1] in {None, base} or base == UNKNOWN_NAME):
            yield Remap(
                written_source=written,
                written_target=target,
                source=expand_name(rule[2], node),
                target=expand_name(target, node),
            )
