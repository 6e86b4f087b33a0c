"""A written plan is read again as it was, and is good to look at."""

import math

from app_graphs import AUTORACE, HOME
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from rtron.coherence import coherence_problems
from rtron.coherence.duration_bounds import DURATION_RANGES
from rtron.planning import parse_plan, propose_plan, write_plan
from rtron.planning.expressions import expression_problems
from rtron.planning.plan_file.fields import APP_NAME, plan_fields
from rtron.risks import discover_risks
from rtron.vocabulary import (
    GRCN,
    MSRCN,
    RSRCN,
    SECOND,
    TWIST_COMPONENTS,
    Area,
    Audit,
    Domain,
    EventFlow,
    Flow,
    FpsMonitor,
    FrameSource,
    GuardedTopic,
    MessageDefinition,
    MissionRule,
    Mode,
    OnError,
    OnForeign,
    OnSilence,
    Plan,
    Point,
    PolicyName,
    Sharing,
    StopProfile,
    StreamKind,
    Supervision,
    Transform,
    UnguardedPath,
    WatchedFlow,
    WhenUnknown,
)

words = st.from_regex(r"[A-Za-z][A-Za-z0-9_]{0,8}", fullmatch=True)
variables = words.filter(plan_fields(Area)["name"].text.matches)
topics = st.from_regex(r"(/[A-Za-z0-9_]{1,4}){1,3}", fullmatch=True)
nodes = st.from_regex(r"(/[A-Za-z0-9_]{1,4}){1,2}\*?", fullmatch=True)
frames = st.from_regex(r"/?[A-Za-z0-9_.-]{1,8}", fullmatch=True)
types = st.sampled_from(["", "std_msgs/String", "std_msgs/msg/String"])
metres = st.floats(-1e8, 1e8)
texts = st.text(max_size=20)
app_names = st.just("") | texts.filter(APP_NAME.matches)


def within(key):
    """Return the durations that a plan may have under a key."""
    return st.integers(*DURATION_RANGES[key])


def listed(strategy, least=0, most=3):
    return st.lists(strategy, min_size=least, max_size=most).map(tuple)


flows = st.builds(
    Flow,
    name=words,
    publisher=nodes,
    priority=st.integers(-(2**31), 2**31 - 1),
    block=st.booleans(),
    timeout=st.none() | within("timeout"),
    silent_after=within("silent_after"),
    on_silence=st.sampled_from(OnSilence),
    on_error=st.sampled_from(OnError),
)
watched = st.builds(WatchedFlow, name=words, topic=topics, publisher=nodes)
used = listed(st.sampled_from(TWIST_COMPONENTS))
guarded = st.builds(
    GuardedTopic, topic=topics, type=types, flows=listed(flows), successors=listed(nodes), uses=used
)
grcns = st.builds(
    GRCN,
    id=words,
    topic=topics,
    type=types,
    domain=st.sampled_from(Domain),
    kind=st.sampled_from(StreamKind),
    sharing=st.sampled_from(Sharing),
    mode=st.sampled_from(Mode),
    policy=st.sampled_from(PolicyName),
    flows=listed(flows),
    successors=listed(nodes),
    release_after=within("release_after"),
    max_age=within("max_age"),
    max_hold=within("max_hold"),
    queue_size=st.integers(1, 1_000_000),
    done=st.none() | topics,
    block_unapproved=st.booleans(),
    uses=used,
)
monitors = st.builds(
    FpsMonitor,
    id=words,
    node=nodes,
    topic=topics,
    source=st.sampled_from(FrameSource),
    window=within("window"),
    silent_after=within("FpsMonitor.silent_after"),
    camera=st.none() | watched,
)
velocities = st.just(0.0) | st.floats(1e-6, 1000)
rsrcns = st.builds(
    RSRCN,
    id=words,
    mode=st.sampled_from(Mode),
    policy=st.sampled_from([PolicyName.BLOCK, PolicyName.CONSTRAIN]),
    threshold=st.none() | st.floats(1e-6, 1000),
    max_vel_limit=velocities,
    max_turn_limit=st.none() | velocities,
    max_side_limit=st.none() | velocities,
    max_accel_limit=st.none() | st.floats(0.01, 1000),
    lowest=velocities,
    vflows=listed(guarded),
)
comparisons = st.sampled_from(
    ["event.data == 'x'", 'event.data != "y"', "event.data ==\n  'a'", "size(event.data) > 3\n"]
)
unjudged = st.builds(
    EventFlow,
    name=variables,
    topic=topics,
    publisher=nodes,
    type=types,
    present=within("present"),
    max_age=within("EventFlow.max_age"),
    frame=st.just("") | frames,
    on_silence=st.sampled_from(WhenUnknown),
    on_error=st.sampled_from(WhenUnknown),
)
judged = st.builds(
    EventFlow,
    name=variables,
    topic=topics,
    publisher=nodes,
    type=st.sampled_from(["std_msgs/String", "std_msgs/msg/String"]),
    when=comparisons,
    silent=st.none() | within("silent"),
)
polygons = st.tuples(
    st.floats(-1e7, 1e7), st.floats(-1e7, 1e7), st.floats(0.1, 9), st.floats(0.1, 9)
).map(lambda c: (Point(x=c[0], y=c[1]), Point(x=c[0] + c[2], y=c[1]), Point(x=c[0], y=c[1] + c[3])))
areas = st.builds(Area, name=variables, frame=frames, polygon=polygons)
transforms = st.builds(
    Transform,
    source=frames,
    target=frames,
    x=metres,
    y=metres,
    yaw=st.floats(-2 * math.pi, 2 * math.pi),
)
stops = st.builds(
    StopProfile,
    decel=st.floats(0.01, 1000),
    angular_decel=st.floats(0.01, 1000),
    within=st.integers(SECOND // 20, 10 * SECOND),
    period=within("period"),
    repeat=within("repeat"),
)
audits = st.builds(Audit, period=within("Audit.period"), on_foreign=st.sampled_from(OnForeign))
bounds = st.builds(
    Supervision,
    stall_after=within("stall_after"),
    kill_after=within("kill_after"),
    deliver_within=within("deliver_within"),
    audit_within=within("audit_within"),
    start_within=within("start_within"),
)
definitions = st.builds(
    MessageDefinition,
    type=st.from_regex(r"my_msgs/(msg/)?[A-Z][a-z]{1,4}", fullmatch=True),
    definition=st.lists(
        st.sampled_from(["bool a", "", "# \u00e9", "  ", "\tfloat64[3] b", 'string C= "x" : # y']),
        unique=True,
        max_size=6,
    ).map("\n".join)
    | st.just("int8 a\n"),
)


@st.composite
def missions(draw):
    aflows = draw(listed(guarded, most=2))
    eflows = draw(listed(unjudged | judged))
    known = [name for one in aflows for name in (one.topic, *(flow.name for flow in one.flows))]
    names = [flow.name for flow in eflows]
    conditions = ["true", *names, *(f"!({one} && {other})" for one in names for other in names)]
    rules = st.builds(
        MissionRule,
        name=words,
        block=listed(st.sampled_from(known or ["/x"]), least=1),
        when=st.sampled_from(conditions),
        frame=st.just("") | frames,
        require=st.sampled_from(["", *known, *names, *(flow.topic for flow in eflows)]),
        reason=texts,
    )
    return MSRCN(
        id=draw(words),
        mode=draw(st.sampled_from(Mode)),
        policy=PolicyName.BLOCK,
        aflows=aflows,
        eflows=eflows,
        rules=draw(listed(rules)) if known else (),
        areas=draw(listed(areas, most=2)),
        transforms=draw(listed(transforms, most=2)),
    )


plans = st.builds(
    Plan,
    app=app_names,
    ros=st.sampled_from([1, 2]),
    revision=st.integers(0, 2**63 - 1),
    grcn=listed(grcns, most=2),
    rsrcn=st.none() | rsrcns,
    msrcn=st.none() | missions(),
    fps_monitor=listed(monitors, most=2),
    stop=st.just(StopProfile()) | stops,
    audit=audits,
    supervision=st.just(Supervision()) | bounds,
    messages=listed(definitions, most=2),
    unguarded=listed(st.builds(UnguardedPath, what=texts, why=texts), most=2),
    accept_unenforceable=listed(texts),
)


def is_coherent(plan) -> bool:
    return not any(coherence_problems(plan)) and not any(expression_problems(plan))


def planned(msrcn):
    return Plan(app="", msrcn=msrcn)


@given(missions().map(planned).filter(is_coherent))
def test_every_mission_is_read_as_it_was_written(plan):
    assert parse_plan(write_plan(plan)) == plan


@settings(suppress_health_check=[HealthCheck.too_slow])  # a busy machine makes whole plans slowly
@given(plans.filter(is_coherent))
def test_every_plan_is_read_as_it_was_written(plan):
    assert parse_plan(write_plan(plan)) == plan


@given(
    st.text(alphabet=st.sampled_from("ab \n\t:#-|>'\"{}[]&*!%@`\\\r\x85\u2028\u00e9"), max_size=30)
)
def test_a_text_of_several_lines_is_read_as_it_was_written(text):
    rule = MissionRule(name="r", block=("/x",), reason=text)
    topic = GuardedTopic(topic="/x", type="", flows=(Flow(name="f", publisher="/n"),))
    msrcn = MSRCN(
        id="msrcn", mode=Mode.OBSERVE, policy=PolicyName.BLOCK, aflows=(topic,), rules=(rule,)
    )
    assert parse_plan(write_plan(planned(msrcn))).msrcn == msrcn


def test_the_proposals_are_read_as_they_were_written():
    for graph in (HOME, AUTORACE):
        plan = propose_plan(graph, discover_risks(graph))
        assert parse_plan(write_plan(plan)) == plan


def test_a_person_finds_their_way_in_it():
    text = write_plan(propose_plan(HOME, discover_risks(HOME)))
    start = [line for line in text.splitlines() if not line.startswith("#") and line]
    assert start[:4] == ["schema: rtron.plan/1", "app: home", "grcn:", "  - id: grcn_cmd_vel"]
    assert "      - {name: flow1, publisher: /teleop_twist_keyboard, priority: 2}" in start
    assert "    max_age: 60 s" in start
    assert [line for line in text.splitlines() if len(line) > 120] == []


def test_what_has_its_default_is_left_out():
    lines = write_plan(propose_plan(HOME, discover_risks(HOME))).splitlines()
    text = "\n".join(line for line in lines if not line.startswith("#"))
    for word in ("block", "queue_size", "max_hold", "release_after", "null", "revision", "[]"):
        assert f"{word}:" not in text
        assert f": {word}" not in text


def test_each_section_is_introduced():
    text = write_plan(propose_plan(HOME, discover_risks(HOME)))
    for section in ("grcn", "rsrcn", "msrcn", "fps_monitor"):
        before = text.split(f"\n{section}:\n", maxsplit=1)[0]
        assert before.splitlines()[-1].startswith("# ")


def test_an_empty_plan_is_a_plan():
    assert parse_plan(write_plan(Plan(app=""))) == Plan(app="")


def test_texts_that_yaml_would_take_for_something_else_are_quoted():
    for text in (
        "yes",
        "1",
        "null",
        "~",
        "a: b",
        "# no",
        "a\nb",
        "'",
        '"',
        "\u2028",
        "\x7f",
        "1:30",
    ):
        plan = Plan(app="", accept_unenforceable=(text,))
        assert parse_plan(write_plan(plan)) == plan
