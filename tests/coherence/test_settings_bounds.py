"""Settings from strangers: refused whole, with a clear text, where a guard could not run them."""

import math
from contextlib import suppress
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from plans import grcn as grcn_of

from rtron.coherence import EffectivePlan, SettingsMismatchError, grcn, msrcn, rsrcn
from rtron.coherence.duration_bounds import (
    LONGEST_SILENCE,
    MAX_BLOCKED_FLOWS,
    MAX_CONDITION_LENGTH,
    MAX_CONDITIONS_LENGTH,
    MAX_INT64,
    MAX_NAME_LENGTH,
    MAX_RULES,
    MAX_TEXT_LENGTH,
    MAX_VELOCITY,
    MIN_NONZERO_VELOCITY,
    PRIORITY_RANGE,
)
from rtron.planning.plan_file import fields, quantities
from rtron.vocabulary import (
    MSRCN,
    RSRCN,
    SECOND,
    EmergencyStop,
    Flow,
    FlowSettings,
    FpsMonitor,
    GuardedTopic,
    LeaseGroup,
    MissionRule,
    Mode,
    NodeSettings,
    Plan,
    PolicyName,
    RuleSettings,
    Settings,
    Sharing,
    TimedOverride,
)

DAY = 24 * 3600 * SECOND
FLOWS = (
    Flow(name="flow1", publisher="/nav", priority=2),
    Flow(name="flow2", publisher="/teleop", priority=1),
)
GENERAL = grcn_of("/cmd_vel", (), (), id="grcn", flows=FLOWS)
TOPIC = GuardedTopic(
    topic="/cmd_vel",
    type="geometry_msgs/Twist",
    flows=tuple(replace(flow, name="a" + flow.name, priority=0) for flow in FLOWS),
)
VFLOWS = GuardedTopic(
    topic="/cmd_vel",
    type="geometry_msgs/Twist",
    flows=tuple(replace(flow, name="v" + flow.name, priority=0) for flow in FLOWS),
)
MISSION = MSRCN(
    id="msrcn",
    mode=Mode.ENFORCE,
    policy=PolicyName.BLOCK,
    aflows=(TOPIC,),
    rules=(MissionRule(name="alert", block=("aflow1",), require="aflow2"),),
)
ROBOT = RSRCN(id="rsrcn", mode=Mode.ENFORCE, policy=PolicyName.BLOCK, vflows=(VFLOWS,), lowest=0.1)
MONITOR = FpsMonitor(id="fps", node="/camera", topic="/image", silent_after=2 * SECOND)
PLAN = Plan(app="app", grcn=(GENERAL,), rsrcn=ROBOT, msrcn=MISSION, fps_monitor=(MONITOR,))

LEASABLE = replace(PLAN, grcn=(replace(GENERAL, lease="base"),), leases=(LeaseGroup(name="base"),))


def of(id, **values):
    return Settings(nodes={id: NodeSettings(**values)})


def flow(id, name, **values):
    return of(id, flows={name: FlowSettings(**values)})


def a_rule(name="own", **values):
    return of("msrcn", rules={name: RuleSettings(**values)})


def in_force(plan, settings):
    """Return the plan under settings, or raise as a guard would."""
    return EffectivePlan(plan, settings).check()


OWN = {"when": "true", "block": ("/cmd_vel",)}


def test_settings_within_their_bounds_are_in_force():
    settings = Settings(revision=7, nodes={"grcn": NodeSettings(policy=PolicyName.FIFO_QUEUE)})
    after = in_force(PLAN, settings)
    assert after.revision == 7
    assert after.grcn[0].policy is PolicyName.FIFO_QUEUE


@pytest.mark.parametrize(
    "settings",
    [
        Settings(revision=MAX_INT64),
        of("grcn", release_after=SECOND // 100, max_age=LONGEST_SILENCE, max_hold=DAY),
        flow("grcn", "flow1", priority=PRIORITY_RANGE[0], timeout=0),
        flow("grcn", "flow1", priority=PRIORITY_RANGE[1], timeout=LONGEST_SILENCE),
        of("rsrcn", policy=PolicyName.CONSTRAIN, max_vel_limit=0.0),
        of("rsrcn", policy=PolicyName.CONSTRAIN, max_vel_limit=MIN_NONZERO_VELOCITY),
        of("rsrcn", policy=PolicyName.CONSTRAIN, max_vel_limit=MAX_VELOCITY),
        of("rsrcn", policy=PolicyName.SAFE, threshold=MAX_VELOCITY),
        of("rsrcn", policy=PolicyName.SAFE, threshold=0.2),
        of("rsrcn", policy=PolicyName.SAFE_CONSTRAIN, threshold=0.2, max_vel_limit=1.0),
        a_rule("x" * MAX_NAME_LENGTH, **OWN),
        a_rule(when="a" * MAX_CONDITION_LENGTH, block=("/cmd_vel",) * MAX_BLOCKED_FLOWS),
        of("msrcn", rules={n: RuleSettings(when="a" * 4096, block=("/cmd_vel",)) for n in "ab"}),
        a_rule("alert", selected=False),
        of("msrcn", rules={f"r{n}": RuleSettings(**OWN) for n in range(MAX_RULES - 1)}),
        Settings(overrides={"rsrcn": TimedOverride(by="x" * MAX_TEXT_LENGTH, reason="", until=0)}),
        Settings(overrides={"msrcn": TimedOverride(by="", reason="", until=MAX_INT64)}),
        Settings(stop=EmergencyStop(by="", reason="x" * MAX_TEXT_LENGTH, at=0)),
        of("rsrcn", flows={"vflow1": FlowSettings(priority=1)}),
    ],
)
def test_the_bounds_themselves_are_within(settings):
    assert in_force(PLAN, settings).revision == settings.revision


@pytest.mark.parametrize(
    ("settings", "told"),
    [
        (Settings(revision=-1), "revision is not between"),
        (Settings(revision=MAX_INT64 + 1), "revision is not between"),
        (of("grcn", release_after=-1), "'grcn': release_after is not between"),
        (of("grcn", release_after=0), "'grcn': release_after is not between 0.01 s and 3600 s"),
        (of("grcn", max_age=DAY + 1), "'grcn': max_age is not between"),
        (of("grcn", max_age=LONGEST_SILENCE + SECOND), "grcn: max_age is 11 s: for commands 10 s"),
        (of("grcn", release_after=3600 * SECOND), "release_after is 3600 s: for commands 10 s"),
        (flow("grcn", "flow1", timeout=DAY), "timeout is 86400 s: for commands 10 s"),
        (of("grcn", max_hold=-(10**400)), "'grcn': max_hold is not between"),
        (of("rsrcn", threshold=0.0), "threshold is not between"),
        (of("rsrcn", threshold=math.nan), "threshold is not between"),
        (of("rsrcn", threshold=math.nextafter(MAX_VELOCITY, math.inf)), "threshold is not between"),
        (of("rsrcn", max_vel_limit=math.nan), "max_vel_limit is not between"),
        (of("rsrcn", max_vel_limit=math.inf), "max_vel_limit is not between"),
        (of("rsrcn", max_vel_limit=-0.1), "max_vel_limit is not between"),
        (
            of("rsrcn", max_vel_limit=math.nextafter(MIN_NONZERO_VELOCITY, 0)),
            "max_vel_limit is not",
        ),
        (flow("grcn", "flow1", priority=PRIORITY_RANGE[1] + 1), "'flow1': priority is not between"),
        (flow("grcn", "flow1", priority=PRIORITY_RANGE[0] - 1), "'flow1': priority is not between"),
        (flow("grcn", "flow1", timeout=-1), "'flow1': timeout is not between"),
        (flow("grcn", "flow1", priority=1), "flow1 and flow2 have the same priority 1"),
        (flow("grcn", "flow9"), "no flow of grcn is called flow9"),
        (of("nobody"), "no coordination node is called nobody"),
        (of("grcn", threshold=1.0), "no setting of grcn is called threshold"),
        (of("grcn", policy=PolicyName.SAFE), "grcn: Safe is not for a GRCN"),
        (of("rsrcn", policy=PolicyName.PREEMPTION), "rsrcn: Preemption is not for the RSRCN"),
        (of("msrcn", policy=PolicyName.CONSTRAIN), "msrcn: Constrain is not for the MSRCN"),
        (of("rsrcn", policy=PolicyName.CONSTRAIN), "rsrcn: Constrain needs a max_vel_limit"),
        (of("rsrcn", policy=PolicyName.SAFE), "rsrcn: Safe needs a threshold"),
        (of("rsrcn", policy=PolicyName.SAFE, threshold=0.1999), "rsrcn: 0.1 m/s is too fast"),
        (of("grcn", rules={"own": RuleSettings(**OWN)}), "grcn has no rules"),
        (a_rule("no word", **OWN), "a rule's name is a word"),
        (a_rule("", **OWN), "a rule's name is a word"),
        (a_rule("x" * (MAX_NAME_LENGTH + 1), **OWN), "a rule's name is a word"),
        (a_rule(when="a" * (MAX_CONDITION_LENGTH + 1), block=("/cmd_vel",)), "longer than"),
        (a_rule(when="true", block=("/cmd_vel",) * (MAX_BLOCKED_FLOWS + 1)), "blocks more than"),
        (
            of(
                "msrcn",
                rules={
                    "a": RuleSettings(when="a" * 4096, block=("/cmd_vel",)),
                    "b": RuleSettings(when="a" * 4096, block=("/cmd_vel",)),
                    "alert": RuleSettings(when="a"),
                },
            ),
            f"longer than {MAX_CONDITIONS_LENGTH} characters together",
        ),
        (a_rule(when="true"), "a new one needs `when` and `block`"),
        (a_rule(when="true", block=("/elsewhere",)), "no aflow or topic /elsewhere"),
        (a_rule("alert", block=("aflow2",)), "rule alert: the rule itself blocks aflow2"),
        (a_rule("alert", block=("/cmd_vel",)), "rule alert: the rule itself blocks aflow2"),
        (
            of("msrcn", rules={f"r{n}": RuleSettings(**OWN) for n in range(MAX_RULES)}),
            f"more than {MAX_RULES} rules",
        ),
        (
            of("msrcn", rules={f"r{n}": RuleSettings(**OWN) for n in range(MAX_RULES + 1)}),
            f"'msrcn': more than {MAX_RULES} rules",
        ),
        (
            Settings(overrides={"grcn": TimedOverride(by="", reason="", until=1)}),
            "'grcn' cannot be overridden",
        ),
        (
            Settings(overrides={"rsrcn": TimedOverride(by="", reason="", until=-1)}),
            "override of 'rsrcn': until is not between",
        ),
        (
            Settings(
                overrides={
                    "rsrcn": TimedOverride(by="x" * (MAX_TEXT_LENGTH + 1), reason="", until=1)
                }
            ),
            "a text is longer than",
        ),
        (
            Settings(stop=EmergencyStop(by="", reason="x" * (MAX_TEXT_LENGTH + 1), at=0)),
            "emergency stop: a text is longer",
        ),
    ],
)
def test_what_a_guard_cannot_run_is_refused(settings, told):
    with pytest.raises(SettingsMismatchError) as raised:
        in_force(PLAN, settings)
    assert told in str(raised.value)


def test_a_stop_of_no_time_is_refused():
    with pytest.raises(SettingsMismatchError, match="emergency stop: at is not between"):
        in_force(PLAN, Settings(stop=EmergencyStop(by="", reason="", at=-1)))


def test_plans_are_read_within_the_same_bounds():
    assert fields._RANGES["revision"] == (0, MAX_INT64)
    assert fields._RANGES["priority"] == PRIORITY_RANGE
    assert quantities.VELOCITY.maximum == quantities.PER_FRAME.maximum == MAX_VELOCITY
    assert quantities.VELOCITY.min_nonzero == quantities.PER_FRAME.minimum == MIN_NONZERO_VELOCITY
    assert fields._TEXTS["when"].max_length == MAX_CONDITION_LENGTH
    assert fields.IDENTIFIER.max_length == MAX_NAME_LENGTH


@pytest.mark.parametrize(
    ("id", "policies"),
    [("grcn", grcn.POLICIES), ("rsrcn", rsrcn.POLICIES), ("msrcn", msrcn.POLICIES)],
)
def test_plans_are_read_with_the_same_policies(id, policies):
    bounds = {"threshold": 1.0, "max_vel_limit": 1.0} if id == "rsrcn" else {}
    for policy in PolicyName:
        settings = of(id, policy=policy, **bounds)
        if policy in policies:
            in_force(LEASABLE if policy is PolicyName.LEASE else PLAN, settings)
        else:
            with pytest.raises(
                SettingsMismatchError, match=f"{id}: {policy} is not for".replace("+", r"\+")
            ):
                in_force(PLAN, settings)


def test_publishers_that_each_own_a_part_take_no_turns():
    merged = replace(PLAN, grcn=(replace(GENERAL, sharing=Sharing.MERGE),))
    in_force(merged, of("grcn", policy=PolicyName.BLOCK))
    with pytest.raises(SettingsMismatchError, match="choose Block"):
        in_force(merged, of("grcn", policy=PolicyName.FIFO_QUEUE))


def test_a_velocity_that_is_ordered_at_all_is_ordered_for_all():
    third = replace(FLOWS[0], name="vflow3", publisher="/third", priority=0)
    vflows = (replace(VFLOWS, flows=(*VFLOWS.flows, third)),)
    safe = replace(ROBOT, policy=PolicyName.SAFE, threshold=0.2, vflows=vflows)
    wider = replace(PLAN, rsrcn=safe)
    assert in_force(wider, Settings(revision=2)).revision == 2
    with pytest.raises(SettingsMismatchError, match="the same priority 0"):
        in_force(wider, flow("rsrcn", "vflow1", priority=5))


def test_a_plan_without_an_rsrcn_and_msrcn_has_nothing_to_override():
    bare = Plan(app="app", grcn=(GENERAL,))
    assert in_force(bare, Settings()) == bare
    with pytest.raises(SettingsMismatchError, match="cannot be overridden"):
        in_force(bare, Settings(overrides={"rsrcn": TimedOverride(by="", reason="", until=1)}))


numbers = st.integers() | st.sampled_from([0, 1, MAX_INT64, MAX_INT64 + 1, -1, 10**400])
floats = st.floats() | st.sampled_from([0.0, MIN_NONZERO_VELOCITY, MAX_VELOCITY])
names = st.sampled_from(["flow1", "aflow1", "vflow1", "flow9", "", "/cmd_vel", "\ud800", "x" * 300])
nodes = st.builds(
    NodeSettings,
    policy=st.none() | st.sampled_from(PolicyName),
    release_after=st.none() | numbers,
    max_age=st.none() | numbers,
    threshold=st.none() | floats,
    max_vel_limit=st.none() | floats,
    flows=st.dictionaries(
        names, st.builds(FlowSettings, priority=st.none() | numbers, timeout=st.none() | numbers)
    ),
    rules=st.dictionaries(
        names | st.just("alert"),
        st.builds(
            RuleSettings,
            selected=st.none() | st.booleans(),
            block=st.none() | st.lists(names).map(tuple),
            when=st.none() | st.text(max_size=5),
        ),
    ),
)


@given(
    st.builds(
        Settings,
        revision=numbers,
        nodes=st.dictionaries(st.sampled_from(["grcn", "rsrcn", "msrcn", "", "other"]), nodes),
    )
)
def test_whatever_is_said_is_in_force_or_a_misfit(settings):
    with suppress(SettingsMismatchError):
        after = in_force(PLAN, settings)
        assert after.revision == settings.revision
        limit = after.rsrcn.max_vel_limit
        assert limit is None or 0 <= limit <= MAX_VELOCITY
