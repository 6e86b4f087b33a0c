"""Whether the leases of a plan and the GRCNs that need them agree."""

from collections.abc import Iterator

from rtron.coherence.flows import CoherenceProblem, duplicates
from rtron.errors import suggestion
from rtron.vocabulary import (
    GRCN,
    PRIVATE_ROOT,
    CommanderRank,
    Flow,
    Mode,
    Plan,
    StreamKind,
    build_streams,
    normalise_type,
)

RESERVED_SOURCES = ("robot", "file")
"""The sources of a stop that every guard has: a person on the robot, and an unreadable file."""
LEASABLE_TYPES = (
    "geometry_msgs/Twist",
    "geometry_msgs/TwistStamped",
    "ackermann_msgs/AckermannDrive",
    "ackermann_msgs/AckermannDriveStamped",
)
"""The types of which it is known what a neutral command is: one that drives at no velocity."""


def lease_problems(plan: Plan) -> Iterator[CoherenceProblem]:
    """Yield what is wrong with the leases of a plan, whatever its policies are."""
    names = [lease.name for lease in plan.leases]
    for lease in duplicates(plan.leases, lambda lease: lease.name):
        yield lease, "name", f"two leases have the name {lease.name}"
    for grcn in plan.grcn:
        if grcn.topic.removeprefix("/leases/") in names:
            yield grcn, "topic", f"the private topics of {grcn.topic} are those of a lease"
        if grcn.lease and grcn.lease not in names:
            hint = suggestion(grcn.lease, names) if names else "there is none under `leases`"
            yield grcn, "lease", f"no lease is called {grcn.lease}: {hint}"
    for lease in plan.leases:
        if all(grcn.lease != lease.name for grcn in plan.grcn):
            yield lease, "name", f"no GRCN says `lease: {lease.name}`"
    yield from _rank_problems(plan)


def stop_button_problems(plan: Plan) -> Iterator[CoherenceProblem]:
    """Yield what is wrong with the buttons that stop the robot."""
    buttons = plan.stop_sources.buttons
    for button in duplicates(buttons, lambda button: button.name):
        yield button, "name", f"two stop buttons have the name {button.name}"
    for button in duplicates(buttons, lambda button: button.topic):
        yield button, "topic", f"two stop buttons are on {button.topic}"
    guarded = {stream.topic for stream in build_streams(plan)}
    for button in buttons:
        if button.name in RESERVED_SOURCES:
            yield button, "name", f"{button.name} is another source's name: choose another one"
        if button.topic in guarded:
            yield button, "topic", f"{button.topic} is guarded: a stop must not depend on that"
        if button.topic.startswith(f"{PRIVATE_ROOT}/"):
            yield button, "topic", f"{button.topic} is the guard's private topic"
        if "*" in button.publisher:
            yield button, "publisher", f"a stop button needs the full name of {button.publisher}"


def lease_policy_problems(grcn: GRCN) -> Iterator[CoherenceProblem]:
    """Yield what keeps a GRCN from the policy Lease."""
    if not grcn.lease:
        yield grcn, "policy", f"Lease needs a lease: say `lease: NAME` on {grcn.topic}"
    if grcn.mode is not Mode.ENFORCE:
        why = "who only watches grants nothing"
        yield grcn, "policy", f"Lease on {grcn.topic} needs `mode: enforce`: {why}"
    if grcn.kind is not StreamKind.COMMAND or normalise_type(grcn.type) not in LEASABLE_TYPES:
        what = grcn.type or "type that is not named"
        why = f"of a {what} it is not known which message is neutral"
        yield grcn, "policy", f"Lease is not for {grcn.topic}: {why}; it is for velocities"
    for flow in grcn.flows:
        if "*" in flow.publisher:
            why = "two nodes would be one commander"
            yield flow, "publisher", f"Lease needs the full name of {flow.publisher}: {why}"


def _rank_problems(plan: Plan) -> Iterator[CoherenceProblem]:
    """Refuse a publisher with two ranks under one lease."""
    ranks: dict[tuple[str, str], CommanderRank] = {}
    for grcn, flow in _leased_flows(plan):
        rank = ranks.setdefault((grcn.lease, flow.publisher), flow.rank)
        if rank is not flow.rank:
            text = f"{flow.publisher} is {flow.rank} here and {rank} elsewhere"
            yield flow, "rank", f"{text}, under the lease {grcn.lease}"


def _leased_flows(plan: Plan) -> Iterator[tuple[GRCN, Flow]]:
    for grcn in plan.grcn:
        if grcn.lease:
            yield from ((grcn, flow) for flow in grcn.flows)
