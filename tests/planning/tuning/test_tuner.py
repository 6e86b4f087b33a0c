"""What a run proposes for a plan, value by value, at the bounds of each rule of thumb."""

from dataclasses import replace

import pytest

from rtron.coherence import coherence_problems
from rtron.planning.tuning import tune_plan, tuned_yaml
from rtron.planning.tuning.formatting import count_text, round_up, round_up_value, short_duration
from rtron.planning.tuning.run_statistics import MAX_SILENCE, MIN_DURATION
from rtron.planning.tuning.velocity_limits import ENOUGH_VELOCITIES, MAX_WINDOW
from rtron.vocabulary import (
    GRCN,
    MSRCN,
    RSRCN,
    SECOND,
    Decision,
    Domain,
    DurationStatistics,
    EventFlow,
    EventStatistics,
    Flow,
    FlowStatistics,
    FpsMonitor,
    GuardedTopic,
    MeasuredRun,
    Mode,
    MonitorStatistics,
    OverlapStatistics,
    Plan,
    PolicyName,
    RefusalStatistics,
    Sharing,
    StreamKind,
    StreamStatistics,
    TuningProposalKind,
    ValueStatistics,
    WatchedFlow,
)

MS = SECOND // 1000
CHANGE, KEEP, LOOK = TuningProposalKind.CHANGE, TuningProposalKind.KEEP, TuningProposalKind.LOOK
TOPIC, TWIST = "/cmd_vel", "geometry_msgs/Twist"
FLOWS = (
    Flow(name="flow1", publisher="/nav", priority=2),
    Flow(name="flow2", publisher="/teleop", priority=1),
)


def grcn(**settings):
    wanted = {
        "id": "grcn_cmd_vel",
        "topic": TOPIC,
        "type": TWIST,
        "domain": Domain.CONTROL,
        "kind": StreamKind.COMMAND,
        "sharing": Sharing.CONTEND,
        "mode": Mode.ENFORCE,
        "policy": PolicyName.PREEMPTION,
        "flows": FLOWS,
        "successors": ("/driver",),
    }
    return GRCN(**wanted | settings)


def took(longest, count=1000, usual=None, p999=None):
    p999 = longest if p999 is None else p999
    usual = min(p999, longest // 5) if usual is None else usual
    return DurationStatistics(count=count, p50=usual, p99=p999, p999=p999, max=longest)


def values(most, count=1000):
    return ValueStatistics(count=count, min=0.0, p50=most, p99=most, p999=most, max=most)


MOVES = values(0.5)
USUAL, TAKES, NONE = took(100 * MS), took(20 * SECOND, 20), DurationStatistics()


def flow(name="flow1", publisher="/nav", gaps=USUAL, **figures):
    wanted = {"messages": gaps.count + 1, "gaps": gaps, "speeds": MOVES}
    return FlowStatistics(flow=name, publisher=publisher, **wanted | figures)


def stream(*flows, topic=TOPIC, mode=Mode.ENFORCE, **figures):
    return StreamStatistics(topic=topic, mode=mode, flows=flows, **figures)


def run(*streams, duration=600 * SECOND, **figures):
    return MeasuredRun(app="base", duration=duration, streams=streams, **figures)


def tuned(plan, measured):
    """Return the plan that a run gives, and the proposals; the plan must fit itself."""
    made, proposals = tune_plan(plan, measured)
    assert not list(coherence_problems(made))
    return made, proposals


def about(proposals, key, flow=""):
    return next(each for each in proposals if (each.key, each.flow) == (key, flow))


def tuned_grcn(node, *flows, **figures):
    made, proposals = tuned(Plan(app="base", grcn=(node,)), run(stream(*flows), **figures))
    return made.grcn[0], proposals


def release(before, gaps, **settings):
    node, proposals = tuned_grcn(grcn(release_after=before, **settings), flow(gaps=gaps))
    found = about(proposals, "release_after")
    assert (found.kind is CHANGE) is (node.release_after != before)
    return node.release_after, found


@pytest.mark.parametrize(
    ("figure", "rounded"),
    [
        (0, 10),
        (10, 10),
        (11, 11 + 1),
        (99, 100),
        (100, 100),
        (101, 120),
        (120, 120),
        (121, 150),
        (310 * MS, 400 * MS),
        (SECOND, SECOND),
        (SECOND + 1, 1200 * MS),
        (2**63 - 1, 10**19),
    ],
)
def test_durations_are_rounded_up(figure, rounded):
    assert round_up(figure) == rounded


@pytest.mark.parametrize(
    ("figure", "rounded"),
    [(0.01, 0.01), (0.0101, 0.012), (0.099, 0.1), (1.0, 1.0), (1.01, 1.2), (9.99, 10.0)],
)
def test_values_are_rounded_up_to_what_people_write(figure, rounded):
    assert repr(round_up_value(figure)) == repr(rounded)


@pytest.mark.parametrize("figure", [5e-324, 1e-300, 3e-7, 123.456, 1e15, 9.3e18, 1e300])
def test_any_value_has_a_round_one_above(figure):
    assert figure <= round_up_value(figure) <= max(1.4 * figure, 1e-320)


def test_figures_are_told_in_few_digits():
    assert count_text(12408, "message") == "12 408 messages"
    assert count_text(1, "gap") == "1 gap"
    assert [short_duration(d) for d in (0, 1500, MS, 312_345_678, 120 * SECOND)] == [
        "0 s",
        "0.0015 ms",
        "0.001 s",
        "0.312 s",
        "120 s",
    ]


@pytest.mark.parametrize(
    ("longest", "after"),
    [
        (240 * MS, 300),
        (320 * MS, 400),
        (320 * MS + 4, 500),  # its need is above 0.4 s: 0.5 s fits
        (400 * MS, 500),
        (400 * MS + 1, 600),
        (480 * MS, 600),
        (4 * SECOND, 5000),
    ],
)
def test_release_after_is_a_quarter_longer_than_the_longest_gap(longest, after):
    gaps = took(longest, usual=MS, p999=MS)
    assert release(500 * MS, gaps)[0] == after * MS


@pytest.mark.parametrize(("p999", "after"), [(400 * MS, 600), (400 * MS + 1, 800)])
def test_release_after_is_one_and_a_half_times_p999(p999, after):
    gaps = took(401 * MS, usual=MS, p999=p999)
    assert release(500 * MS, gaps)[0] == after * MS


@pytest.mark.parametrize(("usual", "after"), [(200 * MS, 600), (200 * MS + 1, 800)])
def test_release_after_outlasts_three_usual_gaps(usual, after):
    gaps = took(usual + 1, usual=usual, p999=usual)
    assert release(500 * MS, gaps)[0] == after * MS


def test_release_after_is_never_very_short():
    assert release(500 * MS, took(MS))[0] == MIN_DURATION


@pytest.mark.parametrize(("count", "after"), [(19, 500), (20, 3000)])
def test_few_gaps_make_nothing_longer(count, after):
    found, proposal = release(500 * MS, took(2 * SECOND, count))
    assert found == after * MS
    assert proposal.samples == count
    assert ("too little" in proposal.why) is (count < 20)


@pytest.mark.parametrize(("count", "after"), [(99, 500), (100, 300)])
def test_only_many_gaps_make_something_shorter(count, after):
    assert release(500 * MS, took(200 * MS, count, usual=MS))[0] == after * MS


def test_what_was_chosen_to_be_nothing_stays():
    assert release(0, took(SECOND))[0] == 0


def test_a_silence_that_is_too_long_is_for_a_person_to_look_at():
    longest = 4 * MAX_SILENCE // 5
    assert release(500 * MS, took(longest, p999=MS))[0] == MAX_SILENCE
    after, proposal = release(500 * MS, took(longest + 1, p999=MS))
    assert (after, proposal.kind) == (500 * MS, LOOK)
    assert "6 s, which is too long" in proposal.why


def test_nobody_waits_for_the_last_flow():
    slow = flow("flow2", "/teleop", took(3 * SECOND))
    node, _ = tuned_grcn(grcn(), flow(gaps=took(100 * MS)), slow)
    assert node.release_after < 500 * MS
    node, _ = tuned_grcn(grcn(block_unapproved=False), flow(gaps=took(100 * MS)), slow)
    assert node.release_after == 5 * SECOND


def test_all_flows_that_are_waited_for_must_be_known_to_wait_less():
    three = (*FLOWS, Flow(name="flow3", publisher="/joy", priority=9))
    seldom = flow("flow3", "/joy", took(50 * MS, 99))
    node, proposals = tuned_grcn(grcn(flows=three), flow(), seldom)
    assert node.release_after == 500 * MS
    assert "flow3: 99 gaps" in about(proposals, "release_after").why
    node, _ = tuned_grcn(grcn(flows=three), flow(), replace(seldom, gaps=took(50 * MS, 100)))
    assert node.release_after < 500 * MS


def test_figures_of_another_publisher_do_not_count():
    node, proposals = tuned_grcn(grcn(), flow(publisher="/other", gaps=took(2 * SECOND)))
    assert node == grcn()
    assert any("/nav never spoke" in each.why for each in proposals)


def test_block_has_nothing_to_wait_for():
    node, proposals = tuned_grcn(grcn(policy=PolicyName.BLOCK), flow(gaps=took(2 * SECOND)))
    assert node.release_after == 500 * MS
    assert not [each for each in proposals if each.key == "release_after"]


@pytest.mark.parametrize(("longest", "after"), [(320, 400), (400, 500), (480, 600)])
def test_silent_after_is_each_flow_s_own(longest, after):
    gaps = took(longest * MS, usual=MS, p999=MS)
    node, proposals = tuned_grcn(grcn(), flow(), flow("flow2", "/teleop", gaps))
    assert node.flows[1].silent_after == after * MS
    assert node.flows[0].silent_after == 150 * MS
    assert about(proposals, "silent_after", "flow2").samples == 1000


def test_a_pause_with_the_robot_moving_keeps_the_silence():
    node, proposals = tuned_grcn(grcn(), flow(left_moving=2))
    assert node.flows[0].silent_after == 500 * MS
    assert "2 pauses" in about(proposals, "silent_after", "flow1").why


@pytest.mark.parametrize(
    "figures", [{"type": "std_msgs/Float64"}, {"kind": StreamKind.STATE}, {"mode": Mode.OBSERVE}]
)
def test_only_what_drives_the_robot_falls_silent(figures):
    node = grcn(policy=PolicyName.BLOCK, **figures)
    plan = Plan(app="base", grcn=(node,))
    measured = run(stream(flow(gaps=took(2 * SECOND)), mode=node.mode))
    assert tuned(plan, measured)[0] == plan


def test_a_stream_without_velocities_does_not_fall_silent():
    node, _ = tuned_grcn(grcn(), flow(gaps=took(2 * SECOND), speeds=ValueStatistics()))
    assert node.flows[0].silent_after == 500 * MS


QUEUE = {"policy": PolicyName.PRIORITY_QUEUE}
TIMED = (replace(FLOWS[0], timeout=SECOND), FLOWS[1])


def test_queued_commands_wait_for_gaps():
    node, proposals = tuned_grcn(grcn(flows=TIMED, **QUEUE), flow(gaps=took(2 * SECOND, p999=MS)))
    assert node.flows[0].timeout == 2500 * MS
    assert about(proposals, "timeout", "flow1").kind is CHANGE
    assert not [each for each in proposals if each.key in ("done", "max_hold")]
    assert node.release_after == 500 * MS
    node, _ = tuned_grcn(grcn(**QUEUE), flow(gaps=took(2 * SECOND, p999=MS)))
    assert (node.flows[0].timeout, node.release_after) == (None, 2500 * MS)


def test_nobody_waits_in_a_queue_of_commands_for_the_last():
    last = replace(FLOWS[1], timeout=SECOND)
    figures = flow("flow2", "/teleop", took(2 * SECOND))
    node, _ = tuned_grcn(grcn(flows=(TIMED[0], last), **QUEUE), flow(), figures)
    assert node.flows[1].timeout == SECOND
    fifo = grcn(flows=(TIMED[0], last), policy=PolicyName.FIFO_QUEUE)
    node, _ = tuned_grcn(fifo, flow(), figures)
    assert node.flows[1].timeout == 3 * SECOND
    alone = grcn(flows=(last,), policy=PolicyName.FIFO_QUEUE)
    node, _ = tuned_grcn(alone, figures)
    assert node.flows[0].timeout == SECOND


GOALS = {
    "kind": StreamKind.ACTION,
    "policy": PolicyName.FIFO_QUEUE,
    "done": "/done",
    "flows": tuple(replace(each, timeout=10 * SECOND) for each in FLOWS),
    "max_age": 60 * SECOND,
}


def goals(name="flow1", publisher="/nav", takes=TAKES, **figures):
    return flow(name, publisher, speeds=ValueStatistics(), takes=takes, **figures)


@pytest.mark.parametrize(("count", "after"), [(4, 10), (5, 30)])
def test_a_goal_may_take_as_long_as_some_did(count, after):
    node, _ = tuned_grcn(grcn(**GOALS), goals(takes=took(20 * SECOND, count)))
    assert node.flows[0].timeout == after * SECOND


@pytest.mark.parametrize(("count", "undone", "after"), [(19, 0, 10), (20, 1, 10), (20, 0, 3)])
def test_a_goal_gets_less_time_only_if_all_goals_took_less(count, undone, after):
    takes = took(2 * SECOND, count, usual=SECOND // 2)
    node, _ = tuned_grcn(grcn(**GOALS), goals(takes=takes, undone=undone))
    assert node.flows[0].timeout == after * SECOND


def test_goals_of_one_flow_that_did_not_end_are_those_of_all():
    takes = took(2 * SECOND, 20, usual=SECOND // 2)
    blurred = goals("flow2", "/teleop", took(2 * SECOND, 20), undone=1)
    node, proposals = tuned_grcn(grcn(**GOALS), goals(takes=takes), blurred)
    assert node.flows[0].timeout == 10 * SECOND
    assert "the end of 1 goal" in about(proposals, "timeout", "flow1").why


def test_max_hold_follows_the_flow_that_takes_longest():
    figures = goals("flow2", "/teleop", took(100 * SECOND, 20))
    node, proposals = tuned_grcn(grcn(**GOALS), goals(), figures)
    assert node.max_hold == 150 * SECOND
    assert about(proposals, "max_hold").samples == 40
    node, proposals = tuned_grcn(grcn(**GOALS), goals(takes=took(SECOND, 19)), figures)
    assert node.max_hold == 600 * SECOND
    assert "too little is known of flow1" in about(proposals, "max_hold").why


@pytest.mark.parametrize(("done", "told"), [("/done", "is wrong"), (None, "names no topic")])
def test_goals_without_an_end_are_looked_at(done, told):
    node = grcn(**GOALS | {"done": done})
    made, proposals = tuned_grcn(node, goals(takes=DurationStatistics(), undone=7))
    assert made == node
    found = about(proposals, "done")
    assert found.kind is LOOK
    assert f"`done` {told}" in found.why
    action = replace(node, topic="/go/goal", type="test/GoActionGoal")
    asked = stream(goals(takes=DurationStatistics()), topic=action.topic)
    _, proposals = tuned(Plan(app="base", grcn=(action,)), run(asked))
    assert "its server gave no result" in about(proposals, "done").why


HELD = RefusalStatistics(
    policy=PolicyName.FIFO_QUEUE, decision=Decision.HOLD, count=100, reason="flow2 has the output"
)


@pytest.mark.parametrize(("held", "after"), [(100, 8), (101, 60)])
def test_max_age_is_shorter_if_all_that_waited_went_sooner(held, after):
    waits = took(5 * SECOND, 100)
    figures = goals(
        takes=took(9 * SECOND, 20, usual=SECOND), waits=waits, refusals=(replace(HELD, count=held),)
    )
    settings = GOALS | {"flows": FLOWS, "max_hold": 15 * SECOND}
    assert tuned_grcn(grcn(**settings), figures)[0].max_age == after * SECOND


def test_max_hold_outlasts_three_times_what_is_usual_for_any_flow():
    slow = goals("flow2", "/teleop", took(40 * SECOND, 20, usual=39 * SECOND))
    node, _ = tuned_grcn(grcn(**GOALS), goals(takes=took(SECOND, 20)), slow)
    assert node.max_hold == 120 * SECOND


def test_max_age_stays_where_other_durations_change():
    figures = goals(takes=took(20 * SECOND, 20), waits=took(SECOND), refusals=(HELD,))
    node, _ = tuned_grcn(grcn(**GOALS), figures)
    assert (node.flows[0].timeout, node.max_age) == (30 * SECOND, 60 * SECOND)


def steady(**figures):
    return flow(active=300 * SECOND, **figures)


def seldom(active=60 * SECOND, lost=30 * SECOND, pauses=2, **figures):
    return flow(
        **{"name": "flow2", "publisher": "/teleop"} | figures,
        active=active,
        pauses=took(60 * SECOND, pauses),
        overlaps=(OverlapStatistics(flow="flow1", duration=lost),),
    )


def order(node):
    return [each.name for each in sorted(node.flows, key=lambda each: -each.priority)]


@pytest.mark.parametrize(
    ("figures", "moved"),
    [
        ([steady(), seldom()], True),
        ([steady(), seldom(active=60 * SECOND + 1, lost=60 * SECOND)], False),
        ([steady(), seldom(lost=30 * SECOND - 1)], False),
        ([steady(), seldom(pauses=1)], False),
        ([replace(steady(), active=300 * SECOND - 1), seldom()], False),
        ([steady(), seldom(gaps=took(MS, 18))], False),
        ([steady(), seldom(gaps=took(MS, 19))], True),
        ([steady(), seldom(active=0, lost=0)], False),
        ([steady()], False),
    ],
)
def test_an_occasional_flow_goes_before_a_steady_one_that_drowns_it(figures, moved):
    node, proposals = tuned_grcn(grcn(), *figures)
    assert (order(node) == ["flow2", "flow1"]) is moved
    assert {each.priority for each in node.flows} == {1, 2}
    assert sum(each.key == "priority" for each in proposals) == 2 * moved


@pytest.mark.parametrize(("duration", "moved"), [(60 * SECOND - 1, False), (60 * SECOND, True)])
def test_a_short_run_shows_no_order(duration, moved):
    figures = (replace(steady(), active=duration), seldom(active=SECOND, lost=SECOND))
    node, _ = tuned_grcn(grcn(), *figures, duration=duration)
    assert (order(node) == ["flow2", "flow1"]) is moved


def test_the_figures_and_a_warning_stand_beside_a_new_order():
    beside = (OverlapStatistics(flow="unapproved", duration=59 * SECOND), *seldom().overlaps)
    beside += (OverlapStatistics(flow="flow3", duration=SECOND),)
    _, proposals = tuned_grcn(grcn(), steady(), replace(seldom(), overlaps=beside))
    found = about(proposals, "priority", "flow2")
    assert (found.before, found.after) == ("1", "2")
    assert found.why == (
        "/teleop spoke in 3 phases, 60 s in all (10 % of the run), 30 s of it in vain beside /nav "
        "(50 % of the run); right only if /teleop may interrupt"
    )


@pytest.mark.parametrize(
    "name", ["/safe_control", "/Safety", "/emergency_stop", "/estop", "/bumper", "/collision_mon"]
)
def test_what_is_there_for_safety_is_never_put_behind(name):
    flows = (replace(FLOWS[0], publisher=name), FLOWS[1])
    node, _ = tuned_grcn(grcn(flows=flows), steady(publisher=name), seldom())
    assert order(node) == ["flow1", "flow2"]


def test_no_name_puts_a_flow_before_another():
    flows = (FLOWS[0], replace(FLOWS[1], publisher="/emergency_stop"))
    figures = seldom(publisher="/emergency_stop", lost=SECOND)
    assert order(tuned_grcn(grcn(flows=flows), steady(), figures)[0]) == ["flow1", "flow2"]


def test_a_flow_overtakes_no_further_than_the_figures_reach():
    flows = (
        Flow(name="top", publisher="/top", priority=40),
        Flow(name="flow1", publisher="/nav", priority=30),
        Flow(name="flow2", publisher="/teleop", priority=-7),
    )
    figures = (flow("top", "/top", active=599 * SECOND), steady(), seldom())
    node, _ = tuned_grcn(grcn(flows=flows), *figures)
    assert {each.name: each.priority for each in node.flows} == {
        "top": 40,
        "flow2": 30,
        "flow1": -7,
    }


@pytest.mark.parametrize(
    "settings", [{"policy": PolicyName.BLOCK}, {"policy": PolicyName.FIFO_QUEUE}, GOALS | QUEUE]
)
def test_an_order_that_means_nothing_stays(settings):
    node = grcn(**settings)
    made, _ = tuned_grcn(node, steady(), seldom())
    assert [each.priority for each in made.flows] == [2, 1]


MONITOR = FpsMonitor(id="fps_cam", node="/detector", topic="/detector/image")
VFLOW = GuardedTopic(
    topic=TOPIC,
    type=TWIST,
    flows=(Flow(name="vflow1", publisher="/nav", priority=1),),
    successors=("/driver",),
)


def limited(policy=PolicyName.SAFE, **settings):
    wanted = {"threshold": 0.05, "vflows": (VFLOW,)}
    return RSRCN(
        id="rsrcn",
        mode=Mode.ENFORCE,
        policy=policy,
        iflows=(WatchedFlow(name="iflow1", topic=MONITOR.topic, publisher=MONITOR.node),),
        **wanted | settings,
    )


def threshold(per_frame, node=None, **figures):
    plan = Plan(app="base", rsrcn=node or limited(), fps_monitor=(MONITOR,))
    spoke = flow("vflow1", gaps=took(400 * MS, usual=MS, p999=MS))
    made, proposals = tuned(plan, run(stream(spoke, per_frame=per_frame, **figures)))
    return made.rsrcn, proposals


@pytest.mark.parametrize(
    ("most", "after", "kind"),
    [
        (0.01, 0.012, CHANGE),
        (0.027, 0.03, CHANGE),
        (0.036, 0.04, CHANGE),
        (0.0364, 0.05, KEEP),
        (0.05, 0.05, KEEP),
        (0.0500001, 0.05, LOOK),
        (1000.0, 0.05, LOOK),
        (0.0, 0.05, KEEP),
        (1e-9, 1e-6, CHANGE),
    ],
)
def test_a_threshold_becomes_lower_and_never_higher(most, after, kind):
    node, proposals = threshold(values(most, ENOUGH_VELOCITIES))
    assert node.threshold == after
    assert about(proposals, "threshold").kind is kind


@pytest.mark.parametrize(
    ("count", "after"), [(ENOUGH_VELOCITIES - 1, 0.05), (ENOUGH_VELOCITIES, 0.012)]
)
def test_a_threshold_needs_many_velocities(count, after):
    assert threshold(values(0.01, count))[0].threshold == after


def test_a_threshold_that_limits_nothing_stays():
    node = limited(PolicyName.CONSTRAIN, max_vel_limit=1.0)
    assert threshold(values(0.01), node)[0].threshold == 0.05


@pytest.mark.parametrize(("limit", "told"), [(0.5, 0), (0.49, 1)])
def test_what_the_user_s_limit_would_change_is_told(limit, told):
    node = limited(PolicyName.CONSTRAIN, max_vel_limit=limit)
    made, proposals = threshold(ValueStatistics(), node)
    assert made.max_vel_limit == limit
    assert sum(each.key == "max_vel_limit" for each in proposals) == told


def test_a_limit_that_does_not_limit_is_not_told():
    _, proposals = threshold(ValueStatistics(), limited(PolicyName.SAFE, max_vel_limit=0.1))
    assert not [each for each in proposals if each.key == "max_vel_limit"]


@pytest.mark.parametrize("unseen", [0, 1])
def test_velocities_without_frames_are_told(unseen):
    _, proposals = threshold(ValueStatistics(), unseen=unseen)
    assert sum(each.key == "lowest" for each in proposals) == unseen


def monitored(gaps, pauses=NONE, monitor=MONITOR):
    plan = Plan(app="base", fps_monitor=(monitor,))
    figures = MonitorStatistics(id="fps_cam", frames=gaps.count + 1, gaps=gaps, pauses=pauses)
    made, proposals = tuned(plan, run(monitors=(figures,)))
    return made.fps_monitor[0], proposals


@pytest.mark.parametrize(("longest", "after"), [(320, 400), (800, 1000), (801, 1200)])
def test_an_image_node_is_silent_after_more_than_its_longest_gap(longest, after):
    made, _ = monitored(took(longest * MS, usual=MS, p999=MS))
    assert made.silent_after == after * MS


def test_a_monitor_that_saw_a_silence_becomes_no_more_nervous():
    made, proposals = monitored(took(100 * MS), pauses=took(4 * SECOND, 1))
    assert made.silent_after == SECOND
    assert "silent for 4 s" in about(proposals, "silent_after").why


@pytest.mark.parametrize(("usual", "after"), [(200 * MS, 1000), (200 * MS + 1, 1200)])
def test_a_window_holds_five_frames(usual, after):
    assert monitored(took(usual, usual=usual))[0].window == after * MS


def test_a_window_is_longer_than_the_longest_gap():
    assert monitored(took(SECOND, usual=MS))[0].window == 1500 * MS


def test_a_window_is_as_long_as_the_silence_that_it_must_see():
    made, proposals = monitored(took(810 * MS, usual=MS, p999=805 * MS))
    assert (made.silent_after, made.window) == (1500 * MS, 1500 * MS)
    assert about(proposals, "window").kind is CHANGE


def test_a_window_has_a_greatest():
    slow = took(12 * SECOND, usual=12 * SECOND)
    assert monitored(slow)[0].window == MAX_WINDOW
    made, proposals = monitored(took(12 * SECOND + 1, usual=12 * SECOND + 1))
    assert made.window == SECOND
    assert about(proposals, "window").kind is LOOK


def mission(**settings):
    wanted = {"when": "event.data", "type": "std_msgs/Bool"}
    event = EventFlow(name="eflow1", topic="/lamp", publisher="/lamp", **wanted | settings)
    return MSRCN(id="msrcn", mode=Mode.ENFORCE, policy=PolicyName.BLOCK, eflows=(event,))


def event(gaps, pauses=NONE, **settings):
    plan = Plan(app="base", msrcn=mission(**settings))
    figures = EventStatistics(name="eflow1", messages=gaps.count + 1, gaps=gaps, pauses=pauses)
    return tuned(plan, run(events=(figures,)))[0].msrcn.eflows[0]


def test_an_event_may_be_as_old_as_its_longest_gap():
    assert event(took(2 * SECOND, p999=MS)).max_age == 2500 * MS
    assert event(took(SECOND // 2, usual=MS)).max_age == 800 * MS
    assert event(took(SECOND // 2, usual=MS), pauses=took(9 * SECOND, 1)).max_age == 2 * SECOND


def test_a_silence_that_is_an_event_becomes_no_shorter():
    assert event(took(2 * SECOND, p999=MS), silent=SECOND).silent == 2500 * MS
    assert event(took(100 * MS), silent=SECOND).silent == SECOND


def test_a_presence_is_the_mission_s_own():
    assert event(took(2 * SECOND), present=SECOND) == mission(present=SECOND).eflows[0]


def test_the_silences_of_later_nodes_follow_the_first():
    first = replace(FLOWS[0], silent_after=SECOND)
    later = replace(VFLOW, flows=(replace(VFLOW.flows[0], silent_after=SECOND),))
    node = RSRCN(id="rsrcn", mode=Mode.ENFORCE, policy=PolicyName.BLOCK, vflows=(later,))
    plan = Plan(app="base", grcn=(grcn(flows=(first, FLOWS[1])),), rsrcn=node)
    assert not list(coherence_problems(plan))
    made, _ = tuned(plan, run(stream(flow(gaps=took(2 * SECOND, p999=MS)))))
    assert made.grcn[0].flows[0].silent_after == 2500 * MS
    assert made.rsrcn.vflows[0].flows[0].silent_after == Flow(name="", publisher="").silent_after


def test_a_node_alone_on_a_topic_decides_about_silence():
    made, _ = threshold(ValueStatistics())
    assert made.vflows[0].flows[0].silent_after == 500 * MS
    plan = Plan(app="base", rsrcn=limited(), fps_monitor=(MONITOR,))
    spoke = flow("vflow1", gaps=took(2 * SECOND, p999=MS))
    made, _ = tuned(plan, run(stream(spoke)))
    assert made.rsrcn.vflows[0].flows[0].silent_after == 2500 * MS


def test_strangers_and_the_silent_are_told():
    stranger = FlowStatistics(flow="unapproved", publisher="*", messages=12)
    plan = Plan(app="base", grcn=(grcn(),))
    _, proposals = tuned(plan, run(stream(flow(), stranger, strangers=("/rviz",))))
    told = [each.why for each in proposals if each.kind is LOOK]
    assert told[0].startswith("/teleop never spoke")
    assert told[1].startswith("/rviz is not in the plan")
    assert "12 messages" in told[1]


@pytest.mark.parametrize("other", [{"app": "other"}, {"ros": 2}])
def test_a_run_of_another_app_is_told(other):
    _, proposals = tuned(Plan(app="base"), replace(run(), **other))
    assert [each.key for each in proposals] == ["app"]


def test_a_topic_without_figures_stays_as_it_is():
    plan = Plan(app="base", grcn=(grcn(),))
    for measured in (run(), run(stream(flow(), mode=Mode.OBSERVE))):
        made, proposals = tuned(plan, measured)
        assert made == plan
        assert [each.kind for each in proposals] == [LOOK]


def test_the_yaml_has_the_figures_above_the_node():
    plan = Plan(app="base", grcn=(grcn(),))
    made, proposals = tuned(plan, run(stream(flow(gaps=took(2 * SECOND, p999=MS)))))
    lines = tuned_yaml(made, proposals).split("\n")
    at = lines.index("  - id: grcn_cmd_vel")
    told = " ".join(line.strip().removeprefix("#").strip() for line in lines[at - 4 : at])
    assert "release_after: 0.5 s -> 2.5 s (flow1: 1 000 gaps, largest 2 s," in told
    assert all(len(line) <= 100 for line in lines[1:])  # the first is an address


def test_a_hostile_name_stays_in_its_comment():
    _, proposals = tune_plan(Plan(app="base", grcn=(grcn(),)), run(stream(steady(), seldom())))
    evil = [replace(each, why="x\ny: [\u2028]\x1b") for each in proposals]
    text = tuned_yaml(Plan(app="base", grcn=(grcn(),)), evil)
    assert "x?y: [?]?" in text
