"""Ids of plugins that requests and behavior trees ask a server for, and that it does not have."""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping

from rtron.sources.static.common.frames import node_name
from rtron.sources.static.common.node_part import NodePart
from rtron.vocabulary import WiringFact, WiringFactKind


def missing_plugins(parts: Iterable[NodePart]) -> Iterator[WiringFact]:
    """Yield a fact for each id that is asked for, while the one server there has others alone.

    Ids are known if the names of all plugins of the server are.
    """
    servers: dict[str, dict[str, NodePart]] = defaultdict(dict)
    requests: dict[str, list[NodePart]] = defaultdict(list)
    for part in parts:
        for each in part.interface.plugin_ids:
            if each.is_request:
                requests[each.name].append(part)
            else:
                field, _, plugin = each.name.rpartition("/")
                servers[field][plugin] = part
    for name, requesting in sorted(requests.items()):
        field, _, plugin = name.rpartition("/")
        if _is_missing(plugin, servers.get(field, {})):
            yield _fact(name, requesting, servers[field])


def _is_missing(plugin: str, offered: Mapping[str, NodePart]) -> bool:
    is_known = len({node_name(part) for part in offered.values()}) == 1
    return is_known and plugin not in offered and not any("{" in each for each in offered)


def _fact(name: str, requesting: list[NodePart], offered: Mapping[str, NodePart]) -> WiringFact:
    server = next(iter(offered.values()))
    return WiringFact(
        kind=WiringFactKind.MISSING_PLUGIN,
        subject=name,
        value=node_name(server),
        others=tuple(sorted(offered)),
        evidence=tuple(part.node.evidence for part in (*requesting, server)),
    )
