"""A node of the app where it runs, as roslaunch would start it."""

import shlex
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from rtron.sources.declaration import NodeSite
from rtron.sources.launch.common.expression import typed_argument
from rtron.sources.launch.common.yaml_tree import check_int_range
from rtron.vocabulary import Evidence, LaunchNode, Parameter, ParameterTree
from rtron.vocabulary.launch import canonical_name, resolve_name
from rtron.vocabulary.parameters import pattern_matches
from rtron.vocabulary.remap_rules import RemapRule

_ASSIGNMENT = ":="


@dataclass(frozen=True, slots=True, kw_only=True)
class AppNode:
    """A node, what it runs, and the line that starts it; `started_by` is a node or empty.

    In ROS 2 a component is loaded by `container`, `type` is its class then. `process_remap_rules`
    are the remap rules of its process as written, `is_uncertain` says that it starts on a condition
    not known. `parameter_places` says where a parameter of a name is set for the nodes that fit a
    pattern.
    """

    site: NodeSite
    package: str
    type: str
    evidence: Evidence
    started_by: str = ""
    container: str = ""
    process_remap_rules: tuple[RemapRule, ...] = ()
    is_uncertain: bool = False
    parameter_places: Mapping[tuple[str, str], Evidence] = field(
        default_factory=dict, compare=False, repr=False
    )

    @property
    def name(self) -> str:
        """The node's full name."""
        return self.site.name

    def places_of(self, node: str, parameter: str) -> tuple[Evidence, ...]:
        """Return where a parameter of a node of the process is set, and the line that starts it."""
        found = (
            place
            for (pattern, name), place in self.parameter_places.items()
            if name == parameter and pattern_matches(pattern, node)
        )
        return (*list(found)[-1:], self.evidence)

    @property
    def program(self) -> str:
        """What it runs: PACKAGE/PROGRAM."""
        return f"{self.package}/{self.type}"

    @property
    def origin(self) -> str:
        """Where the node comes from: the place, and the node that starts it if one does."""
        location = f"{self.evidence.file}:{self.evidence.line}"
        location = (
            f"{location} (on a condition that is not known)" if self.is_uncertain else location
        )
        return f"started by {self.started_by} ({location})" if self.started_by else location


def may_both_start(one: AppNode, other: AppNode) -> bool:
    """Return whether two places start nodes for sure: of conditions, one may exclude the other."""
    return one.evidence != other.evidence and not (one.is_uncertain or other.is_uncertain)


def node_of_launch(
    node: LaunchNode, file: str, parameters: ParameterTree, environ: Mapping[str, str]
) -> AppNode:
    """Return a launch file's node; remaps of its command line come before those of its element.

    `__ns:=` among its arguments counts; `__name:=` does not: roslaunch appends its own.
    """
    words = split_command_line(node.args)
    name = _name_with_namespace(node.name, words)
    element_remaps = [
        (resolve_name(r.written_source, name), resolve_name(r.written_target, name))
        for r in node.remaps
    ]
    site = NodeSite(
        name=name,
        args=words,
        parameters=add_argument_parameters(parameters, words, name, file),
        remaps=(*resolve_argument_remaps(words, name), *element_remaps),
        environ=tuple({**environ, **dict(node.environ)}.items()),
    )
    evidence = Evidence(file=file, line=node.line)
    return AppNode(
        site=site,
        package=node.package,
        type=node.type,
        evidence=evidence,
        is_uncertain=node.conditional,
    )


def _name_with_namespace(name: str, words: Iterable[str]) -> str:
    pairs = dict(word.split(_ASSIGNMENT, 1) for word in words if _ASSIGNMENT in word)
    namespace = pairs.get("__ns")
    return name if namespace is None else canonical_name(f"/{namespace}/{name.rpartition('/')[2]}")


def split_command_line(args: str) -> tuple[str, ...]:
    """Return the words of a command line; one that is quoted wrongly is split at blanks."""
    try:
        return tuple(shlex.split(args))
    except ValueError:
        return tuple(args.split())


def resolve_argument_remaps(words: Iterable[str], node: str) -> tuple[tuple[str, str], ...]:
    """Return the remaps among a command line's words, as they resolve at a node."""
    pairs = (word.split(_ASSIGNMENT, 1) for word in words if _ASSIGNMENT in word)
    return tuple(
        (resolve_name(name, node), resolve_name(target, node))
        for name, target in pairs
        if not name.startswith("_")
    )


def add_argument_parameters(
    parameters: ParameterTree, words: Iterable[str], node: str, file: str
) -> ParameterTree:
    """Return the parameters with those that a command line sets (`_name:=value`)."""
    pairs = [word.split(_ASSIGNMENT, 1) for word in words if _ASSIGNMENT in word]
    private = [pair for pair in pairs if pair[0].startswith("_") and not pair[0].startswith("__")]
    if not private:
        return parameters
    changed = ParameterTree(leaves=dict(parameters.leaves))
    for name, value in private:
        typed = check_int_range(typed_argument(value))
        parameter = Parameter(value=typed, evidence=Evidence(file=file))
        changed.set(f"{node}/{name[1:]}", parameter)
    return changed
