"""A plan file is read as a whole; every slip is told with its line and the nearest word."""

from pathlib import Path

import pytest

from rtron.errors import PlanError
from rtron.planning import parse_plan, read_plan
from rtron.vocabulary import (
    GRCN,
    MSRCN,
    RSRCN,
    SECOND,
    Domain,
    EventFlow,
    Flow,
    FpsMonitor,
    GuardedTopic,
    Mode,
    Plan,
    PolicyName,
    Sharing,
    StreamKind,
    UnguardedPath,
    WatchedFlow,
)

LEAST = """\
grcn:
  - topic: /cmd_vel
    mode: enforce
    policy: Preemption
    flows:
      - {name: flow1, publisher: /move_base, priority: 2}
      - {name: flow2, publisher: /teleop, priority: 1}
"""
WHOLE = """\
schema: rtron.plan/1
app: home
ros: 2
revision: 7
grcn:
  - id: grcn_goal
    topic: /goal
    type: geometry_msgs/msg/PoseStamped
    domain: Planning
    kind: action
    sharing: contend
    mode: enforce
    policy: FIFO_Queue
    flows:
      - {name: flow1, publisher: /search_manager, timeout: 2 min}
      - {name: flow2, publisher: "/rviz_*", block: true}
    successors: [/move_base]
    release_after: 200 ms
    max_age: 1.5
    max_hold: 1 h
    queue_size: 5
    done: /move_base/result
    block_unapproved: false
rsrcn:
  mode: observe
  policy: Safe
  threshold: 2 cm/frame
  vflows:
    - topic: /max_vel
      type: std_msgs/Float64
      flows: [{name: vflow1, publisher: /parking}]
      successors: [/lane]
  iflows: [{name: iflow1, topic: /faces, publisher: /face_finder}]
msrcn:
  id: my_msrcn
  mode: enforce
  policy: Block
  aflows:
    - {topic: /cmd_vel, flows: [{name: aflow1, publisher: /move_base}]}
  eflows: [{name: eflow1, topic: /odom, publisher: /base, present: 2 s}]
fps_monitor:
  - {node: /face_finder, topic: /faces}
unguarded:
  - {what: /kill, why: "a service: whoever reaches it can call it"}
accept_unenforceable: ["/gazebo: a plugin, says the developer"]
"""


def faults(text: str) -> list[str]:
    with pytest.raises(PlanError) as caught:
        parse_plan(text, "my.yaml")
    return str(caught.value).splitlines()


def swap(old: str, new: str, text: str = LEAST) -> str:
    assert old in text
    return text.replace(old, new, 1)


def test_the_least_that_a_grcn_needs():
    assert parse_plan(LEAST).grcn == (
        GRCN(
            id="grcn_cmd_vel",
            topic="/cmd_vel",
            type="",
            domain=Domain.OTHERS,
            kind=StreamKind.COMMAND,
            sharing=Sharing.CONTEND,
            mode=Mode.ENFORCE,
            policy=PolicyName.PREEMPTION,
            flows=(
                Flow(name="flow1", publisher="/move_base", priority=2),
                Flow(name="flow2", publisher="/teleop", priority=1),
            ),
        ),
    )


def test_everything_that_a_plan_can_hold():
    assert parse_plan(WHOLE) == Plan(
        app="home",
        ros=2,
        revision=7,
        grcn=(
            GRCN(
                id="grcn_goal",
                topic="/goal",
                type="geometry_msgs/msg/PoseStamped",
                domain=Domain.PLANNING,
                kind=StreamKind.ACTION,
                sharing=Sharing.CONTEND,
                mode=Mode.ENFORCE,
                policy=PolicyName.FIFO_QUEUE,
                flows=(
                    Flow(name="flow1", publisher="/search_manager", timeout=120 * SECOND),
                    Flow(name="flow2", publisher="/rviz_*", block=True),
                ),
                successors=("/move_base",),
                release_after=SECOND // 5,
                max_age=3 * SECOND // 2,
                max_hold=3600 * SECOND,
                queue_size=5,
                done="/move_base/result",
                block_unapproved=False,
            ),
        ),
        rsrcn=RSRCN(
            id="rsrcn",
            mode=Mode.OBSERVE,
            policy=PolicyName.SAFE,
            threshold=0.02,
            vflows=(
                GuardedTopic(
                    topic="/max_vel",
                    type="std_msgs/Float64",
                    flows=(Flow(name="vflow1", publisher="/parking"),),
                    successors=("/lane",),
                ),
            ),
            iflows=(WatchedFlow(name="iflow1", topic="/faces", publisher="/face_finder"),),
        ),
        msrcn=MSRCN(
            id="my_msrcn",
            mode=Mode.ENFORCE,
            policy=PolicyName.BLOCK,
            aflows=(
                GuardedTopic(
                    topic="/cmd_vel", type="", flows=(Flow(name="aflow1", publisher="/move_base"),)
                ),
            ),
            eflows=(
                EventFlow(name="eflow1", topic="/odom", publisher="/base", present=2 * SECOND),
            ),
        ),
        fps_monitor=(FpsMonitor(id="fps_face_finder", node="/face_finder", topic="/faces"),),
        unguarded=(UnguardedPath(what="/kill", why="a service: whoever reaches it can call it"),),
        accept_unenforceable=("/gazebo: a plugin, says the developer",),
    )


def test_a_queue_is_for_actions_where_it_says_when_they_are_done():
    fifo = swap("Preemption", "FIFO_Queue")
    assert parse_plan(fifo).grcn[0].kind is StreamKind.ACTION
    queue = swap("Preemption", "Priority_Queue\n    done: /result")
    assert parse_plan(queue).grcn[0].kind is StreamKind.ACTION
    assert parse_plan(swap("Preemption", "Priority_Queue")).grcn[0].kind is StreamKind.COMMAND


@pytest.mark.parametrize(
    ("old", "new", "line", "fault"),
    [
        ("grcn:", "grnc:", 1, "unknown key 'grnc' in the plan: did you mean grcn?"),
        ("topic:", "topics:", 2, "unknown key 'topics' in a GRCN: did you mean topic?"),
        ("topic:", "topics:", 2, "a GRCN needs topic"),
        ("policy:", "polcy:", 4, "unknown key 'polcy' in a GRCN: did you mean policy?"),
        ("Preemption", "Preemtion", 4, "unknown word 'Preemtion': did you mean Preemption?"),
        ("Preemption", "preemption", 4, "did you mean Preemption?"),
        ("Preemption", "Sort", 4, "unknown word 'Sort': choose from Block, FIFO_Queue,"),
        ("Preemption", "Safe", 4, "Safe is not for a GRCN: choose from Block, FIFO_Queue,"),
        ("enforce", "enforced", 3, "unknown word 'enforced': did you mean enforce?"),
        ("enforce", "[enforce]", 3, "mode is a single value"),
        ("enforce", "null", 3, "unknown word 'null'"),
        ("priority: 2", "prio: 2", 6, "unknown key 'prio' in a flow: did you mean priority?"),
        ("priority: 2", "priority: high", 6, "priority: 'high' is no whole number"),
        ("priority: 2", "priority: 1.5", 6, "priority: '1.5' is no whole number"),
        ("priority: 2", "priority: 010", 6, "priority: '010' is no whole number"),
        ("priority: 2", "priority: 99999999999", 6, "is not between -2147483648 and 2147483647"),
        ("priority: 2", "priority: 1", 7, "flow1 and flow2 have the same priority 1"),
        ("priority: 2", "block: on", 6, "block: 'on' is neither true nor false"),
        ("priority: 2", "timeout: 3 sec", 6, "timeout: unknown unit 'sec': choose from ns"),
        ("priority: 2", "timeout: -1", 6, "timeout: '-1' is no duration"),
        ("name: flow2", "name: flow1", 7, "two flows have the name flow1"),
        ("name: flow2", "name: unapproved", 7, "unapproved is the guard's own"),
        ("name: flow2", "name: out", 7, "out is the guard's own"),
        ("name: flow2", "name: 2nd", 7, "name: '2nd' is not a word of letters, digits and _"),
        ("name: flow2", "name: 2", 7, "name: '2' is no text: put it in quotes"),
        ("name: flow2", "name: yes", 7, "name: 'yes' is no text: put it in quotes"),
        ("name: flow2, ", "", 7, "a flow needs name"),
        ("/teleop", "/move_base", 7, "/move_base has two flows: which one would it take?"),
        ("/teleop", "'/move_*'", 6, "/move_base belongs to flow2 (/move_*) too"),
        ("/teleop", "/rtron_guard", 7, "/rtron_guard is the guard's own: name a node of the app"),
        ("/teleop", "/rtron/x", 7, "/rtron/x is the guard's own"),
        ("/teleop", "teleop", 7, "publisher: 'teleop' is not a full node name"),
        ("/teleop", "/tele op", 7, "publisher: '/tele op' is not a full node name"),
        ("/cmd_vel", "cmd_vel", 2, "topic: 'cmd_vel' is not a full topic name"),
        ("/cmd_vel", "/cmd_vel/", 2, "is not a full topic name"),
        ("/cmd_vel", "'/{ns}/cmd_vel'", 2, "is not a full topic name"),
        ("/cmd_vel", "/" + "x" * 300, 2, "is not a full topic name"),
        ("mode:", "type: Twist\n    mode:", 3, "type: 'Twist' is not a message type like pkg/Name"),
        ("mode:", "domain: Planing\n    mode:", 3, "did you mean Planning?"),
        ("mode:", "sharing: merge\n    mode:", 5, "Preemption is not for /cmd_vel"),
        ("mode:", "done: /cmd_vel\n    mode:", 3, "/cmd_vel cannot tell itself"),
        ("mode:", "done: /go/_action/status\n    mode:", 3, "name the action, /go"),
        (
            "mode:",
            "max_age: 5 minutes\n    mode:",
            3,
            "max_age: unknown unit 'minutes': did you mean min?",
        ),
        ("mode:", "queue_size: 0\n    mode:", 3, "queue_size: 0 is not between 1 and 1000000"),
        ("mode:", "topic: /x\n    mode:", 3, "topic stands twice in a GRCN"),
        ("mode:", "id: a b\n    mode:", 3, "id: 'a b' is not a word"),
        ("mode:", "successors: /base\n    mode:", 3, "successors is a list"),
        ("mode:", "successors: [base]\n    mode:", 3, "'base' is not a full node name"),
        ("mode:", "flow: []\n    mode:", 3, "unknown key 'flow' in a GRCN: did you mean flows?"),
        ("grcn:", "ros: 3\ngrcn:", 1, "ros: 3 is not between 1 and 2"),
        ("grcn:", "revision: -1\ngrcn:", 1, "revision: -1 is not between 0 and"),
        ("grcn:", "schema: rtron.plan/2\ngrcn:", 1, "did you mean rtron.plan/1?"),
        ("grcn:", "app: 1\ngrcn:", 1, "app: '1' is no text: put it in quotes"),
        ("grcn:", "rsrcn: {mode: enforce}\ngrcn:", 1, "the RSRCN needs policy"),
        ("grcn:", "rsrcn: yes\ngrcn:", 1, "the RSRCN is a mapping with id, mode, policy"),
        ("grcn:", "msrcn: {mode: enforce, policy: Safe}\ngrcn:", 1, "Safe is not for the MSRCN"),
        (
            "grcn:",
            "rsrcn: {mode: enforce, policy: Preemption}\ngrcn:",
            1,
            "choose from Block, Safe",
        ),
        ("grcn:", "fps_monitor: [{topic: /x}]\ngrcn:", 1, "an fps_monitor needs node"),
        ("grcn:", "accept_unenforceable: all\ngrcn:", 1, "accept_unenforceable is a list"),
        ("grcn:", "? [a]\n: b\ngrcn:", 1, "unknown key '' in the plan"),
    ],
)
def test_a_slip_is_told_with_its_line(old, new, line, fault):
    told = faults(swap(old, new))
    assert any(text.startswith(f"my.yaml:{line}: ") and fault in text for text in told), told


@pytest.mark.parametrize("key", ["rsrcn", "msrcn"])
def test_a_coordination_node_may_be_none(key):
    assert parse_plan(f"{key}:\n{LEAST}") == parse_plan(LEAST)


def test_nothing_is_a_value_where_there_may_be_none():
    text = swap("mode:", "done: null\n    mode:").replace("priority: 2", "priority: 2, timeout: ~")
    assert parse_plan(text) == parse_plan(LEAST)


def test_two_grcns_on_one_topic():
    again = LEAST.removeprefix("grcn:\n")
    told = faults(LEAST + again)
    assert "my.yaml:8: two GRCNs on /cmd_vel" in told
    assert "my.yaml:8: two coordination nodes have the id grcn_cmd_vel" in told


def test_ids_are_distinct_over_all_coordination_nodes():
    assert faults(WHOLE.replace("my_msrcn", "rsrcn"))[0].endswith("have the id rsrcn")
    assert faults(WHOLE.replace("my_msrcn", "fps_face_finder"))


def test_flow_names_are_distinct_in_a_coordination_node():
    assert faults(WHOLE.replace("vflow1", "x").replace("iflow1", "x")) == [
        "my.yaml:33: two flows have the name x"
    ]


def test_all_faults_are_told_at_once_in_the_order_of_the_lines():
    text = LEAST.replace("enforce", "enforced").replace("priority", "prio").replace("/teleop", "x")
    lines = [int(fault.split(":")[1]) for fault in faults(text)]
    assert lines == [3, 6, 7, 7]


def test_the_error_knows_file_and_line_and_helps():
    with pytest.raises(PlanError) as caught:
        parse_plan(swap("topic:", "topics:"), "my.yaml")
    assert (caught.value.path, caught.value.line) == ("my.yaml", 2)
    assert "rtron schema plan" in caught.value.help


def test_very_many_faults_are_cut_short():
    assert len(faults("".join(f"x{i}: 1\n" for i in range(1000)))) == 51
    assert faults("".join(f"x{i}: 1\n" for i in range(1000)))[-1] == "… and 950 more"


def test_what_is_wrong_does_not_hide_what_else_is():
    text = swap("priority: 2", "priority: 1").replace("enforce", "enforce\n    max_age: long")
    told = "\n".join(faults(text))
    assert "max_age: 'long' is no duration" in told
    assert "have the same priority 1" in told


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("", "the plan is empty"),
        ("# nothing\n", "the plan is empty"),
        ("- a", "the plan is a mapping"),
        ("grcn: [", "not YAML"),
        ("a: b: c", "not YAML"),
        ("a: 1\n---\nb: 2", "not YAML"),
        ("grcn: &x []\nfps_monitor: *x", "no anchors and aliases"),
        ("grcn: *x", "no anchors and aliases"),
        ("app: !!python/object:os.system x", "no tags"),
        ("app: !x y", "no tags"),
        ("app: !!str 1", "no tags"),
        ("[" * 1000, "no more than 20 levels"),
        ("a: " + "{a: " * 1000, "no more than 20 levels"),
        ("\x00", "not YAML"),
        ("app: \x07", "not YAML"),
    ],
)
def test_what_is_no_plan_at_all(text, fault):
    assert fault in faults(text)[0]


def test_a_file_that_cannot_be_read(tmp_path: Path):
    with pytest.raises(PlanError, match="No such file"):
        read_plan(tmp_path / "none.yaml")
    (tmp_path / "latin.yaml").write_bytes(b"app: \xff")
    with pytest.raises(PlanError, match="not UTF-8"):
        read_plan(tmp_path / "latin.yaml")
    (tmp_path / "large.yaml").write_bytes(b"#" * (2**20 + 1))
    with pytest.raises(PlanError, match="larger than"):
        read_plan(tmp_path / "large.yaml")


def test_a_file_is_read_from_its_path(tmp_path: Path):
    path = tmp_path / "rtron.yaml"
    path.write_text(LEAST, encoding="utf-8")
    assert read_plan(path) == parse_plan(LEAST)
    path.write_text(swap("enforce", "enforced"), encoding="utf-8")
    with pytest.raises(PlanError, match=r"rtron\.yaml:3"):
        read_plan(path)


def test_no_topic_takes_more_flows_than_a_guard_can_sort():
    flows = "".join(
        f"      - {{name: f{i}, publisher: '/*{i}', priority: {i}}}\n" for i in range(3000)
    )
    text = LEAST.split("    flows:", maxsplit=1)[0] + "    flows:\n" + flows
    assert faults(text)[0].endswith("more than 1000 flows into one topic")


def test_a_successor_behind_a_pattern_is_refused(tmp_path):
    path = tmp_path / "rtron.yaml"
    path.write_text(
        "schema: rtron.plan/1\napp: a\nros: 1\ngrcn:\n"
        "  - topic: /cmd_vel\n    mode: enforce\n    policy: Preemption\n"
        "    successors: [/teleop_twist, /base]\n"
        "    flows:\n      - {name: flow1, publisher: /teleop_*, priority: 1}\n"
    )
    with pytest.raises(PlanError, match="may be one node"):
        read_plan(path)


def test_a_cell_is_for_a_successor_of_an_enforcing_node():
    driver = LEAST.replace("    flows:", "    successors: [/base]\n    flows:")
    assert parse_plan(f"{driver}cell: [/base]\n").cell == ("/base",)
    why = "no coordination node that enforces has the successor"
    assert faults(f"{driver}cell: [/arm]\n") == [f"my.yaml:9: {why} /arm"]
    assert faults(f"{driver.replace('enforce', 'observe')}cell: [/base]\n") == [
        f"my.yaml:9: {why} /base"
    ]
    assert parse_plan(f"{driver}ros: 2\ncell: [/base]\n").cell == ("/base",)


@pytest.mark.parametrize("node", ["/base", "/teleop"])
def test_a_cell_of_ros2_is_for_no_end_of_an_action(node):
    action = LEAST.replace("    flows:", "    successors: [/base]\n    flows:")
    action = action.replace("/cmd_vel", "/dock\n    type: dock_msgs/action/Dock")
    why = f"my.yaml:11: the action /dock cannot be carried into the cell of {node}: ROS 2"
    assert why in faults(f"{action}ros: 2\ncell: [{node}]\n")
