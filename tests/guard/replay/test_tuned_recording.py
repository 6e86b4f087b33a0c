"""A recording, measured and played again under the plan that it proposes itself."""

from itertools import pairwise
from random import Random

from hypothesis import given, settings
from hypothesis import strategies as st
from test_recording_player import START, counts
from test_run_measurement import TWIST, grcn
from velocity_messages import twist

from example_budget import examples
from rtron.coherence import coherence_problems
from rtron.guard.replay.player import RecordingPlayer
from rtron.guard.replay.recorded_streams import RecordedStream
from rtron.planning.tuning import tune_plan
from rtron.policies import build_policy
from rtron.vocabulary import SECOND, Decision, Flow, Plan, build_streams

FLOWS = (
    Flow(name="flow1", publisher="/joy", priority=3),
    Flow(name="flow2", publisher="/teleop", priority=2),
    Flow(name="flow3", publisher="/nav", priority=1),
)
NODES = {
    each.publisher: RecordedStream(
        "/cmd_vel", TWIST.type, TWIST.md5sum, TWIST.definition, each.publisher
    )
    for each in FLOWS
}
MS = SECOND // 1000


def recording(seed):
    """Return what three nodes say: (time, node), a joystick in bursts, others with jitter."""
    dice = Random(seed)
    jitter = dice.choice([0, 1, 5])
    said = []
    for node, share in (("/joy", 0.8), ("/teleop", 0.9), ("/nav", 1.0)):
        period = dice.choice([50, 100]) * MS
        time = dice.randrange(SECOND)
        while time < 40 * SECOND:
            said.append((time, node))
            if dice.random() > share ** (1 / 20):
                time += dice.randrange(2 * SECOND, 9 * SECOND)
            time += period + dice.randrange(1 + jitter * period)
    return sorted(said)


def played(plan, said):
    player = RecordingPlayer(plan, measured=True)
    found = player.play(
        [(START + at, NODES[node], twist(0.1)) for at, node in said], lambda n: None
    )
    return found, player.figures()


def decided(plan, said):
    """Return the decision about each message, as the plan's policy gives it."""
    policy = build_policy(build_streams(plan)[0].stages[0].settings)
    names = {flow.publisher: flow.name for flow in plan.grcn[0].flows}
    return [policy.verdict(names[node], None, at).decision for at, node in said]


def case(seed):
    release = Random(seed).choice([100 * MS, 500 * MS, 2 * SECOND, 3 * SECOND])
    plan = Plan(app="base", grcn=(grcn(flows=FLOWS, release_after=release),))
    said = recording(seed)
    found, run = played(plan, said)
    made, _ = tune_plan(plan, run)
    return plan, made, said, found


CASES = st.integers(0, 2**32).map(case)


def _order(node):
    return [flow.priority for flow in node.flows]


def phases(said, node):
    """Return the times between two messages of a node that belong together."""
    times = [at for at, who in said if who == node]
    usual = sorted(b - a for a, b in pairwise(times))
    limit = max(SECOND, 10 * usual[len(usual) // 2]) if usual else 0
    return [(a, b) for a, b in pairwise(times) if b - a <= limit]


@settings(max_examples=examples(40), deadline=None)
@given(CASES)
def test_what_passed_passes_unless_somebody_keeps_the_output_longer(case):
    plan, made, said, _ = case
    before, after = plan.grcn[0], made.grcn[0]
    assert not list(coherence_problems(made))
    if after.release_after > before.release_after or _order(after) != _order(before):
        return
    pairs = zip(decided(plan, said), decided(made, said), strict=True)
    assert all(now is Decision.PASS for was, now in pairs if was is Decision.PASS)


@settings(max_examples=examples(40), deadline=None)
@given(CASES)
def test_nobody_loses_the_output_in_the_midst_of_a_phase(case):
    plan, made, said, _ = case
    after = made.grcn[0]
    if after.release_after == plan.grcn[0].release_after:
        return
    first = max(after.flows, key=lambda flow: flow.priority)
    spans = phases(said, first.publisher)
    verdicts = decided(made, said)
    for (at, node), decision in zip(said, verdicts, strict=True):
        if node != first.publisher and any(a <= at < b for a, b in spans):
            assert decision is Decision.DROP


@settings(max_examples=examples(40), deadline=None)
@given(CASES)
def test_the_robot_is_not_stopped_more_often_than_there_are_pauses(case):
    _, made, said, before = case
    found, run = played(made, said)
    stops = found.streams[0].stops
    pauses = sum(flow.pauses.count + 1 for flow in run.streams[0].flows)
    assert stops <= max(before.streams[0].stops, pauses)


@settings(max_examples=examples(40), deadline=None)
@given(CASES)
def test_the_same_recording_gives_the_same_figures(case):
    plan, _, said, before = case
    found, run = played(plan, said)
    assert found == before
    for flow in run.streams[0].flows:
        refused = sum(each.count for each in flow.refusals)
        passed, _, dropped, _ = counts(found, flow.flow)
        assert (passed, dropped) == (flow.messages - refused, refused)
