"""How the closed sets of words look and read in reports for people."""

from collections.abc import Mapping

from rtron.vocabulary import Risk, RiskKind, Severity

SEVERITY_STYLE: Mapping[Severity, str] = {
    Severity.HIGH: "bold red",
    Severity.MEDIUM: "yellow",
    Severity.LOW: "cyan",
}
KIND_TITLE: Mapping[RiskKind, str] = {
    RiskKind.GR_ST: "several nodes publish one topic",
    RiskKind.GR_MT: "one node obeys several topics of one type",
    RiskKind.RSR: "the robot may move faster than it sees",
    RiskKind.MSR: "an action may be taken under the wrong event",
}
MILDEST_LAST: tuple[Severity, ...] = tuple(reversed(Severity))


def worst_first(risk: Risk) -> int:
    """Return a sort key that puts high before medium before low."""
    return MILDEST_LAST.index(risk.severity)
