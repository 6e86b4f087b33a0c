"""What a later coordination node on a topic says in vain is refused; what counts passes."""

import pytest
from app_graphs import AUTORACE, HOME

from cpu_time import growth
from rtron.errors import PlanError
from rtron.planning import parse_plan, propose_plan, write_plan
from rtron.risks import discover_risks
from rtron.vocabulary import Mode, build_streams

GRCN = """\
grcn:
  - topic: /cmd_vel
    mode: {general}
    policy: Preemption
    type: geometry_msgs/Twist
    flows:
      - {{name: g1, publisher: /nav, priority: 2}}
      - {{name: g2, publisher: {pattern}, priority: 1, silent_after: 2 s, on_silence: release}}
    successors: [/base, /wheel_*]
"""
MSRCN = """\
msrcn:
  mode: {mission}
  aflows:
    - topic: /cmd_vel
      type: geometry_msgs/Twist
      flows:
        - {{{aflow}}}
      successors: [{heard}]
"""
RSRCN = """\
rsrcn:
  mode: {robot}
  policy: Block
  vflows:
    - topic: /cmd_vel
      type: geometry_msgs/Twist
      flows:
        - {{{vflow}}}
      successors: [{obeyed}]
"""
FITS = {
    "general": "enforce",
    "mission": "enforce",
    "robot": "enforce",
    "pattern": "/teleop_*",
    "aflow": "name: a1, publisher: /nav",
    "vflow": "name: v1, publisher: /nav",
    "heard": "/base",
    "obeyed": "/base",
}
ALL = GRCN + MSRCN + RSRCN
# On which line the flow and the successors stand, without and with a GRCN.
FLOW, GRCN_LINES = 7, 9
OF_GRCN = "GRCN grcn_cmd_vel, which is first on /cmd_vel"
OF_MSRCN = "the MSRCN, which is first on /cmd_vel"


def made(text: str, **changes: str) -> str:
    return text.format_map(FITS | changes)


def faults(text: str) -> list[str]:
    with pytest.raises(PlanError) as caught:
        parse_plan(text, "my.yaml")
    return str(caught.value).splitlines()


@pytest.mark.parametrize(
    "text", [GRCN, MSRCN, RSRCN, GRCN + MSRCN, GRCN + RSRCN, MSRCN + RSRCN, ALL]
)
def test_what_says_the_same_is_one_stream(text):
    plan = parse_plan(made(text))
    assert parse_plan(write_plan(plan)) == plan
    (stream,) = build_streams(plan)
    assert len(stream.stages) == sum(part in text for part in (GRCN, MSRCN, RSRCN))


@pytest.mark.parametrize(
    "publisher", ["/nav", "/teleop_1", "/teleop_", "/teleop_*", "/teleop_1*", "/n*", "/*"]
)
@pytest.mark.parametrize(("key", "part"), [("aflow", MSRCN), ("vflow", RSRCN)])
def test_a_publisher_that_a_flow_of_the_grcn_may_be(key, part, publisher):
    assert parse_plan(made(GRCN + part, **{key: f"name: x, publisher: {publisher}"}))


@pytest.mark.parametrize("publisher", ["/na", "/navi", "/ns/nav", "/teleop", "/Nav", "/x*", "/*_x"])
@pytest.mark.parametrize(("key", "part"), [("aflow", MSRCN), ("vflow", RSRCN)])
def test_a_publisher_that_the_grcn_does_not_know(key, part, publisher):
    found = faults(made(GRCN + part, **{key: f"name: x, publisher: {publisher}"}))
    line = GRCN_LINES + FLOW + (part is RSRCN)
    assert found == [f"my.yaml:{line}: {publisher} has no flow in {OF_GRCN}: add one there"]


def test_a_flow_of_the_grcn_that_the_later_node_does_not_name_is_no_fault():
    plan = parse_plan(made(GRCN + MSRCN))
    (stream,) = build_streams(plan)
    assert [flow.name for flow in stream.flows] == ["g1", "g2"]
    assert parse_plan(made(GRCN + MSRCN).replace("\n        - {name: a1, publisher: /nav}", " []"))


@pytest.mark.parametrize(
    "heard", ["", "/base", "/wheel_1", "/base, /wheel_", "/wheel_*, /wheel_1*"]
)
@pytest.mark.parametrize(("key", "part"), [("heard", MSRCN), ("obeyed", RSRCN)])
def test_a_successor_that_the_grcn_has(key, part, heard):
    assert parse_plan(made(GRCN + part, **{key: heard}))


@pytest.mark.parametrize("heard", ["/bas", "/base_2", "/wheel", "/wheel*", "/*", "/ns/base"])
@pytest.mark.parametrize(("key", "part"), [("heard", MSRCN), ("obeyed", RSRCN)])
def test_a_successor_that_the_grcn_lacks(key, part, heard):
    found = faults(made(GRCN + part, **{key: f"/base, {heard}"}))
    line = GRCN_LINES + FLOW + (part is RSRCN) + 1
    assert found == [f"my.yaml:{line}: {heard} is no successor of {OF_GRCN}: add it there"]


def test_each_successor_is_told():
    assert len(faults(made(GRCN + MSRCN, heard="/a, /base, /b"))) == 2


@pytest.mark.parametrize(
    ("flow", "key", "counting"),
    [
        ("publisher: /nav, silent_after: 499 ms", "silent_after", "g1"),
        ("publisher: /nav, silent_after: 501 ms", "silent_after", "g1"),
        ("publisher: /nav, on_silence: release", "on_silence", "g1"),
        ("publisher: /nav, on_error: drop", "on_error", "g1"),
        ("publisher: /teleop_1, silent_after: 3 s", "silent_after", "g2"),
        ("publisher: /teleop_1, on_error: drop", "on_error", "g2"),
        ("publisher: /teleop_*, silent_after: 1 s", "silent_after", "g2"),
        ("publisher: '/*', silent_after: 2 s", "silent_after", "g1"),
        ("publisher: '/*', on_silence: release", "on_silence", "g1"),
    ],
)
@pytest.mark.parametrize(("which", "part"), [("aflow", MSRCN), ("vflow", RSRCN)])
def test_a_silence_or_error_that_only_the_later_flow_speaks_of(which, part, flow, key, counting):
    found = faults(made(GRCN + part, **{which: f"name: x, {flow}"}))
    line = GRCN_LINES + FLOW + (part is RSRCN)
    where = f"set it on the flow {counting} of {OF_GRCN}"
    assert found == [f"my.yaml:{line}: {key} of x would be lost: {where}"]


@pytest.mark.parametrize(
    "flow",
    [
        "publisher: /nav, silent_after: 500 ms, on_silence: stop, on_error: stop",
        "publisher: /teleop_1",
        "publisher: /teleop_1, silent_after: 500 ms, on_silence: stop",
        "publisher: /teleop_1, silent_after: 2 s, on_silence: release",
        "publisher: '/teleop_*', silent_after: 2000 ms",
        "publisher: /nav, block: true, priority: 9",
    ],
)
@pytest.mark.parametrize(("which", "part"), [("aflow", MSRCN), ("vflow", RSRCN)])
def test_a_default_and_what_the_grcn_says_too(which, part, flow):
    assert parse_plan(made(GRCN + part, **{which: f"name: x, {flow}"}))


def test_every_key_that_is_lost_is_told():
    flow = "name: a1, publisher: /nav, silent_after: 1 s, on_silence: release, on_error: drop"
    found = faults(made(GRCN + MSRCN, aflow=flow))
    assert [text.split(": ")[1].split()[0] for text in found] == [
        "on_error",
        "on_silence",
        "silent_after",
    ]


@pytest.mark.parametrize("lost", ["publisher: /other", "publisher: /nav, on_error: drop"])
def test_without_a_grcn_the_flows_of_the_msrcn_count(lost):
    (told,) = faults(made(MSRCN + RSRCN, vflow=f"name: v1, {lost}"))
    assert told.startswith("my.yaml:16: ")
    assert OF_MSRCN in told
    assert parse_plan(made(RSRCN, vflow=f"name: v1, {lost}"))
    assert parse_plan(made(MSRCN + RSRCN, vflow=f"name: v1, {lost}", aflow=f"name: a1, {lost}"))


def test_without_a_grcn_the_successors_of_the_msrcn_count():
    assert faults(made(MSRCN + RSRCN, obeyed="/wheel_1")) == [
        f"my.yaml:17: /wheel_1 is no successor of {OF_MSRCN}: add it there"
    ]


def test_with_a_grcn_both_are_held_against_it_and_not_against_each_other():
    assert parse_plan(made(ALL, vflow="name: v1, publisher: /teleop_1", obeyed="/wheel_1"))
    other = "publisher: /other"
    found = faults(made(ALL, aflow=f"name: a1, {other}", vflow=f"name: v1, {other}"))
    assert [OF_GRCN in text for text in found] == [True, True]


def test_the_order_in_the_file_does_not_matter():
    lost = {"vflow": "name: v1, publisher: /other"}
    assert len(faults(made(RSRCN + MSRCN, **lost))) == 1
    assert len(faults(made(RSRCN + GRCN, **lost))) == 1


@pytest.mark.parametrize(
    "modes", [{"general": "observe"}, {"mission": "observe", "robot": "observe"}]
)
def test_what_observes_shares_nothing_with_what_enforces(modes):
    flow = "publisher: /other, silent_after: 1 s"
    lost = {"heard": "/other", "aflow": f"name: a1, {flow}"}
    same = {"obeyed": "/other", "vflow": f"name: v1, {flow}"}
    plan = parse_plan(made(ALL, **modes, **lost, **same))
    assert {stream.mode for stream in build_streams(plan)} == set(Mode)


def test_who_observes_together_shares_too():
    modes = dict.fromkeys(("general", "mission", "robot"), "observe")
    (told,) = faults(made(ALL, **modes, vflow="name: v1, publisher: /other"))
    assert OF_GRCN in told


def test_an_observing_msrcn_does_not_count_for_an_enforcing_rsrcn():
    assert parse_plan(made(MSRCN + RSRCN, mission="observe", obeyed="/wheel_1"))


def test_another_topic_is_another_stream():
    text = made(GRCN) + made(MSRCN, aflow="name: a1, publisher: /x", heard="/y").replace(
        "/cmd_vel", "/cmd_vel2"
    )
    assert len(build_streams(parse_plan(text))) == 2


def test_a_topic_that_stands_twice_is_told_as_that_alone():
    again = made(MSRCN) + made(MSRCN, aflow="name: a2, publisher: /x").split("aflows:\n")[1]
    assert faults(again) == ["my.yaml:9: two entries on /cmd_vel"]


@pytest.mark.timed
def test_very_many_flows_are_compared_soon():
    flows = "".join(f"        - {{name: f{n}, publisher: /n{n}}}\n" for n in range(1000))
    text = made(MSRCN + RSRCN).replace("        - {name: a1, publisher: /nav}\n", flows)
    assert len(faults(text)) == 1
    more = "".join(f"        - {{name: v{n}, publisher: /n{n}}}\n" for n in range(1000))
    assert parse_plan(text.replace("        - {name: v1, publisher: /nav}\n", more))


@pytest.mark.parametrize(("text", "line"), [(GRCN, 9), (MSRCN, 8), (RSRCN, 9)])
def test_a_topic_has_a_thousand_successors_at_most(text, line):
    names = [f"/n{n}" for n in range(1001)]
    full = made(
        text.replace("/base, /wheel_*", "{heard}").replace("{obeyed}", "{heard}"),
        heard=", ".join(names[:1000]),
    )
    assert parse_plan(full)
    assert faults(full.replace("/n999]", "/n999, /n1000]")) == [
        f"my.yaml:{line}: more than 1000 successors of one topic"
    ]


@pytest.mark.timed
def test_very_many_successors_are_compared_soon():
    def compare(count):
        heard, obeyed = (", ".join(f"/{who}{n}*" for n in range(count)) for who in "ab")
        assert len(faults(made(MSRCN + RSRCN, heard=heard, obeyed=obeyed))) == 51

    assert growth(compare, 2000, 20_000) < 30


@pytest.mark.parametrize("graph", [HOME, AUTORACE])
def test_what_is_proposed_shares_its_topics_without_a_loss(graph):
    plan = propose_plan(graph, discover_risks(graph))
    assert parse_plan(write_plan(plan)) == plan
    assert max(len(stream.stages) for stream in build_streams(plan)) > 1


ACTION = """\
grcn:
  - topic: /act/goal
    mode: {mode}
    policy: FIFO_Queue
    type: p/GoActionGoal
    flows: [{{name: flow1, publisher: /a}}]
    successors: [/s]
  - topic: /act/{part}
    mode: enforce
    policy: Block
    type: p/T
    flows: [{{name: flow1, publisher: /a}}]
    successors: [/s]
"""


@pytest.mark.parametrize("part", ["cancel", "status", "feedback", "result"])
def test_what_moves_with_an_action_is_not_moved_alone(part):
    with pytest.raises(PlanError, match=f"/act/{part} moves with /act/goal, which is guarded"):
        parse_plan(ACTION.format(mode="enforce", part=part))
    parse_plan(ACTION.format(mode="observe", part=part))
    parse_plan(ACTION.format(mode="enforce", part="others"))


REQUESTED = """\
ros: {ros}
grcn:
  - topic: /act
    mode: enforce
    policy: FIFO_Queue
    type: p/action/Go
    flows: [{{name: flow1, publisher: {publisher}}}]
    successors: [/s]
  - topic: {other}
    mode: enforce
    policy: Block
    type: p/T
    flows: [{{name: flow1, publisher: /s}}]
    successors: [/a]
"""


@pytest.mark.parametrize(
    ("ros", "publisher", "other", "why"),
    [
        (2, "/a", "/act/_action/status", "/act/_action/status moves with /act, which is guarded"),
        (2, "/a", "/act/_action/feedback", "/act/_action/feedback moves with /act"),
        (1, "/a", "/x", "p/action/Go is an action of ROS 2, and the plan says `ros: 1`"),
        (2, "/s", "/x", "/s is the server: what it asks of itself cannot be guarded"),
        (2, "/*", "/x", "cannot be guarded|may be one node"),
    ],
)
def test_an_action_of_ros_2_is_one_unit_between_two_nodes(ros, publisher, other, why):
    with pytest.raises(PlanError, match=why):
        parse_plan(REQUESTED.format(ros=ros, publisher=publisher, other=other))


def test_the_goals_of_an_action_of_ros_2_are_guarded_by_its_name():
    plan = parse_plan(REQUESTED.format(ros=2, publisher="/a", other="/act/goal"))
    assert [stream.action for stream in build_streams(plan)] == ["/act", ""]
    assert [stream.is_ros2_action for stream in build_streams(plan)] == [True, False]


USED = "      uses: [linear.x, angular.z]\n"


def using(part, uses=USED):
    """Return the text of a coordination node that says what its base obeys."""
    line = next(line for line in part.splitlines(keepends=True) if "type: geometry" in line)
    return part.replace(line, line + uses)


@pytest.mark.parametrize("later", [MSRCN, RSRCN])
def test_what_the_base_obeys_is_said_by_the_first_node(later):
    first = using(GRCN, USED[2:])
    for text in (first + later, first + using(later), using(MSRCN) + RSRCN):
        (stream,) = build_streams(parse_plan(made(text)))
        assert stream.uses == ("linear.x", "angular.z")
    (found,) = faults(made(GRCN + using(later)))
    assert found.endswith(f"uses would be lost: set it on {OF_GRCN}")
    (found,) = faults(made(first + using(later, "      uses: [linear.x]\n")))
    assert found.endswith(f"uses would be lost: set it on {OF_GRCN}")


@pytest.mark.parametrize("part", [GRCN, MSRCN, RSRCN])
def test_only_a_twist_has_components(part):
    space = "" if part is not GRCN else "  "
    text = made(using(part, USED[len(space) :]))
    assert parse_plan(text)
    assert parse_plan(text.replace("Twist", "TwistStamped"))
    assert parse_plan(text.replace("geometry_msgs/Twist", "geometry_msgs/msg/Twist"))
    (found,) = faults(text.replace("geometry_msgs/Twist", "std_msgs/Float64"))
    assert found.endswith("a std_msgs/Float64 has no linear.x: `uses` is for a Twist")
    assert (
        "'linear.w' is not a component of a Twist"
        in faults(text.replace("linear.x", "linear.w"))[0]
    )


def test_goals_have_no_components():
    (found,) = faults(made(using(GRCN, USED[2:])).replace("Preemption", "FIFO_Queue"))
    assert found.endswith("`uses` is for commands, and /cmd_vel has none")


PRIVATE = "/rtron/cmd_vel/out"
FLOWS = "flows: [{name: f, publisher: /nav}]"
NAMING = {
    "grcn": f"grcn: [{{topic: {PRIVATE}, mode: enforce, policy: Block, {FLOWS}}}]",
    "done": "grcn: [{topic: /goal, mode: enforce, policy: FIFO_Queue, "
    f"done: {PRIVATE}, {FLOWS}}}]",
    "vflow": "rsrcn: {mode: enforce, policy: Block, vflows: "
    f"[{{topic: {PRIVATE}, type: a/B, {FLOWS}}}]}}",
    "iflow": "rsrcn: {mode: enforce, policy: Block, vflows: [], iflows: "
    f"[{{name: i, topic: {PRIVATE}, publisher: /d}}]}}",
    "aflow": f"msrcn: {{mode: enforce, aflows: [{{topic: {PRIVATE}, type: a/B, {FLOWS}}}]}}",
    "eflow": "msrcn: {mode: enforce, eflows: "
    f"[{{name: e, topic: {PRIVATE}, publisher: /d, present: 1 s}}]}}",
    "monitor": f"fps_monitor: [{{node: /d, topic: {PRIVATE}}}]",
    "camera": "fps_monitor: [{node: /d, topic: /t, camera: "
    f"{{name: c, topic: {PRIVATE}, publisher: /c}}}}]",
}


@pytest.mark.parametrize("text", NAMING.values(), ids=NAMING)
def test_the_guards_own_topic_is_refused_wherever_a_plan_names_it(text):
    told = f"{PRIVATE} is the guard's private topic: the guard's own output would come back to it"
    with pytest.raises(PlanError) as refused:
        parse_plan(text)
    assert told in str(refused.value)
    with pytest.raises(PlanError) as refused:
        parse_plan(text.replace("/rtron/", "/rtrons/") + "\nx: 1\n")
    assert "private topic" not in str(refused.value)
