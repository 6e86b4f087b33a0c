import pytest
from policy_runs import (
    DONE,
    HIGH,
    LOW,
    MAX_AGE,
    MAX_HOLD,
    MIDDLE,
    RELEASE_AFTER,
    TICK,
    Run,
    settings,
    watch_effects,
)

from rtron.policies.queues.message_queue import QueueState
from rtron.policies.state_machine import TransitionEffect
from rtron.vocabulary import Decision, Flow, PolicyName, StreamKind

PASS, HOLD, DROP = Decision.PASS, Decision.HOLD, Decision.DROP
MIDDLE_TIMEOUT = 7


def start(kind, **others):
    return Run(settings(PolicyName.FIFO_QUEUE, kind, **{"max_age": 1000, **others}))


def actions(**others):
    return start(StreamKind.ACTION, **others)


def commands(**others):
    return start(StreamKind.COMMAND, **others)


@pytest.mark.parametrize("kind", [StreamKind.ACTION, StreamKind.STATE])
def test_one_action_at_a_time_in_order_of_arrival(kind):
    run = start(kind).play([(1, LOW), (1, HIGH), (1, LOW), (1, MIDDLE)])
    assert [v.decision for v in run.verdicts] == [PASS, HOLD, HOLD, HOLD]
    assert run.verdicts[1].reason == "low has the output"
    for number in (1, 2, 3):
        run.do(DONE)
        assert run.tick() == [(number, PASS)]
        assert run.tick() == []


def test_a_release_tells_how_long_it_waited():
    run = actions(max_age=10**12).play([(1, LOW), (0, HIGH), (300_000_000, TICK)])
    assert run.left[-1][2].reason == "its turn came after 0.30 s"


@pytest.mark.parametrize(("late", "left"), [(-1, []), (0, [(1, PASS)]), (1, [(1, PASS)])])
@pytest.mark.parametrize(("flow", "limit"), [(MIDDLE, MIDDLE_TIMEOUT), (LOW, MAX_HOLD)])
def test_the_next_goes_when_the_one_in_progress_is_overdue(flow, limit, late, left):
    run = actions().play([(5, flow), (1, HIGH)])
    assert run.policy.deadline() == 5 + limit
    run.wait(limit - 1 + late)
    assert run.tick() == left


def test_a_timeout_longer_than_max_hold_does_not_count():
    run = actions(max_hold=9).play([(5, HIGH)])
    assert run.policy.deadline() == 5 + 9


def test_a_message_does_not_overtake_what_is_due():
    run = actions().play([(5, MIDDLE), (1, LOW), (MIDDLE_TIMEOUT, HIGH)])
    assert run.verdicts[2].decision is HOLD
    assert run.verdicts[2].reason == "low goes next"
    assert run.policy.deadline() == run.now
    assert run.tick() == [(1, PASS)]


def test_done_makes_the_next_due_and_frees_an_idle_output():
    run = actions().play([(5, LOW), (1, DONE)])
    assert (run.policy.owner, run.policy.deadline()) == (None, None)
    run.play([(0, DONE), (1, LOW), (1, HIGH), (1, DONE)])
    assert run.policy.deadline() == run.now
    assert run.tick() == [(2, PASS)]
    assert run.policy.owner == HIGH


def test_after_the_end_nothing_is_in_progress_when_nothing_waits():
    run = actions().play([(5, MIDDLE), (MIDDLE_TIMEOUT, LOW)])
    assert run.verdicts[1].decision is PASS


@pytest.mark.parametrize(
    ("age", "left"), [(MAX_AGE - 1, []), (MAX_AGE, [(1, DROP)]), (MAX_AGE + 1, [(1, DROP)])]
)
def test_what_waits_too_long_is_dropped(age, left):
    run = actions(max_age=MAX_AGE).play([(5, LOW), (1, HIGH)])
    assert run.policy.deadline() == 6 + MAX_AGE
    run.wait(age)
    assert run.tick() == left
    assert all("too old" in v.reason for _, m, v in run.left if m.number == 1)


def test_what_is_due_but_too_old_is_dropped():
    run = actions(max_age=MAX_AGE, max_hold=MAX_AGE).play([(5, LOW), (0, HIGH)])
    run.wait(MAX_AGE)
    assert run.tick() == [(1, DROP)]
    assert run.policy.owner is None


def test_a_full_queue_drops_the_newest_and_says_so():
    run = actions(queue_size=2).play([(1, LOW), (1, LOW), (1, HIGH), (1, MIDDLE)])
    assert [v.decision for v in run.verdicts] == [PASS, HOLD, HOLD, DROP]
    assert run.verdicts[3].reason == "the queue is full (2)"
    run.play([(1, DONE), (0, TICK), (0, MIDDLE)])
    assert run.verdicts[4].decision is HOLD


@pytest.fixture
def small(monkeypatch):
    """Let 10 bytes wait."""
    monkeypatch.setattr("rtron.policies.queues.message_queue.MAX_QUEUE_BYTES", 10)


def decisions(policy, *words):
    """Return what is decided about bytes of flows, all at one moment."""
    return [policy.verdict(flow, bytes(size), 0).decision for flow, size in words]


@pytest.mark.usefixtures("small")
def test_what_waits_is_bounded_in_bytes_too_unless_it_is_one_message():
    policy = actions().policy
    words = (LOW, 99), (LOW, 99), (HIGH, 1)
    assert decisions(policy, *words) == [PASS, HOLD, DROP]
    assert policy.verdict(HIGH, b"x", 0).reason == "the queue is full (0 MB)"
    policy = actions().policy
    words = (LOW, 1), (LOW, 6), (HIGH, 4), (HIGH, 1)
    assert decisions(policy, *words) == [PASS, HOLD, HOLD, DROP]
    policy.observe_done(now=1)
    assert [len(each.message) for each in policy.tick(now=1)] == [6]
    assert decisions(policy, (LOW, 6), (LOW, 1)) == [HOLD, DROP]


@pytest.mark.usefixtures("small")
def test_a_fresher_command_takes_the_bytes_of_the_older_one():
    policy = commands().policy
    words = (LOW, 1), (MIDDLE, 9), (MIDDLE, 99), (HIGH, 1)
    assert decisions(policy, *words) == [PASS, HOLD, HOLD, DROP]
    policy.tick(now=0)
    assert decisions(policy, (MIDDLE, 9), (HIGH, 1)) == [HOLD, DROP], "the older one leaves first"
    policy.tick(now=0)
    assert decisions(policy, (HIGH, 1), (HIGH, 1)) == [HOLD, HOLD]


def test_the_turn_of_commands_belongs_to_the_flow():
    run = commands().play([(1, LOW), (1, HIGH), (1, LOW), (1, LOW)])
    assert [v.decision for v in run.verdicts] == [PASS, HOLD, PASS, PASS]
    assert run.verdicts[1].reason == "low has the output"
    assert run.policy.owner == LOW


@pytest.mark.parametrize(("late", "left"), [(-1, []), (0, [(2, PASS)]), (1, [(2, PASS)])])
@pytest.mark.parametrize(("flow", "limit"), [(MIDDLE, MIDDLE_TIMEOUT), (LOW, RELEASE_AFTER)])
def test_silence_ends_the_turn_of_commands(flow, limit, late, left):
    run = commands().play([(1, flow), (3, flow), (1, HIGH)])
    assert run.policy.deadline() == 4 + limit
    run.wait(limit - 1 + late)
    assert run.tick() == left


@pytest.mark.parametrize(("gap", "decision"), [(8, PASS), (9, HOLD), (10, HOLD)])
def test_max_hold_ends_the_turn_of_commands_that_never_fall_silent(gap, decision):
    run = commands().play([(0, LOW), (8, LOW), (0, HIGH), (8, LOW)])
    assert MAX_HOLD == 8 + 8 + 9
    run.wait(gap)
    assert run.say(LOW) is decision


def test_a_full_queue_drops_also_while_nobody_has_the_turn():
    """The tick is late: the turn is over, and what is due still waits."""
    run = actions(queue_size=1).play([(0, MIDDLE), (1, LOW)])
    effects = watch_effects(run.policy)
    run.wait(MIDDLE_TIMEOUT)
    assert run.say(HIGH) is DROP
    assert effects == [TransitionEffect.NOTHING, TransitionEffect.DROP]
    assert run.policy.owner is None
    assert run.verdicts[-1].reason == "the queue is full (1)"
    assert run.policy._machine.state is QueueState.FREE


def test_waiting_flows_keep_their_freshest_command_and_their_place():
    run = commands().play([(0, LOW), (1, MIDDLE), (1, HIGH), (1, MIDDLE)])
    assert run.policy.deadline() == run.now
    assert run.tick() == [(1, DROP)]
    assert run.left[-1][2].reason == "a newer message of middle took its place"
    run.wait(RELEASE_AFTER)
    assert run.tick() == [(3, PASS)]
    assert run.policy.owner == MIDDLE
    run.wait(MIDDLE_TIMEOUT)
    assert run.tick() == [(2, PASS)]


def test_a_full_queue_still_takes_a_fresher_command_of_a_waiting_flow():
    run = commands(queue_size=1).play([(0, LOW), (1, MIDDLE), (1, HIGH), (1, MIDDLE)])
    assert [v.decision for v in run.verdicts] == [PASS, HOLD, DROP, HOLD]


def test_late_ticks_do_not_make_the_queue_longer():
    run = commands(queue_size=2).play([(0, LOW), *(4 * [(1, MIDDLE)])])
    assert [v.decision for v in run.verdicts[1:]] == [HOLD, HOLD, HOLD, HOLD]
    assert run.say(MIDDLE) is DROP
    assert run.tick() == [(1, DROP), (2, DROP), (3, DROP)]
    assert run.say(MIDDLE) is HOLD


def test_a_turn_without_time_is_over_at_once():
    flows = tuple(Flow(name=name, publisher="/any", timeout=0) for name in (LOW, HIGH))
    run = actions(flows=(*flows, Flow(name=MIDDLE, publisher="/middle")))
    run.play([(0, MIDDLE), (1, LOW), (1, HIGH), (1, DONE)])
    assert run.tick() == [(1, PASS), (2, PASS)]
    assert run.policy.owner is None


def test_a_fresher_command_is_as_young_as_it_is():
    run = commands(max_age=MAX_AGE, release_after=MAX_AGE + 2)
    run.play([(0, LOW), (0, MIDDLE), (5, MIDDLE), (MAX_AGE - 3, TICK)])
    assert (2, PASS) in [(m.number, v.decision) for _, m, v in run.left]


def test_the_former_owner_waits_behind_the_others():
    run = commands().play([(0, LOW), (1, HIGH), (RELEASE_AFTER, LOW), (0, HIGH)])
    assert [v.decision for v in run.verdicts] == [PASS, HOLD, HOLD, HOLD]
    assert run.tick() == [(1, DROP), (3, PASS)]
    assert run.policy.owner == HIGH


def test_closing_gives_up_everything():
    run = actions().play([(0, LOW), (1, HIGH), (1, MIDDLE)])
    assert run.close() == [(1, DROP), (2, DROP)]
    assert run.left[-1][2].reason == "the queue was closed"
    assert run.close() == []


# What is beside the messages


@pytest.mark.parametrize("flow", [LOW, "nobody that the plan names"])
def test_what_began_elsewhere_has_the_turn_until_it_is_done(flow):
    run = actions(max_hold=10**9)
    effects = watch_effects(run.policy)
    run.policy.occupy(flow, run.now)
    assert run.policy.owner == flow
    run.play([(1, HIGH)])
    assert run.verdicts[0].reason == f"{flow} has the output"
    run.policy.occupy(flow, run.now)
    run.do(DONE)
    assert run.tick() == [(0, PASS)]
    assert effects[:3] == [
        TransitionEffect.NOTHING,
        TransitionEffect.HOLD,
        TransitionEffect.NOTHING,
    ]


@pytest.mark.parametrize(("late", "left"), [(-1, []), (0, [(0, PASS)])])
def test_what_began_elsewhere_is_overdue_like_any_other(late, left):
    run = actions()
    run.policy.occupy(MIDDLE, run.now)
    run.play([(1, HIGH)])
    run.wait(MIDDLE_TIMEOUT - 1 + late)
    assert run.tick() == left


def test_a_message_that_is_withdrawn_leaves_at_the_next_tick():
    run = actions().play([(0, LOW), (1, HIGH), (1, HIGH)])
    first, second = (message for message in run.messages if message.flow == HIGH)
    run.policy.withdraw(first, "its client cancelled it")
    assert run.policy.deadline() == run.now
    assert run.tick() == [(1, DROP)]
    assert run.left[-1][2].reason == "its client cancelled it"
    run.policy.withdraw(first, "once more")
    run.policy.withdraw(run.messages[0], "it does not wait")
    assert run.tick() == []
    run.do(DONE)
    assert run.tick() == [(2, PASS)]
    run.policy.withdraw(second, "it has gone")
    assert run.tick() == []


def test_only_the_very_object_is_withdrawn():
    """Two clients may say the same."""
    policy = actions().policy
    first, second = bytes([1, 2]), bytes([1, 2])
    policy.verdict(LOW, b"", 0)
    policy.verdict(LOW, first, 1)
    policy.verdict(HIGH, second, 2)
    policy.withdraw(second, "cancelled")
    (left,) = policy.tick(3)
    assert left.message is second
    assert left.verdict.flow == HIGH
