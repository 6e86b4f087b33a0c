"""How severe a finding is: what it leads to, and how sure that is.

| consequence | certain | likely | possible |
|---|---|---|---|
| motion: the robot moves when or as it must not, or does not stop | high | high | medium |
| failure: a part of the app does not get what it needs | medium | medium | low |
| oddity: nothing follows by itself | low | low | low |

A finding of low severity is shown from the level `pedantic` on, unless its rule says otherwise.
"""

from collections.abc import Mapping

from rtron.vocabulary import Certainty, Consequence, FindingLevel, Severity

_SEVERITY: Mapping[Consequence, tuple[Severity, Severity, Severity]] = {
    Consequence.MOTION: (Severity.HIGH, Severity.HIGH, Severity.MEDIUM),
    Consequence.FAILURE: (Severity.MEDIUM, Severity.MEDIUM, Severity.LOW),
    Consequence.ODDITY: (Severity.LOW, Severity.LOW, Severity.LOW),
}


def severity_of(consequence: Consequence, certainty: Certainty) -> Severity:
    """Return how severe a finding is."""
    return _SEVERITY[consequence][list(Certainty).index(certainty)]


def level_of(severity: Severity) -> FindingLevel:
    """Return from which level on a finding is shown."""
    return FindingLevel.PEDANTIC if severity is Severity.LOW else FindingLevel.REGULAR
