"""What rules of the mission cost: one decision, one judged action, and a stream of events.

A decision goes from the bytes of an event to the bit and to the rule that asks for it; half of the
events change the bit. The peers evaluate the same expression on a dict that is ready made: they
decode nothing, keep no bits and have no rules.

An action goes through a guarded stream and is judged by where its own position is.
"""

import time
from collections.abc import Callable, Iterator, Sequence
from statistics import median
from typing import Any

import cel
import celpy
from celpy.adapter import json_to_cel

from bench.common.mission import EVENT, EVENT_NODE, GOAL, GOAL_NODE, peer, plan, pose
from bench.common.testbed import ReportProgress, Testbed
from bench.ros1 import rule_load
from figures.figure import Figure
from rtron.guard.coordinator import Coordinator
from rtron.guard.core.observation_inputs import ObservationInputs
from rtron.guard.core.observations import observations_of
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.vocabulary import MissionRule, build_streams, flow_topic

EXPRESSION = "event.pose.position.x > 1.0 && event.pose.position.y < 2.0"
_POSITIONS = ((0.0, 1.0), (0.0, 1.0), (2.0, 1.0), (2.0, 1.0))
"""Where the robot is, in turn: every other event changes the bit."""
_GOALS = ((1.0, 1.0), (3.0, 1.0), (5.0, 1.0), (3.0, 0.5))
"""Goals, every other inside the area."""
_ROUNDS = 500
_REPEATS = 25
_AT_MOST_US = 30.0
_ACTION = "inside(action.pose.position, area)"
Work = Callable[[Any], object]
"""Takes a message; what comes of it does not matter."""


def figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give the median cost of a decision and of an action, us, and what the stream takes."""
    progress("one decision")
    positions = [pose(x, y) for x, y in _POSITIONS]
    ours = cost_of(_decision(), positions)
    documents = [{"event": _document(x, y)} for x, y in _POSITIONS]
    for name, evaluate in _peers().items():
        theirs = cost_of(evaluate, [_prepare(name, each) for each in documents])
        yield Figure(f"rules.decision_vs_{name}", ours, theirs, "us", at_most=_AT_MOST_US)
    progress("one action")
    goals = [pose(x, y) for x, y in _GOALS]
    yield Figure("rules.action", cost_of(_judge(), goals), None, "us", at_most=_AT_MOST_US)
    yield from rule_load.figures(testbed, progress)


def cost_of(work: Work, messages: Sequence[object]) -> float:
    """Return what one of the messages costs, us: the median over runs of many."""
    return median(_run(work, list(messages) * _ROUNDS) for _ in range(_REPEATS))


def _run(work: Work, messages: Sequence[object]) -> float:
    start = time.perf_counter_ns()
    for message in messages:
        work(message)
    return (time.perf_counter_ns() - start) / len(messages) / 1000


def _decision() -> Work:
    """Return what takes an event as the guard does."""
    rule_plan = plan([MissionRule(name="rule1", when="eflow1", block=(GOAL,))], [EXPRESSION])
    transport = MemoryTransport()
    ObservationInputs(transport, observations_of(rule_plan), lambda: None).open()
    return transport.publisher(EVENT, peer(EVENT_NODE))


def _judge() -> Work:
    """Return what takes an action as the guard does."""
    rule_plan = plan([MissionRule(name="rule1", action=_ACTION, block=(GOAL,))])
    transport = MemoryTransport()
    Coordinator(transport, build_streams(rule_plan), observations_of(rule_plan)).open()
    return transport.publisher(flow_topic(GOAL, "aflow1"), peer(GOAL_NODE))


def _document(x: float, y: float) -> dict[str, Any]:
    return {"pose": {"position": {"x": x, "y": y, "z": 0.0}}}


def _peers() -> dict[str, Work]:
    """Return the compiled expression of each peer; cel-python has a faster and a slower way."""
    env = celpy.Environment(runner_class=celpy.CompiledRunner)
    return {
        "cel-python": env.program(env.compile(EXPRESSION)).evaluate,
        "common-expression-language": cel.compile(EXPRESSION).execute,
    }


def _prepare(name: str, document: dict[str, Any]) -> object:
    """Return a document as the peer wants it."""
    if name != "cel-python":
        return document
    return {key: json_to_cel(value) for key, value in document.items()}
