"""How severe a finding is: what it leads to, and how sure that is.

| consequence | certain | likely | possible |
|---|---|---|---|
| motion: the robot moves when or as it must not, or does not stop | high | high | medium |
| failure: a part of the app does not get what it needs | medium | medium | low |
| oddity: nothing follows by itself | low | low | low |

It is one step milder where only your own nodes cause it. Low findings are shown from the level
`pedantic` on, unless their rule says otherwise.
"""

from collections.abc import Mapping

from rtron.vocabulary import Certainty, Consequence, Finding, FindingLevel, Severity

_SEVERITY: Mapping[Consequence, tuple[Severity, Severity, Severity]] = {
    Consequence.MOTION: (Severity.HIGH, Severity.HIGH, Severity.MEDIUM),
    Consequence.FAILURE: (Severity.MEDIUM, Severity.MEDIUM, Severity.LOW),
    Consequence.ODDITY: (Severity.LOW, Severity.LOW, Severity.LOW),
}


def severity_of(
    consequence: Consequence, certainty: Certainty, *, only_own_nodes: bool = False
) -> Severity:
    """Return how severe a finding is; one step milder where only the user's own nodes cause it."""
    severity = _SEVERITY[consequence][list(Certainty).index(certainty)]
    milder = list(Severity).index(severity) - 1
    return list(Severity)[max(milder, 0)] if only_own_nodes else severity


def level_of(severity: Severity) -> FindingLevel:
    """Return from which level on a finding is shown."""
    return FindingLevel.PEDANTIC if severity is Severity.LOW else FindingLevel.REGULAR


def shown_at(level: FindingLevel, finding: Finding) -> bool:
    """Return whether a finding is shown at a level."""
    levels = list(FindingLevel)
    return levels.index(finding.level) <= levels.index(level)
