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

UNKNOWN = "*"
"""Stands for a name, or a namespace, that only the running launch knows."""

Rule: TypeAlias = tuple[str, str]
"""A remap rule: what is led, which may begin with a node's name, and where to."""

_RULE = re.compile(r"(?:(\w+):(?!//))?(.+?):=(.+)")
_SCHEME = re.compile(r"ros(topic|service)://")


def expanded(name: str, node: str) -> str:
    """Return a name as rcl expands it at a node, before remapping."""
    space, _, base = node.rpartition("/")
    name = _SCHEME.sub("", name)
    for hole, value in (("{node}", base), ("{namespace}", space), ("{ns}", space)):
        name = name.replace(hole, value)
    if name.startswith("~"):
        return canonical_name(node + name[1:])
    return canonical_name(name if name.startswith("/") else f"{space}/{name}")


def rules_in(text: str, *, ros: bool) -> Iterator[Rule]:
    """Yield the remap rules in a node's arguments, which count before all others.

    `ros` says that the arguments begin as ROS arguments.
    """
    try:
        words = shlex.split(text)
    except ValueError:
        words = text.split()
    for word, following in pairwise([*words, ""]):
        ros = word == "--ros-args" or (ros and word != "--")
        rule = _RULE.fullmatch(following) if ros and word in {"-r", "--remap"} else None
        if rule and not rule[2].startswith("__"):
            yield f"{rule[1]}:{rule[2]}" if rule[1] else rule[2], rule[3]


def remaps_at(rules: Iterable[Rule], node: str) -> Iterator[Remap]:
    """Yield the rules that concern a node, in order; the first one for a name counts.

    Each may concern a node whose name is not known.
    """
    base = node.rpartition("/")[2]
    for written, target in rules:
        rule = _RULE.fullmatch(f"{written}:={target}")
        if rule and (rule[1] in {None, base} or base == UNKNOWN):
            yield Remap(
                written=written,
                written_target=target,
                declared=expanded(rule[2], node),
                target=expanded(target, node),
            )
