"""A motion command reaches nobody.

## What it finds

Nobody subscribes to a topic that commands motion, and a node obeys another topic of its type, which
the publisher likely means: the same name in another namespace, a similar name beside it, or the
only obeyed topic of the same actuator that nobody publishes. In the first two cases the types may
differ in their stamp. What the publisher commands, such as a stop, never happens.

For example, `/collision_monitor` publishes `/cmd_vel`, and `/wheel_controller` obeys `/wheel_cmd`.

## What to do

Remap the topic to the one that is obeyed, if the finding is likely.

## When it is silent

Between namespaces of two robots, between twins (`left_arm`, `right_arm`), and for measured or
estimated velocities. Where something was not read that may be the missing end, only the same name
counts, and is `pedantic`.
"""

from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.lost_commands import lost_commands, other_type
from rtron.findings.rule import FindingRule, make_finding
from rtron.vocabulary import Certainty, Consequence, Direction, Finding, FindingLevel
from rtron.wording import conjugate, join_names


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each motion topic without a reader that likely means an obeyed one."""
    for topic, obeyed in lost_commands(app).items():
        yield _finding(app, topic, obeyed)


def _finding(app: AppFacts, topic: str, obeyed: str) -> Finding:
    publishers, readers = app.publishers(topic), app.readers(obeyed)
    maybe_read = app.may_have_other_end(topic, Direction.SUBSCRIBE)
    others = "" if app.publishers(obeyed) else ", which nobody publishes"
    type = other_type(app, topic, obeyed)
    takes, send = (f", and {verb} {type}" if type else "" for verb in ("takes", "send"))
    return make_finding(
        RULE.name,
        topic,
        summary=f"what {join_names(publishers)} {conjugate(publishers, 'command')} on {topic} "
        "reaches nobody",
        cause=f"no node of this launch subscribes it{app.unread_hint if maybe_read else ''}; "
        f"{join_names(readers)} {conjugate(readers, 'obey')} {obeyed}{others}{takes}",
        remedy=f"find out who should obey {topic}; {obeyed} may be another thing"
        if maybe_read
        else f"remap {topic} to {obeyed}{send}",
        consequence=Consequence.FAILURE,
        certainty=Certainty.POSSIBLE if maybe_read else Certainty.LIKELY,
        level=FindingLevel.PEDANTIC if maybe_read else FindingLevel.REGULAR,
        meant=obeyed,
        nodes=(*publishers, *readers),
        topics=(topic, obeyed),
        evidence=app.evidence((*app.graph.publishers(topic), *app.graph.subscribers(obeyed))),
    )


RULE = FindingRule(
    name="lost_command",
    title="A motion command reaches nobody",
    consequence="failure: likely, possible where something was not read",
    since="0.1.0",
    check=check,
)
