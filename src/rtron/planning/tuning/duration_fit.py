"""How much must be known before a duration of the plan changes, and to what.

The rules of thumb, the same for every duration that waits for somebody:

- It must last: 1.5 times what 999 of 1000 took, 1.25 times what the longest took, and three times
  the usual, rounded up to a number that a person likes to read. So nothing that was measured would
  have been cut off.
- It is made longer if at least `few` were measured and the need is above it.
- It is made shorter if at least `enough` were measured, the need is a fifth below it or more, and
  nothing objects: other flows of which too little is known, for instance.
- A silence is never made longer than `LONGEST_SILENCE`: a robot that goes on for longer without a
  word is for a person to look at.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from rtron.planning.tuning.formatting import number, round_up, told, written
from rtron.vocabulary import SECOND, DurationFigures, ProposalKind

FEW, ENOUGH = 20, 100
FEW_GOALS, ENOUGH_GOALS = 5, 20
LONGEST_SILENCE = 5 * SECOND
LONGEST_GOAL = 24 * 3600 * SECOND
SHORTEST = SECOND // 10
_USUAL = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class Bounds:
    """How many are few and enough, and the shortest and longest that may be proposed (ns)."""

    few: int = FEW
    enough: int = ENOUGH
    least: int = SHORTEST
    most: int = LONGEST_SILENCE


SILENCE = Bounds()
GOALS = Bounds(few=FEW_GOALS, enough=ENOUGH_GOALS, least=SECOND, most=LONGEST_GOAL)
WAITS = Bounds(most=LONGEST_GOAL)


@dataclass(frozen=True, slots=True, kw_only=True)
class Settled:
    """What becomes of a duration, and why."""

    kind: ProposalKind
    after: int
    why: str


def need(figures: DurationFigures) -> int:
    """Return how long (ns) to wait so that nothing that was measured is cut off, with a margin."""
    return max(3 * figures.p999 // 2, 5 * figures.max // 4, _USUAL * figures.p50)


def settle(
    before: int,
    measured: Sequence[DurationFigures],
    bounds: Bounds,
    *,
    objection: str = "",
) -> Settled:
    """Return what a duration becomes that must outlast all that was `measured`, by whom each.

    `objection` is what speaks against making it shorter.
    """
    known = [each for each in measured if each.count >= bounds.few]
    if not known:
        return _kept(before, f"too little to say anything: at least {bounds.few} are needed")
    if before == 0:
        return _kept(before, "0 s was chosen")
    wanted = max(round_up(max(map(need, known))), bounds.least)
    if wanted > before:
        return _longer(before, wanted, bounds)
    if 5 * wanted > 4 * before:
        return _kept(before, "it fits")
    if min(each.count for each in measured) < bounds.enough:
        objection = f"{bounds.enough} of each are needed"
    if objection:
        return _kept(before, f"not made shorter: {objection}")
    return Settled(kind=ProposalKind.CHANGE, after=wanted, why="")


def measures(figures: DurationFigures, what: str) -> str:
    """Return figures in words: `12 408 gaps, largest 0.31 s, p99.9 0.2 s, p50 0.1 s`."""
    counted = number(figures.count, what)
    if not figures.count:
        return f"no {what}s"
    quantiles = f"p99.9 {told(figures.p999)}, p50 {told(figures.p50)}"
    return f"{counted}, largest {told(figures.max)}, {quantiles}"


def _longer(before: int, wanted: int, bounds: Bounds) -> Settled:
    if wanted <= bounds.most:
        return Settled(kind=ProposalKind.CHANGE, after=wanted, why="")
    why = f"it would take {written(wanted)}, which is too long to go by itself"
    return Settled(kind=ProposalKind.LOOK, after=before, why=why)


def _kept(before: int, why: str) -> Settled:
    return Settled(kind=ProposalKind.KEEP, after=before, why=why)
