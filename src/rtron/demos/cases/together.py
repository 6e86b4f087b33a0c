"""The decisions of several cases as one developer would write them: one plan against them all."""

from collections.abc import Iterable

from rtron.demos.cases.case_study import Decisions


def merge_decisions(decisions_of_cases: Iterable[Decisions]) -> Decisions:
    """Return what is decided in any of them; of a topic's GRCN, all that is said of it."""
    found: Decisions = {}
    for decisions in decisions_of_cases:
        known = found.get("grcn", {})
        grcn_decisions = {
            topic: {**known.get(topic, {}), **of} for topic, of in decisions["grcn"].items()
        }
        found = {**found, **decisions, "grcn": {**known, **grcn_decisions}}
    return found
