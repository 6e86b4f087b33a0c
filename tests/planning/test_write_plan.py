"""A written plan is read again as it was, and is good to look at."""

from autorace import AUTORACE
from home import HOME
from hypothesis import given
from hypothesis import strategies as st

from rtron.planning import parse_plan, propose_plan, write_plan
from rtron.planning.coherence import misfits
from rtron.risks import discover
from rtron.vocabulary import (
    GRCN,
    MSRCN,
    RSRCN,
    Domain,
    Flow,
    FpsMonitor,
    GuardedTopic,
    Mode,
    Plan,
    PolicyName,
    Sharing,
    StreamKind,
    WatchedFlow,
)

words = st.from_regex(r"[A-Za-z][A-Za-z0-9_]{0,8}", fullmatch=True)
topics = st.from_regex(r"(/[A-Za-z0-9_]{1,4}){1,3}", fullmatch=True)
nodes = st.from_regex(r"(/[A-Za-z0-9_]{1,4}){1,2}\*?", fullmatch=True)
types = st.sampled_from(["", "std_msgs/String", "std_msgs/msg/String"])
durations = st.integers(0, 2**63 - 1)


def listed(strategy, least=0):
    return st.lists(strategy, min_size=least, max_size=3).map(tuple)


flows = st.builds(
    Flow,
    name=words,
    publisher=nodes,
    priority=st.integers(-(2**31), 2**31 - 1),
    block=st.booleans(),
    timeout=st.none() | durations,
)
watched = st.builds(WatchedFlow, name=words, topic=topics, publisher=nodes)
guarded = st.builds(
    GuardedTopic, topic=topics, type=types, flows=listed(flows), successors=listed(nodes)
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
    release_after=durations,
    max_age=durations,
    max_hold=durations,
    queue_size=st.integers(1, 1_000_000),
    done=st.none() | topics,
    block_unapproved=st.booleans(),
)
texts = st.text(max_size=20)
plans = st.builds(
    Plan,
    app=texts,
    ros=st.sampled_from([1, 2]),
    revision=st.integers(0, 2**63 - 1),
    grcn=listed(grcns),
    rsrcn=st.none()
    | st.builds(
        RSRCN,
        id=words,
        mode=st.sampled_from(Mode),
        policy=st.sampled_from(PolicyName),
        vflows=listed(guarded),
        iflows=listed(watched),
    ),
    msrcn=st.none()
    | st.builds(
        MSRCN,
        id=words,
        mode=st.sampled_from(Mode),
        policy=st.just(PolicyName.BLOCK),
        aflows=listed(guarded),
        eflows=listed(watched),
    ),
    fps_monitor=listed(st.builds(FpsMonitor, id=words, node=nodes, topic=topics)),
    accept_unenforceable=listed(texts),
)


@given(plans.filter(lambda plan: not any(misfits(plan))))
def test_every_plan_is_read_as_it_was_written(plan):
    assert parse_plan(write_plan(plan)) == plan


def test_the_proposals_are_read_as_they_were_written():
    for graph in (HOME, AUTORACE):
        plan = propose_plan(graph, discover(graph))
        assert parse_plan(write_plan(plan)) == plan


def test_a_person_finds_their_way_in_it():
    text = write_plan(propose_plan(HOME, discover(HOME)))
    start = [line for line in text.splitlines() if not line.startswith("#") and line]
    assert start[:4] == ["schema: rtron.plan/1", "app: home", "grcn:", "  - id: grcn_cmd_vel"]
    assert "      - {name: flow1, publisher: /move_base, priority: 2}" in start
    assert "    max_age: 60 s" in start
    assert [line for line in text.splitlines() if len(line) > 120] == []


def test_what_has_its_default_is_left_out():
    text = write_plan(propose_plan(HOME, discover(HOME)))
    for word in ("block", "queue_size", "max_hold", "release_after", "null", "revision", "[]"):
        assert f"{word}:" not in text
        assert f": {word}" not in text


def test_each_section_is_introduced():
    text = write_plan(propose_plan(HOME, discover(HOME)))
    for section in ("grcn", "rsrcn", "msrcn", "fps_monitor"):
        before = text.split(f"\n{section}:\n", maxsplit=1)[0]
        assert before.splitlines()[-1].startswith("# ")


def test_an_empty_plan_is_a_plan():
    assert parse_plan(write_plan(Plan(app=""))) == Plan(app="")


def test_texts_that_yaml_would_take_for_something_else_are_quoted():
    for app in (
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
        assert parse_plan(write_plan(Plan(app=app))).app == app
