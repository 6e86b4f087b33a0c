"""An included launch file gets an argument that was meant for another one.

## What it finds

In ROS 2 an inclusion has no scope of its own: what one included file is given, or has as a default,
stays set for the files after it. One that declares an argument of the same name then does not get
its own default.

For example, `front.launch.py` and `rear.launch.py` each declare `scan_topic` with another default:
both lidars publish `front/scan`. So does a namespace stay that a file pushes outside of a group:
included twice, the second robot is in `/one/two`.

## What to do

Put each inclusion into a group (`GroupAction`, `<group>`), or give the argument to each.

## When it is silent

Where a value is not known, and for a switch that the file before was given, such as `use_sim_time`.
It is `pedantic` for a switch that it has as a default, and for other values that it was given,
unless it is the same file: they may be meant for both. So it is where the file that gets the value
does not itself use the argument.
"""

from collections.abc import Iterator
from pathlib import PurePath

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule
from rtron.findings.wiring_groups import fact_finding
from rtron.vocabulary import Certainty, Finding, WiringFact, WiringFactKind

_KINDS = {
    WiringFactKind.LEAKED_ARGUMENT: Certainty.LIKELY,
    WiringFactKind.POSSIBLE_LEAKED_ARGUMENT: Certainty.POSSIBLE,
}


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each argument of each file that gets the value of a file before it."""
    facts = [fact for fact in app.graph.wiring if fact.kind in _KINDS]
    yield from map(_finding, {(*fact.others[:1], fact.subject): fact for fact in facts}.values())


def _finding(fact: WiringFact) -> Finding:
    path, other_path, default, *_ = (*fact.others, "", "", "")
    file, other = (PurePath(each).name for each in (path, other_path))
    before = "its inclusion before" if path == other_path else other
    return fact_finding(
        RULE.name,
        fact,
        subject=f"{file}:{fact.subject}",
        summary=f"{file} gets {fact.subject} from {before}",
        cause=f"an inclusion has no scope: {fact.subject} is {fact.value} since {before}, and not "
        f"{default}, the default",
        remedy=f"put each inclusion into a group, or give {fact.subject} to {file}",
        certainty=_KINDS[fact.kind],
    )


RULE = FindingRule(
    name="leaked_argument",
    title="An included launch file gets an argument that was meant for another one",
    consequence="failure: likely for a default, and for one file included twice, else possible",
    since="0.1.0",
    check=check,
)
