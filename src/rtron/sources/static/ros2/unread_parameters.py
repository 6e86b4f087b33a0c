"""Parameters that a launch sets in vain: not declared, of another type, or for no node's name."""

from collections import defaultdict
from collections.abc import Container, Iterable, Iterator, Sequence
from difflib import get_close_matches
from itertools import islice
from pathlib import PurePath

from rtron.sources.launch.ros2.result import LaunchStart
from rtron.sources.static.common.frames import node_name
from rtron.sources.static.common.node_part import NodePart
from rtron.sources.static.common.topic_parameters import near_parameters, unread_parameter
from rtron.sources.static.ros2.app_nodes import process_name
from rtron.vocabulary import WiringFact, WiringFactKind
from rtron.vocabulary.names import fits_open_name
from rtron.vocabulary.parameters import absolute_pattern, pattern_matches
from rtron.vocabulary.remap_rules import expand_name

_OF_EVERY_NODE = ("use_sim_time", "qos_overrides.", "start_type_description_service")
"""What the client libraries declare or read by themselves."""
_NEAR_RATIO = 0.8
_ITS_TYPE = ".type"
_MOST_SECTIONS = 200


def unread_parameters(parts: Iterable[NodePart]) -> Iterator[WiringFact]:
    """Yield a fact for each parameter that a launch sets without effect, with the near name.

    A near name is one that the node declares and the launch does not set. A node counts if its
    source was read whole and declares parameters, all with known names. A file is often given to
    several nodes: a parameter counts if no node declares it, and one that is set for all (`/**`) if
    this one declares a near name.
    """
    read = [part for part in parts if part.task and not part.interface.unresolved]
    declared: dict[str, set[str]] = defaultdict(set)
    for part in read:
        for each in part.interface.parameters:
            declared[each.node].add(each.name)
    everywhere = set().union(*declared.values())
    for part in read:
        for node in _nodes_with_parameters(part):
            set_by_launch = _set_by_launch(part, node)
            unread = [name for name in set_by_launch if not _is_read(name, everywhere)]
            near = near_parameters(unread, declared[node] - set_by_launch.keys())
            for name in unread:
                if name in near or set_by_launch[name]:
                    yield unread_parameter(
                        node, name, near.get(name), *part.node.places_of(node, name)
                    )


def mistyped_parameters(parts: Iterable[NodePart]) -> Iterator[WiringFact]:
    """Yield a fact for each parameter that is given another type than its node declares."""
    for part in parts:
        for each in part.interface.mistyped:
            yield WiringFact(
                kind=WiringFactKind.MISTYPED_PARAMETER,
                subject=each.node,
                value=each.name,
                others=(each.declared_type, each.given_type),
                evidence=(*part.node.places_of(each.node, each.name), each.evidence),
            )


def malformed_files(starts: Iterable[LaunchStart]) -> Iterator[WiringFact]:
    """Yield a fact for each parameter file without `ros__parameters`, and each node given it."""
    for start in starts:
        for source in start.parameter_sources:
            if source.is_malformed:
                yield WiringFact(
                    kind=WiringFactKind.MALFORMED_PARAMETER_FILE,
                    subject=source.file,
                    others=(process_name(start),),
                    evidence=(start.evidence,),
                )


def sections_without_node(
    parts: Sequence[NodePart], nodes: set[str], known_names: Container[str]
) -> Iterator[WiringFact]:
    """Yield a fact for each section of a parameter file for a name that no node has.

    It counts if a node that is given no parameter of its own has a near name, or if one alone of
    these is given the file and is called so by its program. So it does if one node alone declares
    most of what stands in the section, and has nothing else of the file. One of `known_names`, of
    programs that RTron has models of, is near to no other. A controller, which the manager has a
    type of, may be loaded later.
    """
    places = {
        each.node: part.node.places_of(each.node, each.name)
        for part in reversed(parts)
        for each in reversed(part.node.site.node_settings)
    }
    given = {
        node_name(part)
        for part in parts
        for name in _set_by_launch(part, node_name(part))
        if not name.startswith(_OF_EVERY_NODE)
    }
    without_section = {name for name in nodes - places.keys() - given if "{" not in name}
    declared = _declared_in_vain(parts, without_section)
    typed = {
        each.name.removesuffix(_ITS_TYPE)
        for part in parts
        for each in part.node.site.node_settings
        if each.name.endswith(_ITS_TYPE)
    }
    unused = (
        each
        for each in sorted(places.keys() - nodes)
        if "*" not in each and _plain_name(each) not in typed
    )
    for section in islice(unused, _MOST_SECTIONS):
        near = get_close_matches(section, sorted(without_section), 1, _NEAR_RATIO)
        own = _plain_name(section)
        near = [each for each in near if own not in known_names or _plain_name(each) == own]
        meant = declared.get(section) or near
        if len(meant) == 1 and not fits_open_name(section, nodes):
            yield WiringFact(
                kind=WiringFactKind.SECTION_WITHOUT_NODE,
                subject=section,
                others=tuple(meant),
                evidence=places[section],
            )


def _declared_in_vain(
    parts: Iterable[NodePart], without_section: Container[str]
) -> dict[str, set[str]]:
    """Return which nodes are given each section of a file and declare most of it, or have its name.

    One common name, as a frame or a rate, says little: two of them must be declared. A program
    has the name of a section if it calls itself so where no launch gives it another name, or if
    its file is called so.
    """
    found: dict[str, set[str]] = defaultdict(set)
    for part in parts:
        node = node_name(part)
        own = {each.name for each in part.interface.parameters if each.node == node}
        sections: dict[tuple[str, str], set[str]] = defaultdict(set)
        for each in part.node.site.node_settings if "{" not in node else ():
            if not each.name.startswith(_OF_EVERY_NODE):
                key = absolute_pattern(each.node), each.name
                place = part.node.parameter_places.get(key, part.node.evidence)
                sections[each.node, place.file].add(each.name)
        used = {file for section, file in sections if pattern_matches(section, node)}
        for (section, file), names in sections.items():
            is_declared = file not in used and len(names & own) > max(1, len(names) / 2)
            is_named = node in without_section and section in _program_names(part)
            if is_declared or is_named:
                found[section].add(node)
    return found


def _program_names(part: NodePart) -> set[str]:
    """Return the node of a program's name, and of those that its model says it gives itself."""
    names = {PurePath(part.node.type).stem}
    names |= {part.model.name, *part.model.former} if part.model else set()
    return {expand_name(name, node_name(part)) for name in names - {""}}


def _plain_name(node: str) -> str:
    return node.rpartition("/")[2]


def _nodes_with_parameters(part: NodePart) -> list[str]:
    """Return the nodes with parameters of their own, and none whose name is not known."""
    own = [p for p in part.interface.parameters if not p.name.startswith(_OF_EVERY_NODE)]
    open_nodes = {parameter.node for parameter in own if "{" in parameter.name}
    return [node for node in dict.fromkeys(p.node for p in own) if node not in open_nodes]


def _set_by_launch(part: NodePart, node: str) -> dict[str, bool]:
    """Return the parameters that a launch sets for a node, and whether for this one alone."""
    site = part.node.site
    fitting = (each for each in site.node_settings if pattern_matches(each.node, node))
    found: dict[str, bool] = {}
    for each in fitting:
        found[each.name] = found.get(each.name, False) or "*" not in each.node
    return found | {name: True for name, _ in site.overrides}


def _is_read(name: str, declared: set[str]) -> bool:
    is_group = any(each.startswith(f"{name}.") for each in declared)
    return name in declared or is_group or name.startswith(_OF_EVERY_NODE)
