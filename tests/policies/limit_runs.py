"""Runs of a limit: velocities dense at each bound, and whether any gets through above it."""

import math
import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from rtron.policies import build_policy
from rtron.vocabulary import Decision, Flow, PolicyName, PolicySettings, StreamKind, Velocity

MESSAGES_AT_ONCE = 10_000
MOST_NAMED = 10
CLOSE = 1e-9
# Below, doubles have fewer digits than the curvature is kept to.
LEAST_EXACT = 1e-290
TINY, LEAST_NORMAL, HUGE = 5e-324, 2.2250738585072014e-308, 1.7976931348623157e308
HOSTILE = (0.0, TINY, 2 * TINY, 3 * TINY, 1e-310, LEAST_NORMAL, 1e-200, 1e200, HUGE / 2, HUGE)
NO_NUMBERS = (math.nan, math.inf, -math.inf)


def same(message):
    """Stand in for a codec that has nothing to do."""
    return message


def near(bound):
    """Return numbers at a bound and beside it."""
    return (bound, math.nextafter(bound, 0), math.nextafter(bound, math.inf))


def components(limit):
    """Return what a component of a velocity may be, of either sign: dense at the limit."""
    shares = (1, math.sqrt(1 / 2), math.sqrt(1 / 3), 0.5, 2, 10)
    bounds = [each for share in shares for each in near(limit * share) if math.isfinite(each)]
    return [sign * each for each in (*HOSTILE, *bounds) for sign in (1, -1)]


def velocities(limit: float, count: int, seed: int) -> Iterator[Velocity]:
    """Yield `count` velocities like those of a Twist: half of the components 0, one in 60 none."""
    rng = random.Random(seed)
    known = components(limit)
    usual = [rng.uniform(-3 * limit, 3 * limit) for _ in range(4 * len(known))]
    pool = [*known, *(each for each in usual if math.isfinite(each))]
    pool += NO_NUMBERS * (len(pool) // 85 + 1)
    pool += [0.0] * len(pool)
    while count > 0:
        some = min(count, MESSAGES_AT_ONCE)
        drawn = rng.choices(pool, k=6 * some)
        for at in range(0, 6 * some, 6):
            yield Velocity(tuple(drawn[at : at + 3]), tuple(drawn[at + 3 : at + 6]))
        count -= some


def constrain(limit: float):
    """Return the policy that keeps velocities of the flow `vflow` to a limit."""
    flows = (Flow(name="vflow", publisher="/any"),)
    kind = StreamKind.COMMAND
    return build_policy(
        PolicySettings(policy=PolicyName.CONSTRAIN, kind=kind, flows=flows, max_vel_limit=limit)
    )


@dataclass
class VerdictTally:
    """What became of many velocities; `wrong` names the first that were not as they must be."""

    passed: int = 0
    modified: int = 0
    dropped: int = 0
    violations: int = 0
    wrong: tuple[str, ...] = ()

    def note(self, what, *about):
        self.violations += 1
        if len(self.wrong) < MOST_NAMED:
            self.wrong = (*self.wrong, f"{what}: {about}")


def violations(
    count: int,
    seed: int,
    limit: float = 0.22,
    encode: Callable[[Velocity], object] = same,
    decode: Callable[[object], Velocity] = same,
    close: float = CLOSE,
) -> VerdictTally:
    """Give a policy `count` velocities, and look at all that it lets go on.

    Each is encoded, decoded, judged, encoded again if it was changed, and decoded.
    """
    report, judge = VerdictTally(), constrain(limit).verdict
    for now, velocity in enumerate(velocities(limit, count, seed)):
        requested = decode(encode(velocity))
        verdict = judge("vflow", requested, now)
        if verdict.decision is Decision.PASS:
            report.passed += 1
            if not requested.is_finite or requested.speed > limit:
                report.note("passed", requested)
        elif verdict.decision is Decision.MODIFY:
            report.modified += 1
            check_modified(requested, decode(encode(verdict.message)), limit, close, report)
        else:
            report.dropped += 1
            if requested.is_finite:
                report.note("dropped", requested)
    return report


def check_modified(requested, made, limit, close, report):
    if not made.is_finite or made.speed > limit or requested.speed <= limit:
        report.note("modified", requested, made)
    elif not alike(requested, made, close):
        report.note("bent", requested, made)


def alike(requested, made, close=CLOSE):
    """Tell whether one velocity is the other, scaled by one factor from 0 to 1."""
    before, after = (*requested.linear, *requested.angular), (*made.linear, *made.angular)
    pairs = [*zip(before, after, strict=True)]
    if any(a * m < 0 or abs(m) > abs(a) for a, m in pairs):
        return False
    factors = [m / a for a, m in pairs if a and abs(m) > LEAST_EXACT and abs(a) > LEAST_EXACT]
    return not factors or max(factors) - min(factors) <= close * max(factors)
