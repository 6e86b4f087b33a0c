"""A node of the app where it runs, as roslaunch would start it."""

import shlex
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from rtron.sources.declaration import NodeSite
from rtron.sources.launch.ros1.param_tag import converted
from rtron.vocabulary import Evidence, LaunchNode, Parameter, Parameters
from rtron.vocabulary.launch import canonical_name, resolve_name
from rtron.vocabulary.remap_rules import Rule

_ASSIGNED = ":="


@dataclass(frozen=True, slots=True, kw_only=True)
class AppNode:
    """A node, what it runs, and the line that starts it; `started_by` is a node or empty.

    In ROS 2 a component is loaded by `container`, `type` is its class then. `rules` are the remap
    rules of its process as written, `doubtful` says that it starts on a condition not known,
    `executed` that its launch file was run to find it.
    """

    site: NodeSite
    package: str
    type: str
    evidence: Evidence
    started_by: str = ""
    container: str = ""
    rules: tuple[Rule, ...] = ()
    doubtful: bool = False
    executed: bool = False

    @property
    def name(self) -> str:
        """The node's full name."""
        return self.site.name

    @property
    def origin(self) -> str:
        """Where the node comes from: the place, and the node that starts it if one does."""
        place = f"{self.evidence.file}:{self.evidence.line}"
        place = f"{place} (on a condition that is not known)" if self.doubtful else place
        place = f"{place} (executed)" if self.executed else place
        return f"started by {self.started_by} ({place})" if self.started_by else place


def launched_node(
    node: LaunchNode, file: str, parameters: Parameters, environ: Mapping[str, str]
) -> AppNode:
    """Return a launch file's node; remaps of its command line come before those of its element.

    `__ns:=` among its arguments counts; `__name:=` does not: roslaunch appends its own.
    """
    words = split_words(node.args)
    name = _named(node.name, words)
    given = [
        (resolve_name(r.written, name), resolve_name(r.written_target, name)) for r in node.remaps
    ]
    site = NodeSite(
        name=name,
        args=words,
        parameters=with_private(parameters, words, name, file),
        remaps=(*argument_remaps(words, name), *given),
        environ=tuple({**environ, **dict(node.environ)}.items()),
    )
    evidence = Evidence(file=file, line=node.line)
    return AppNode(site=site, package=node.package, type=node.type, evidence=evidence)


def _named(name: str, words: Iterable[str]) -> str:
    pairs = dict(word.split(_ASSIGNED, 1) for word in words if _ASSIGNED in word)
    namespace = pairs.get("__ns")
    return name if namespace is None else canonical_name(f"/{namespace}/{name.rpartition('/')[2]}")


def split_words(args: str) -> tuple[str, ...]:
    """Return the words of a command line; one that is quoted wrongly is split at blanks."""
    try:
        return tuple(shlex.split(args))
    except ValueError:
        return tuple(args.split())


def argument_remaps(words: Iterable[str], node: str) -> tuple[tuple[str, str], ...]:
    """Return the remaps among a command line's words, as they resolve at a node."""
    pairs = (word.split(_ASSIGNED, 1) for word in words if _ASSIGNED in word)
    return tuple(
        (resolve_name(name, node), resolve_name(target, node))
        for name, target in pairs
        if not name.startswith("_")
    )


def with_private(parameters: Parameters, words: Iterable[str], node: str, file: str) -> Parameters:
    """Return the parameters with those that a command line sets (`_name:=value`)."""
    pairs = [word.split(_ASSIGNED, 1) for word in words if _ASSIGNED in word]
    private = [pair for pair in pairs if pair[0].startswith("_") and not pair[0].startswith("__")]
    if not private:
        return parameters
    changed = Parameters(leaves=dict(parameters.leaves))
    for name, value in private:
        parameter = Parameter(value=converted(value, "auto"), evidence=Evidence(file=file))
        changed.set(f"{node}/{name[1:]}", parameter)
    return changed
