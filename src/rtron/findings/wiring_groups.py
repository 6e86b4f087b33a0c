"""The facts about an app's wiring, those of one subject together."""

from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from rtron.findings.rule import make_finding
from rtron.vocabulary import (
    Certainty,
    Consequence,
    Evidence,
    Finding,
    InteractionGraph,
    WiringFact,
    WiringFactKind,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class WiringGroup:
    """What the facts of one kind and subject say, each word and place once."""

    subject: str
    values: tuple[str, ...]
    others: tuple[str, ...]
    evidence: tuple[Evidence, ...]


def wiring_groups(graph: InteractionGraph, kind: WiringFactKind) -> Iterator[WiringGroup]:
    """Yield the facts of a kind by subject."""
    groups: dict[str, list[WiringFact]] = defaultdict(list)
    for fact in graph.wiring:
        if fact.kind is kind:
            groups[fact.subject].append(fact)
    for subject, facts in groups.items():
        yield WiringGroup(
            subject=subject,
            values=tuple(dict.fromkeys(fact.value for fact in facts)),
            others=tuple(dict.fromkeys(name for fact in facts for name in fact.others)),
            evidence=tuple(dict.fromkeys(place for fact in facts for place in fact.evidence)),
        )


def fact_finding(  # noqa: PLR0913 - a finding has so many parts, all by keyword
    rule: str,
    fact: WiringGroup | WiringFact,
    *,
    summary: str,
    cause: str,
    remedy: str,
    subject: str = "",
    certainty: Certainty = Certainty.LIKELY,
    meant: str = "",
    nodes: Iterable[str] = (),
    topics: Iterable[str] = (),
) -> Finding:
    """Return the finding that a part of the app fails, as facts say; its subject is theirs."""
    return make_finding(
        rule,
        subject or fact.subject,
        summary=summary,
        cause=cause,
        remedy=remedy,
        consequence=Consequence.FAILURE,
        certainty=certainty,
        meant=meant,
        nodes=nodes,
        topics=topics,
        evidence=fact.evidence,
    )
