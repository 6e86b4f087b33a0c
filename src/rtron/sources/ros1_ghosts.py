"""Ghost publishers of ROS 1: connected to a subscriber, and not in the master's list."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from rtron.sources.live.ros1.replies import Incoming, Pair
from rtron.sources.ros1_node import NodeAnswers
from rtron.vocabulary import Evidence, Unresolved


@dataclass(frozen=True, slots=True)
class Suspect:
    """A connection of a node's whose other end the master did not list."""

    node: str
    link: Incoming


def suspects(nodes: Mapping[str, NodeAnswers], publishers: Iterable[Pair]) -> tuple[Suspect, ...]:
    """Return the connections from addresses that no publisher of their topic has."""
    listed = _listed(publishers, {name: answers.uri for name, answers in nodes.items()})
    return tuple(
        Suspect(name, link)
        for name, answers in nodes.items()
        for link in dict.fromkeys(answers.incoming)
        if (link.topic, _plain(link.source)) not in listed
    )


def still_unlisted(
    suspects: Iterable[Suspect], publishers: Iterable[Pair], uris: Mapping[str, str]
) -> Iterator[Unresolved]:
    """Yield an entry for each suspect that the master, asked again, does not list either."""
    listed = _listed(publishers, uris)
    for suspect in suspects:
        if (suspect.link.topic, _plain(suspect.link.source)) not in listed:
            yield _ghost(suspect.node, suspect.link)


def _listed(publishers: Iterable[Pair], uris: Mapping[str, str]) -> set[tuple[str, str]]:
    return {(topic, _plain(uris.get(node, ""))) for topic, node in publishers if uris.get(node)}


def _plain(uri: str) -> str:
    return uri.rstrip("/").lower()


def _ghost(node: str, link: Incoming) -> Unresolved:
    source = link.source or "an unknown address"
    why = f"takes messages on {link.topic} from {source}, which the master does not know"
    return Unresolved(what=node, why=why, evidence=(Evidence(file=source),))
