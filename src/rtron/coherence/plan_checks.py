"""The checks of a whole plan: contradictions that no single value shows."""

from collections.abc import Iterator, Sequence
from itertools import chain

from rtron.coherence.flows import CoherenceProblem, duplicate_topic_problems, duplicates
from rtron.coherence.grcn import grcn_policy_problems, grcn_problems
from rtron.coherence.leases import lease_problems, stop_button_problems
from rtron.coherence.msrcn import msrcn_policy_problems, msrcn_problems
from rtron.coherence.rsrcn import rsrcn_policy_problems, rsrcn_problems
from rtron.coherence.shared_topics import (
    action_topic_problems,
    private_topic_problems,
    shared_topic_problems,
)
from rtron.vocabulary import (
    GRCN,
    MSRCN,
    RSRCN,
    EventFlow,
    FpsMonitor,
    GuardedTopic,
    Mode,
    Plan,
    build_streams,
    matches_node,
    normalise_type,
)


def coherence_problems(plan: Plan) -> Iterator[CoherenceProblem]:
    """Yield everything in which a plan contradicts itself, its expressions apart."""
    yield from _id_problems(plan)
    yield from duplicate_topic_problems(plan.grcn, "GRCNs")
    yield from chain.from_iterable(map(grcn_problems, plan.grcn))
    yield from rsrcn_problems(plan)
    yield from msrcn_problems(plan.msrcn) if plan.msrcn else ()
    yield from lease_problems(plan)
    yield from stop_button_problems(plan)
    yield from shared_topic_problems(plan)
    yield from action_topic_problems(plan)
    yield from private_topic_problems(plan)
    yield from _type_problems(plan)
    yield from _cell_problems(plan)
    for message in duplicates(plan.messages, lambda message: normalise_type(message.type)):
        yield message, "type", f"{message.type} has two definitions"


def _cell_problems(plan: Plan) -> Iterator[CoherenceProblem]:
    """Refuse a cell that the guard does not lead into: its node would get no command at all."""
    enforced = [stream for stream in build_streams(plan) if stream.mode is Mode.ENFORCE]
    successors = {name for stream in enforced for name in stream.successors}
    for node in plan.cell:
        for stream in enforced:
            endpoints = (*stream.successors, *(flow.publisher for flow in stream.flows))
            if stream.is_ros2_action and any(matches_node(end, node) for end in endpoints):
                why = f"the action {stream.topic} cannot be carried into the cell of {node}: ROS 2"
                yield plan, "cell", why
        if not any(matches_node(name, node) for name in successors):
            yield plan, "cell", f"no coordination node that enforces has the successor {node}"


def settable_problems(plan: Plan) -> Iterator[CoherenceProblem]:
    """Yield those problems that settings can cause; messages wait while a guard looks for them."""
    yield from chain.from_iterable(map(grcn_policy_problems, plan.grcn))
    yield from rsrcn_policy_problems(plan.rsrcn, plan) if plan.rsrcn else ()
    yield from msrcn_policy_problems(plan.msrcn) if plan.msrcn else ()


def _type_problems(plan: Plan) -> Iterator[CoherenceProblem]:
    """Refuse a topic that has another type than elsewhere in the plan."""
    vflows = plan.rsrcn.vflows if plan.rsrcn else ()
    aflows, eflows = (plan.msrcn.aflows, plan.msrcn.eflows) if plan.msrcn else ((), ())
    parts: Sequence[GRCN | GuardedTopic | EventFlow] = [*plan.grcn, *vflows, *aflows, *eflows]
    first: dict[str, str] = {}
    for part in parts:
        known = first.setdefault(part.topic, part.type) if part.type else ""
        if normalise_type(part.type) != normalise_type(known):
            yield part, "type", f"{part.topic} is a {part.type} here and a {known} elsewhere"


def _id_problems(plan: Plan) -> Iterator[CoherenceProblem]:
    single = [node for node in (plan.rsrcn, plan.msrcn) if node]
    nodes: Sequence[GRCN | RSRCN | MSRCN | FpsMonitor] = [*plan.grcn, *single, *plan.fps_monitor]
    for node in duplicates(nodes, lambda node: node.id):
        yield node, "id", f"two coordination nodes have the id {node.id}"
