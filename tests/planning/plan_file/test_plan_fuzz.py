"""Whatever the file holds, the reader gives a plan or a PlanError, and a proposal is a plan."""

from hypothesis import example, given
from hypothesis import strategies as st

from rtron.errors import PlanError
from rtron.planning import check_plan, parse_plan, propose_plan, unguardable_topics, write_plan
from rtron.risks import discover_risks
from rtron.vocabulary import Direction, Endpoint, InteractionGraph, Node, Plan, Trust

WHOLE = """\
schema: rtron.plan/1
app: home
grcn:
  - topic: /cmd_vel
    mode: enforce
    policy: Preemption
    max_age: 0.5 s
    flows:
      - {name: flow1, publisher: /move_base, priority: 2}
      - {name: flow2, publisher: /teleop, priority: 1, timeout: 200 ms}
    successors: [/gazebo]
rsrcn: {mode: enforce, policy: Safe, threshold: 2 cm/frame}
msrcn:
  mode: observe
  aflows: [{topic: /cmd_vel, type: geometry_msgs/Twist, flows: [{name: a1, publisher: /teleop}]}]
  eflows:
    - {name: low, topic: /bat, publisher: /b, type: my_msgs/Bat, when: "!(event.left >= 0.2)"}
    - {name: seen, topic: /people, publisher: /eyes, present: 2 s}
    - {name: moved, topic: /odom, publisher: /base, present: 1 s}
  rules:
    - {name: rest, when: low && !seen, block: [a1], action: action.linear.x > 0.1, require: /odom}
  areas: [{name: bed, frame: map, polygon: [{x: 0, y: 0}, {x: 1 m, y: 0}, {x: 0, y: 1}]}]
  transforms: [{source: odom, target: map, yaw: 90 deg}]
fps_monitor: [{node: /a, topic: /b, camera: {name: c, topic: /c, publisher: /d}}]
stop: {decel: 1 m/s2, period: 20 ms}
messages:
  - type: my_msgs/Bat
    definition: |
      float32 left
"""
pieces = st.sampled_from([*"\n :-[]{},&*!|>'\"%@#?\t0aé\x00", "  ", "- ", ": ", "<<: ", "null"])
edits = st.lists(st.tuples(st.integers(0, len(WHOLE)), st.integers(0, 5), pieces), max_size=6)
names = st.sampled_from(["/a", "/b", "/a/b", "/a_b", "/rviz", "", "{x}/y", "/a b", "*", "/*", "/é"])
graphs = st.builds(
    InteractionGraph,
    app=st.text(),
    nodes=st.lists(
        st.builds(
            Node, name=names, package=st.sampled_from(["rviz", ""]), trust=st.sampled_from(Trust)
        ),
        unique_by=lambda node: node.name,
        max_size=4,
    ).map(tuple),
    endpoints=st.lists(
        st.builds(
            Endpoint,
            node=names.filter(lambda name: "*" not in name),
            topic=names | st.sampled_from(["/cmd_vel", "/x/goal", "/detect", "/max_vel", "/tf"]),
            type=st.sampled_from(
                ["geometry_msgs/Twist", "std_msgs/Float64", "sensor_msgs/Image", "", "*", "é/x"]
            ),
            direction=st.sampled_from(Direction),
        ),
        max_size=20,
    ).map(tuple),
)


def plan_or_error(text):
    """Return the plan that a text holds, or why it holds none."""
    try:
        return parse_plan(text)
    except PlanError as error:
        return error


def test_the_plan_that_is_damaged_is_one():
    assert parse_plan(WHOLE).messages


@given(edits)
def test_a_damaged_plan_is_a_plan_or_a_plan_error(damage):
    text = WHOLE
    for place, cut, piece in damage:
        text = text[:place] + piece + text[place + cut :]
    found = plan_or_error(text)
    assert isinstance(found, PlanError) or parse_plan(write_plan(found)) == found


@given(st.text())
def test_any_text_is_a_plan_or_a_plan_error(text):
    assert isinstance(plan_or_error(text), (Plan, PlanError))


@example(
    InteractionGraph(
        app="",
        nodes=(),
        endpoints=tuple(
            Endpoint(
                node=node, topic="/cmd_vel", type="geometry_msgs/Twist", direction=Direction.PUBLISH
            )
            for node in ("/a", "")
        ),
    )
)
@given(graphs)
def test_what_is_proposed_for_any_graph_can_be_read_and_fits_it(graph):
    report = discover_risks(graph)
    plan = propose_plan(graph, report)
    assert parse_plan(write_plan(plan)) == plan
    warned = {problem.location for problem in unguardable_topics(graph, report)}
    warned.add("a node without a name")
    for problem in check_plan(plan, graph):
        assert problem.level.value == "warning"
        named = any(f"names {name}, which" in problem.message for name in warned)
        assert named or "no successor" in problem.message
