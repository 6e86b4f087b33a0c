"""How many coordination nodes a set of risks asks for (paper section 7.2, table of CNs)."""

from collections import Counter
from collections.abc import Iterable, Mapping

from rtron.vocabulary import CoordinationCount, Domain, Risk, RiskKind, RiskRole, TopicClass

_ALWAYS_SHOWN = (Domain.PERCEPTION, Domain.PLANNING, Domain.CONTROL)
_GENERAL = (RiskKind.GR_ST, RiskKind.GR_MT)


def count_coordination_nodes(
    risks: Iterable[Risk], classes: Mapping[str, TopicClass]
) -> CoordinationCount:
    """Count a GRCN for each topic of a general risk, and an fps_monitor for each image node.

    One RSRCN and one MSRCN serve a whole app. Drivers and Others stand in the count only if they
    have a GRCN; the paper's table has no such column.
    """
    all_risks = tuple(risks)
    topics = {topic for risk in all_risks if risk.kind in _GENERAL for topic in risk.topics}
    domains = Counter(classes[topic].domain for topic in topics)
    kinds = {risk.kind for risk in all_risks}
    return CoordinationCount(
        grcn={d: domains[d] for d in Domain if domains[d] or d in _ALWAYS_SHOWN},
        fps_monitor=len({n for risk in all_risks for n in risk.role_nodes.get(RiskRole.IMAGE, ())}),
        rsrcn=int(RiskKind.RSR in kinds),
        msrcn=int(RiskKind.MSR in kinds),
    )
