"""New settings for the running guard: what moves the robot, who goes first, what is refused."""

from contextlib import suppress
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import settings as effort
from hypothesis import strategies as st
from settings_app import GENERAL, MAPS, PLAN, TWIST, WALL, Base, flow, limit, of, rule
from streams import peer
from velocity_messages import twist

from example_budget import examples
from rtron.errors import InputError, RTronError
from rtron.vocabulary import (
    SECOND,
    Decision,
    EmergencyStop,
    Flow,
    FlowSettings,
    MissionRule,
    Mode,
    NodeSettings,
    PolicyName,
    RuleSettings,
    Settings,
    TimedOverride,
)

RELEASE = GENERAL.release_after


@pytest.fixture
def base():
    return Base()


def policies(base):
    return [policy for each in base.host.streams for policy in each.pipeline.policies]


def test_only_what_changes_gets_a_new_policy_and_everything_else_stays(base):
    guarded, pipelines = base.host.streams, [each.pipeline for each in base.host.streams]
    told = []
    base.stream().pipeline.on_verdict_change = told.append
    before = policies(base)
    base.apply(flow("flow2", priority=5))
    assert base.host.streams is guarded
    assert [each.pipeline for each in guarded] == pipelines
    differ = [one is not other for one, other in zip(before, policies(base), strict=True)]
    assert differ == [True, False, False, False, False, False]
    base.drive(1.0)
    assert [verdict.revision for verdict in told] == [2]


def test_verdicts_of_policies_that_did_not_change_have_the_new_revision(base):
    base.ask(1.0)
    base.ask(1.0)
    assert base.tally("aflow3", "/max_vel").last.revision == 1
    base.apply(flow("flow2", revision=7, priority=5))
    base.ask(1.0)
    assert base.tally("aflow3", "/max_vel").last.revision == 7
    base.host.streams[0].bar("somebody", "/nav", "why not")
    base.apply(Settings(revision=8))
    base.drive(1.0)
    assert base.tally("flow1").last.revision == 8
    assert base.applying.revision == 8


def test_who_was_higher_and_is_lower_now_gives_way_at_once_and_nobody_slips_in(base):
    base.drive(1.0)
    base.transport.advance(RELEASE - 1)
    base.drive(0.1, "teleop")
    base.apply(flow("flow2", priority=5))
    base.drive(0.9)
    assert base.xs() == [1.0]
    base.drive(0.2, "teleop")
    base.transport.advance(RELEASE - 1)
    base.drive(0.9)
    assert base.xs() == [1.0, 0.2]
    base.transport.advance(1)
    base.drive(0.9)
    assert base.xs() == [1.0, 0.2, 0.9]


def test_a_longer_release_holds_for_who_has_spoken_before(base):
    base.drive(1.0)
    base.transport.advance(RELEASE - 1)
    base.apply(of("grcn", release_after=2 * RELEASE))
    base.transport.advance(RELEASE)
    base.drive(0.1, "teleop")
    assert base.xs() == [1.0]
    base.transport.advance(1)
    base.drive(0.1, "teleop")
    assert base.xs() == [1.0, 0.1]


def test_a_shorter_release_frees_the_output_at_once(base):
    base.drive(1.0)
    base.transport.advance(RELEASE // 2)
    base.apply(of("grcn", release_after=RELEASE // 2))
    assert base.stream().pipeline.owner is None
    base.drive(0.1, "teleop")
    assert base.xs() == [1.0, 0.1]


@pytest.mark.parametrize(
    ("id", "name"), [("grcn", "flow1"), ("msrcn", "aflow1"), ("rsrcn", "vflow1")]
)
def test_blocking_the_flow_that_moves_the_base_stops_it(base, id, name):
    base.drive(1.0)
    base.apply(flow(name, id, block=True))
    base.transport.advance(2 * SECOND)
    xs = base.xs()
    assert xs == sorted(xs, reverse=True)
    assert xs[:2] == [1.0, 0.875]
    assert xs[-1] == 0.0
    base.drive(1.0)
    assert base.xs() == xs
    assert base.stream().stop_controller.stop_count == 1
    base.apply(Settings(revision=3))
    base.drive(0.5)
    assert base.xs()[-1] == 0.5


def test_blocking_another_flow_does_not_stop_the_base(base):
    base.drive(1.0)
    base.apply(flow("flow2", block=True))
    base.transport.advance(SECOND)
    assert base.xs() == [1.0]


def test_a_lowered_limit_takes_effect_within_no_message_at_all(base):
    base.drive(2.0, turn=1.0)
    base.apply(limit(0.5))
    assert base.xs() == [2.0, 0.5]
    base.apply(limit(1.0, 3))
    assert base.xs() == [2.0, 0.5]
    base.drive(2.0)
    assert base.xs() == [2.0, 0.5, 1.0]


def test_a_limit_of_zero_stops_the_base(base):
    base.drive(1.0)
    base.apply(limit(0.0))
    base.transport.advance(2 * SECOND)
    assert base.xs()[1] == 0.875
    assert base.xs()[-1] == 0.0


def test_the_maximal_velocity_follows_the_limit_at_once_in_both_directions(base):
    base.ask(2.0)
    base.apply(limit(0.5))
    base.apply(limit(1.0, 3))
    base.apply(limit(1.0, 4))
    base.apply(limit(9.0, 5))
    assert base.asked() == [2.0, 0.5, 1.0, 2.0]
    base.transport.advance(10 * SECOND)
    assert base.asked() == [2.0, 0.5, 1.0, 2.0]


def test_a_limit_in_the_place_of_none_holds_for_what_went_out_before():
    rsrcn = replace(PLAN.rsrcn, policy=PolicyName.BLOCK)
    base = Base(replace(PLAN, rsrcn=rsrcn))
    base.drive(2.0)
    base.ask(2.0)
    base.apply(of("rsrcn", policy=PolicyName.CONSTRAIN, max_vel_limit=0.5))
    assert base.xs() == [2.0, 0.5]
    assert base.asked() == [2.0, 0.5]
    base.apply(Settings(revision=3))
    base.drive(2.0)
    base.ask(2.0)
    assert (base.xs()[-1], base.asked()[-1]) == (2.0, 2.0)


def test_safe_in_the_place_of_constrain_counts_the_frames_so_far(base):
    base.drive(2.0)
    monitor = base.host.observations.rates.monitors["fps"]
    for _ in range(10):
        base.transport.advance(SECOND // 10)
        monitor.add_frame(base.transport.now(), base.transport.now())
    base.apply(of("rsrcn", policy=PolicyName.SAFE))
    assert base.xs() == [2.0, pytest.approx(0.1 * monitor.rate(base.transport.now()).fps)]


def test_a_rule_that_is_deselected_frees_and_one_that_is_selected_again_stops(base):
    base.event("red")
    base.drive(1.0)
    assert base.xs() == []
    base.apply(rule("red_light", selected=False))
    base.drive(1.0)
    assert base.xs() == [1.0]
    base.apply(rule("red_light", revision=3, selected=True))
    base.transport.advance(2 * SECOND)
    assert base.xs()[:2] == [1.0, 0.875]
    assert base.stream().stop_controller.last_flow == "flow1"
    base.drive(1.0)
    assert base.xs()[-1] == 0.0
    assert base.tally("flow1").last.reason == "rule red_light: the light is red"


def test_a_rule_of_the_user_s_own_holds_at_once(base):
    base.event("fire")
    base.drive(0.4)
    base.apply(rule("own", when="fire && !red", block=("aflow1",)))
    base.transport.advance(2 * SECOND)
    assert base.xs()[-1] == 0.0
    base.drive(0.4)
    assert base.tally("flow1").last.reason == "rule own: while fire && !red"
    base.drive(0.3, "teleop")
    assert base.xs()[-1] == 0.3
    base.event("red")
    assert "own" not in [
        n for n, s in base.host.observations.mission.statuses.items() if s.is_blocking
    ]


def test_what_a_rule_requires_is_seen_as_long_as_the_rule_counts(caplog):
    slow_first = MissionRule(name="slow_first", when="fire", block=("/cmd_vel",), require="aflow3")
    msrcn = replace(PLAN.msrcn, rules=(slow_first,))
    base = Base(replace(PLAN, msrcn=msrcn))
    base.event("fire")
    base.drive(0.1)
    base.apply(rule("slow_first", selected=False))
    base.drive(0.2)
    base.ask(1.0)
    base.apply(rule("slow_first", revision=3, selected=True))
    base.transport.advance(2 * SECOND)
    base.drive(0.3)
    base.ask(1.0)
    base.drive(0.4)
    assert [x for x in base.xs() if x in (0.1, 0.2, 0.3, 0.4)] == [0.2, 0.4]
    assert base.asked() == [1.0, 1.0]
    assert "internal error" not in caplog.text


def test_another_condition_of_a_rule_is_asked_at_once(base):
    base.event("fire")
    base.drive(0.4)
    base.apply(rule("red_light", when="red || fire"))
    base.drive(0.4)
    base.apply(rule("red_light", revision=3, when="red && fire"))
    base.drive(0.3)
    assert [x for x in base.xs() if x in (0.4, 0.3)] == [0.4, 0.3]


def test_a_rule_that_looks_into_messages_can_be_moved_to_other_flows(base):
    base.event("fire")
    base.apply(rule("not_fast", block=("aflow2",)))
    base.drive(1.0)
    base.transport.advance(RELEASE)
    base.drive(1.0, "teleop")
    base.drive(0.5, "teleop")
    assert base.xs() == [1.0, 0.5]


def test_a_rule_that_cannot_look_into_a_topic_is_refused(base):
    before = policies(base)
    with pytest.raises(InputError, match="linear"):
        base.apply(rule("not_fast", block=("/max_vel",)))
    assert policies(base) == before


def test_a_rule_can_look_into_one_more_topic_of_its_type():
    slow = replace(GENERAL, id="grcn_slow", topic="/slow_vel")
    slow = replace(slow, flows=tuple(replace(f, name=f"slow{f.name}") for f in slow.flows))
    topic = replace(
        PLAN.msrcn.aflows[0],
        topic="/slow_vel",
        flows=tuple(replace(f, name=f"s{f.name}") for f in PLAN.msrcn.aflows[0].flows),
    )
    msrcn = replace(PLAN.msrcn, aflows=(*PLAN.msrcn.aflows, topic))
    base = Base(replace(PLAN, grcn=(*PLAN.grcn, slow), msrcn=msrcn))
    out = base.transport.listen("/rtron/slow_vel/out")
    say = base.transport.publisher("/rtron/slow_vel/slowflow1", peer("/nav", TWIST))
    base.event("fire")
    say(twist(1.0))
    base.apply(rule("not_fast", block=("/cmd_vel", "/slow_vel")))
    say(twist(1.0))
    say(twist(0.4))
    assert len(out) == 2
    other = replace(TWIST, md5sum="0" * 32)
    assert base.transport.publisher("/rtron/slow_vel/slowflow2", peer("/teleop", other))
    assert base.stream("/slow_vel").endpoints.rules_md5sum == TWIST.md5sum


def test_two_rules_look_into_a_topic_that_one_of_them_was_moved_to():
    turning = replace(
        PLAN.msrcn.aflows[0], topic="/turn_vel", flows=(Flow(name="aflow9", publisher="/turner"),)
    )
    fields = {"block": ("aflow9",), "action": "action.angular.z != 0.0"}
    elsewhere = replace(PLAN.msrcn.rules[1], name="elsewhere", **fields)
    msrcn = replace(
        PLAN.msrcn, aflows=(*PLAN.msrcn.aflows, turning), rules=(*PLAN.msrcn.rules, elsewhere)
    )
    base = Base(replace(PLAN, msrcn=msrcn))
    base.event("fire")
    base.drive(0.4, turn=1.0)
    base.apply(rule("elsewhere", block=("/cmd_vel",)))
    base.drive(0.3, turn=1.0)
    base.drive(0.9)
    assert base.xs() == [0.4]
    assert base.tally("flow1").last.reason == "rule not_fast: while fire"
    base.drive(0.2)
    assert base.xs() == [0.4, 0.2]


def test_messages_of_another_version_than_a_moved_rule_is_written_for_refuse_it(base):
    base.stream().endpoints.type_info = replace(TWIST, md5sum="0" * 32)
    with pytest.raises(InputError, match="another version"):
        base.apply(rule("not_fast", block=("/cmd_vel",)))
    assert base.applying.revision == 1


@pytest.mark.parametrize(
    "settings",
    [
        of("nobody"),
        flow("flow9", priority=1),
        flow("flow1", priority=1),
        limit(float("nan")),
        limit(-1.0),
        of("grcn", release_after=-1),
        of("grcn", max_hold=10**400),
        of("grcn", policy=PolicyName.SAFE),
        rule("own", when="red &&", block=("/cmd_vel",)),
        rule("own", when="(" * 100 + "red" + ")" * 100, block=("/cmd_vel",)),
        rule("own", when="smoke", block=("/cmd_vel",)),
        rule("own", when="\ud800", block=("/cmd_vel",)),
        rule("own", when="red", block=("/odom",)),
        rule("red_light", when="red ||"),
        Settings(revision=-1),
        Settings(overrides={"grcn": TimedOverride(by="ann", reason="", until=WALL + 1)}),
    ],
)
def test_settings_that_cannot_be_change_nothing(base, settings):
    stop = EmergencyStop(by="ann", reason="", at=0)
    good = {"grcn": NodeSettings(release_after=1), "rsrcn": NodeSettings(max_vel_limit=0.1)}
    base.event("red")
    before = policies(base), dict(base.host.observations.mission.statuses)
    mixed = replace(settings, nodes={**good, **settings.nodes}, stop=stop)
    with pytest.raises(RTronError):
        base.apply(mixed)
    assert policies(base) == before[0]
    assert base.host.observations.mission.statuses == before[1]
    assert base.applying.revision == 1
    assert not base.applying.is_stopped
    assert base.stream().brake_reason == ""


def test_settings_before_the_host_opens_are_in_force_when_it_does():
    base = Base(opened=False)
    base.apply(
        Settings(revision=4, nodes={**limit(0.5).nodes, **rule("red_light", selected=False).nodes})
    )
    base.open()
    base.event("red")
    base.drive(1.0)
    assert base.xs() == [0.5]
    assert base.tally("flow1").last.revision == 4


def test_a_flow_named_in_many_nodes_is_the_settings_of_each(base):
    both = {**flow("flow1", block=True).nodes, **flow("vflow2", "rsrcn", block=True).nodes}
    base.apply(Settings(revision=2, nodes=both))
    base.drive(1.0)
    base.drive(1.0, "teleop")
    assert base.xs() == []


def test_unapproved_flows_stay_where_the_plan_puts_them():
    open_to_all = replace(GENERAL, block_unapproved=False)
    base = Base(replace(PLAN, grcn=(open_to_all, MAPS)))
    stranger = base.transport.publisher("/cmd_vel", peer("/stranger", TWIST))
    stranger(twist(0.3))
    base.apply(flow("flow2", priority=5))
    stranger(twist(0.3))
    base.drive(0.4)
    stranger(twist(0.3))
    assert base.xs() == [0.3, 0.3, 0.4]


def test_a_dry_run_takes_settings_too_and_lets_everything_pass():
    base = Base(dry_run=True)
    base.drive(1.0)
    base.apply(flow("flow1", block=True))
    base.drive(1.0)
    assert base.xs() == [1.0, 1.0]
    assert base.tally("flow1").last.decision is Decision.DROP


def test_a_stream_that_observes_takes_settings_too():
    base = Base(replace(PLAN, grcn=(replace(GENERAL, mode=Mode.OBSERVE), MAPS)))
    base.apply(flow("flow1", block=True))
    assert [p.owner for each in base.host.streams for p in each.pipeline.policies]


nodes = st.fixed_dictionaries(
    {},
    optional={
        "grcn": st.builds(
            NodeSettings,
            policy=st.none()
            | st.sampled_from(
                [
                    PolicyName.BLOCK,
                    PolicyName.PREEMPTION,
                    PolicyName.FIFO_QUEUE,
                    PolicyName.PRIORITY_QUEUE,
                ]
            ),
            release_after=st.none() | st.sampled_from([0, SECOND // 10, SECOND]),
            flows=st.dictionaries(
                st.sampled_from(["flow1", "flow2"]),
                st.builds(
                    FlowSettings,
                    block=st.none() | st.booleans(),
                    priority=st.none() | st.integers(3, 9),
                ),
            ),
        ),
        "rsrcn": st.builds(
            NodeSettings,
            policy=st.none()
            | st.sampled_from([PolicyName.BLOCK, PolicyName.SAFE, PolicyName.SAFE_CONSTRAIN]),
            max_vel_limit=st.none() | st.sampled_from([0.0, 0.5, 1.0]),
        ),
        "msrcn": st.builds(
            NodeSettings,
            rules=st.dictionaries(
                st.sampled_from(["red_light", "not_fast", "own"]),
                st.builds(
                    RuleSettings,
                    selected=st.none() | st.booleans(),
                    when=st.none() | st.sampled_from(["red", "fire", "!fire"]),
                    block=st.none() | st.sampled_from([("/cmd_vel",), ("aflow1",), ("aflow2",)]),
                ),
            ),
        ),
    },
)
stops = st.none() | st.just(EmergencyStop(by="ann", reason="", at=0))
doings = st.one_of(
    st.tuples(st.just("apply"), st.builds(Settings, nodes=nodes, stop=stops)),
    st.tuples(st.sampled_from(["nav", "teleop"]), st.sampled_from([0.2, 0.8, 2.0])),
    st.tuples(st.just("ask"), st.sampled_from([0.2, 2.0])),
    st.tuples(st.just("event"), st.sampled_from(["red", "fire"])),
    st.tuples(st.just("wait"), st.sampled_from([1, SECOND // 10, SECOND // 2, SECOND])),
)


@effort(deadline=None, max_examples=examples(100))
@given(st.lists(doings, max_size=25))
def test_whatever_is_swapped_nothing_that_is_forbidden_goes_out(steps):
    base, stop = Base(), None
    for what, with_what in steps:
        out, revision = len(base.driver), base.applying.revision
        if what == "apply":
            with suppress(RTronError):
                base.apply(replace(with_what, revision=revision + 1))
                stop = with_what.stop
        elif what == "wait":
            base.transport.advance(with_what)
        elif what == "event":
            base.event(with_what)
        elif what == "ask":
            base.ask(with_what)
        else:
            base.drive(with_what, what)
            passed = len(base.driver) > out
            assert not (passed and stop)
            stream, name = base.stream(), {"nav": "flow1", "teleop": "flow2"}[what]
            blocked = any(
                f.name == name and f.block for s in stream.spec.stages for f in s.settings.flows
            )
            assert not (passed and blocked)
            assert base.tally(name).last.revision == base.applying.revision
    pipeline = base.stream().pipeline
    for policy in pipeline.policies:
        pipeline.drop_held(policy.close())
    for by, name in (("nav", "flow1"), ("teleop", "flow2")):
        tally = base.tally(name)
        said = sum(what == by for what, _ in steps)
        assert tally.passed + tally.modified + tally.dropped == said
