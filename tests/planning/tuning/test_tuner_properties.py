"""Whatever was measured, the tuned plan is a plan, and cuts nothing off that was measured."""

from dataclasses import replace
from random import Random

from hypothesis import given, settings
from hypothesis import strategies as st
from test_tuner import GOALS, MONITOR, flow, grcn, limited, mission, run, stream

from rtron.coherence import coherence_problems
from rtron.coherence.duration_bounds import DURATION_RANGES, LONGEST_SILENCE
from rtron.planning.plan_file.loader import parse_plan
from rtron.planning.tuning import tune_plan, tuned_yaml
from rtron.planning.tuning.run_statistics import MAX_SILENCE, MIN_SAMPLES
from rtron.vocabulary import (
    SECOND,
    DurationStatistics,
    EventStatistics,
    Flow,
    MonitorStatistics,
    OverlapStatistics,
    Plan,
    PolicyName,
    TuningProposalKind,
    ValueStatistics,
)

COUNTS = [0, 1, 19, 20, 99, 100, 10_000, 2**63 - 1]
NAMES = ["/nav", "/teleop", "/safety", "/joy"]
POLICIES = [PolicyName.PREEMPTION, PolicyName.PRIORITY_QUEUE, PolicyName.FIFO_QUEUE]
FOUR, FIVE = ("p50", "p99", "p999", "max"), ("min", "p50", "p99", "p999", "max")


class Dice(Random):
    """Throws plans and runs; hypothesis would take far longer for as many figures."""

    def length(self):
        largest = self.choice([0, 100, SECOND // 2, 2 * SECOND, 20 * SECOND, 2**63 - 1])
        return self.randint(0, largest)

    def within(self, key):
        """Return a duration that a plan may have, of commands as well as of goals."""
        least, most = DURATION_RANGES[key]
        longest = most if key == "max_hold" else min(most, LONGEST_SILENCE)
        return min(max(self.length(), least), longest)

    def durations(self):
        lengths = sorted(self.length() for _ in FOUR)
        return DurationStatistics(
            count=self.choice(COUNTS), **dict(zip(FOUR, lengths, strict=True))
        )

    def sizes(self):
        most = self.choice([0.0, 1e-9, 0.1, 3.0, 1e19])
        found = sorted(self.uniform(0, most) for _ in FIVE)
        return ValueStatistics(count=self.choice(COUNTS), **dict(zip(FIVE, found, strict=True)))

    def flow(self, name, publisher):
        others = ["flow1", "flow2", "flow3", "unapproved"][: self.randint(0, 4)]
        return flow(
            name,
            publisher,
            self.durations(),
            pauses=self.durations(),
            active=self.length(),
            left_moving=self.randint(0, 1),
            waits=self.durations(),
            takes=self.durations(),
            undone=self.randint(0, 1),
            speeds=self.sizes(),
            overlaps=tuple(OverlapStatistics(flow=each, duration=self.length()) for each in others),
        )

    def flows(self):
        publishers = self.sample(NAMES, self.randint(1, 4))
        ranks = self.sample(range(9), len(publishers))
        return tuple(
            Flow(
                name=f"flow{n}",
                publisher=publisher,
                priority=rank,
                timeout=self.choice([None, self.within("timeout")]),
                silent_after=self.within("silent_after"),
                block=self.random() < 0.1,
            )
            for n, (publisher, rank) in enumerate(zip(publishers, ranks, strict=True), start=1)
        )

    def plan(self):
        common = {
            "flows": self.flows(),
            "release_after": self.within("release_after"),
            "max_hold": self.within("max_hold"),
            "max_age": self.within("max_age"),
        }
        heard = any(each.publisher == "/nav" for each in common["flows"])
        asked = {"type": "test/WalkActionGoal", "id": "grcn_goal", "topic": "/goal"}
        window = self.randint(SECOND // 10, 60 * SECOND)
        silent_after = min(SECOND // 100 + self.length(), window)
        monitor = replace(MONITOR, window=window, silent_after=silent_after)
        return Plan(
            app="base",
            grcn=(grcn(**common, policy=self.choice(POLICIES)), grcn(**GOALS | common | asked)),
            rsrcn=limited(
                threshold=self.choice([1e-6, 0.02, 1000.0]),
                vflows=limited().vflows if heard else (),
            ),
            msrcn=mission(max_age=self.within("EventFlow.max_age")),
            fps_monitor=(monitor,),
        )

    def stream(self, node):
        return stream(
            *(self.flow(each.name, each.publisher) for each in node.flows),
            topic=node.topic,
            per_frame=self.sizes(),
            unseen=self.randint(0, 1),
            strangers=("/x\n\x1b[31m",)[: self.randint(0, 1)],
        )

    def run(self, plan):
        gaps, pauses = self.durations(), self.durations()
        return run(
            *map(self.stream, plan.grcn),
            duration=self.length(),
            monitors=(MonitorStatistics(id="fps_cam", gaps=gaps, pauses=pauses),),
            events=(EventStatistics(name="eflow1", gaps=pauses, pauses=gaps),),
        )


def _case(seed):
    dice = Dice(seed)
    plan = dice.plan()
    return plan, dice.run(plan)


CASES = st.integers(0, 2**32).map(_case)


@settings(deadline=None)
@given(CASES)
def test_a_tuned_plan_is_read_as_it_was_written(case):
    plan, measured = case
    assert not list(coherence_problems(plan))
    made, proposals = tune_plan(plan, measured)
    assert not list(coherence_problems(made))
    assert parse_plan(tuned_yaml(made, proposals)) == made


def _waited(node, figures):
    """Return the gaps of those for whose silence others wait, by `release_after`."""
    last = min((each.priority for each in node.flows if not each.block), default=0)
    first = node.policy is PolicyName.FIFO_QUEUE
    own = node.policy is PolicyName.PREEMPTION
    return [
        known.gaps.max
        for each, known in zip(node.flows, figures.flows, strict=True)
        if not each.block
        and (first or each.priority > last)
        and (own or each.timeout is None)
        and known.gaps.count >= MIN_SAMPLES
    ]


@settings(deadline=None)
@given(CASES)
def test_what_changes_outlasts_all_that_was_measured(case):
    plan, measured = case
    made, _ = tune_plan(plan, measured)
    for before, node, figures in zip(plan.grcn, made.grcn, measured.streams, strict=True):
        asks = node.id == "grcn_goal"
        for old, new, known in zip(before.flows, node.flows, figures.flows, strict=True):
            if new.silent_after != old.silent_after:
                assert new.silent_after > known.gaps.max
            if new.timeout != old.timeout:
                assert new.timeout > (known.takes.max if asks else known.gaps.max)
        if node.release_after != before.release_after:
            assert node.release_after > max(_waited(node, figures))
        if node.max_hold != before.max_hold:
            assert node.max_hold > max(each.takes.max for each in figures.flows if each.takes.count)


@settings(deadline=None)
@given(CASES)
def test_what_makes_the_robot_safe_never_becomes_weaker_by_much(case):
    plan, measured = case
    made, _ = tune_plan(plan, measured)
    assert made.rsrcn.threshold <= plan.rsrcn.threshold
    assert made.rsrcn.lowest == plan.rsrcn.lowest
    for before, node in zip(plan.grcn, made.grcn, strict=True):
        assert node.max_age <= before.max_age
        for old, new in zip(before.flows, node.flows, strict=True):
            assert new.silent_after <= max(old.silent_after, MAX_SILENCE)
            assert (new.block, new.publisher) == (old.block, old.publisher)
        safety = [each for each in before.flows if each.publisher == "/safety"]
        for guard in safety:
            now = next(each for each in node.flows if each.name == guard.name)
            assert now.priority >= guard.priority
        assert sorted(each.priority for each in node.flows) == sorted(
            each.priority for each in before.flows
        )


@settings(deadline=None)
@given(CASES)
def test_proposals_tell_exactly_what_changes(case):
    plan, measured = case
    made, proposals = tune_plan(plan, measured)
    changes = [each for each in proposals if each.kind is TuningProposalKind.CHANGE]
    assert all(each.before != each.after for each in changes)
    assert all(each.before == each.after for each in proposals if each not in changes)
    assert bool(changes) is (made != plan)


@settings(deadline=None)
@given(CASES)
def test_tuning_comes_to_rest(case):
    plan, measured = case
    once, _ = tune_plan(plan, measured)
    twice, _ = tune_plan(once, measured)
    thrice, _ = tune_plan(twice, measured)
    assert tune_plan(thrice, measured)[0] == thrice
