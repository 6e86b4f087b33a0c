import json

import pytest

from rtron.planning.plan_file.loader import parse_plan, read_plan
from rtron.vocabulary import Mode


def test_a_proposal_is_shown(rtron, graph_file):
    ran = rtron("plan", graph_file)
    assert (ran.code, ran.err) == (0, "")
    assert "/cmd_vel  geometry_msgs/Twist, Control, contend" in ran.out
    assert f"rtron plan {graph_file} -o rtron.yaml" in ran.out


def test_images_are_observed_only_on_request(rtron, graph_file):
    document = json.loads(graph_file.read_text())
    image = {"topic": "/image", "type": "sensor_msgs/Image"}
    names = ("/camera_a", "/camera_b", "/recogniser")
    document["endpoints"] += [
        {**document["endpoints"][0], **image, "node": name, "direction": direction}
        for name, direction in zip(names, ("publish", "publish", "subscribe"), strict=True)
    ]
    graph_file.write_text(json.dumps(document))
    assert "/image" not in rtron("plan", graph_file).out
    ran = rtron("plan", graph_file, "--every-risk")
    assert "GRCN that only observe (1)\n  /image  " in ran.out
    assert "--every-risk -o rtron.yaml" in ran.out


def test_a_plan_is_written_and_can_be_read(rtron, graph_file, plan_file):
    assert [grcn.topic for grcn in read_plan(plan_file).grcn] == ["/cmd_vel"]
    ran = rtron("plan", graph_file, "-o", plan_file, "--launch", "my app.launch")
    assert f"rtron instrument 'my app.launch' --plan {plan_file} -o guarded.launch" in ran.out


@pytest.mark.parametrize(
    ("launch", "shown", "out"),
    [
        (None, "APP.launch.py", "guarded.launch.py"),
        ("app.launch.xml", "app.launch.xml", "guarded.launch.xml"),
        ("my app.yml", "'my app.yml'", "guarded.launch.yml"),
        ("app.py", "app.py", "guarded.launch.py"),
    ],
)
def test_the_next_step_is_that_of_the_apps_ros(rtron, graph_file, plan_file, launch, shown, out):
    graph = json.loads(graph_file.read_text())
    graph_file.write_text(json.dumps({**graph, "ros": 2}))
    ran = rtron("plan", graph_file, "-o", plan_file, *(("--launch", launch) if launch else ()))
    assert f"rtron instrument {shown} --plan {plan_file} -o {out}\n" in ran.out


def test_the_yaml_alone_is_printed_to_a_dash(rtron, graph_file):
    assert parse_plan(rtron("plan", graph_file, "-o", "-").out).app == "small"


def test_an_edited_plan_is_kept(rtron, graph_file, plan_file):
    backup = plan_file.with_name("rtron.yaml.bak")
    edited = plan_file.read_text() + "# mine\n"
    plan_file.write_text(edited)
    rtron("plan", graph_file, "-o", plan_file)
    rtron("plan", graph_file, "-o", plan_file)
    assert backup.read_text() == edited
    assert "# mine" not in plan_file.read_text()


def test_a_topic_with_a_hole_in_its_name_is_said_to_be_left_out(rtron, graph_file):
    document = json.loads(graph_file.read_text())
    for endpoint in document["endpoints"]:
        endpoint |= {"topic": "{prefix}/cmd_vel", "resolution": "symbolic"}
    graph_file.write_text(json.dumps(document))
    ran = rtron("plan", graph_file)
    assert ran.code == 1
    why = "no plan can guard it: its whole"
    assert f"Left out (1)\n  warning  base\n           {{prefix}}/cmd_vel: {why}" in ran.out


def test_a_command_with_one_publisher_is_guarded_too(rtron, graph_file):
    document = json.loads(graph_file.read_text())
    document["endpoints"] = document["endpoints"][1:]
    graph_file.write_text(json.dumps(document))
    ran = rtron("plan", graph_file, "-o", "-")
    (grcn,) = parse_plan(ran.out).grcn
    assert (ran.code, grcn.mode, [flow.publisher for flow in grcn.flows]) == (
        0,
        Mode.ENFORCE,
        ["/planner"],
    )


def test_what_no_coordination_node_can_guard_is_told(rtron, graph_file, plan_file):
    document = json.loads(graph_file.read_text())
    document["services"] = [{"node": "/base", "name": "/kill", "type": "std_srvs/Trigger"}]
    graph_file.write_text(json.dumps(document))
    words = "emergency stop\n           /kill: a plan cannot guard services"
    assert words in rtron("plan", graph_file).out
    assert words in rtron("check", plan_file, "--graph", graph_file).out
    (path,) = parse_plan(rtron("plan", graph_file, "-o", "-").out).unguarded
    assert (path.what, path.why.partition(":")[0]) == ("/kill", "a plan cannot guard services")


def without_reader(document):
    document["endpoints"] = document["endpoints"][1:2]


def without_motion(document):
    document["endpoints"] = []


def without_publisher(document):
    document["endpoints"] = document["endpoints"][2:]


def without_name(document):
    document["endpoints"][0]["node"] = "{name}"


@pytest.mark.parametrize(
    ("change", "why"),
    [
        (without_motion, "small\n           nothing that was read moves a robot"),
        (without_name, "base\n           /cmd_vel: its coordination node only observes: `mode:"),
    ],
)
def test_a_plan_that_guards_nothing_says_why_and_no_next_step(rtron, graph_file, change, why):
    document = json.loads(graph_file.read_text())
    change(document)
    graph_file.write_text(json.dumps(document))
    ran = rtron("plan", graph_file)
    assert (ran.code, ran.err) == (1, "")
    assert ran.out.startswith("This plan guards nothing: ")
    assert f"  warning  {why}" in ran.out
    assert "Next" not in ran.out


def test_what_leaves_the_launch_is_guarded_and_the_way_past_it_told(rtron, graph_file, tmp_path):
    document = json.loads(graph_file.read_text())
    without_reader(document)
    graph_file.write_text(json.dumps(document))
    plan_file = tmp_path / "leaving.yaml"
    ran = rtron("plan", graph_file, "-o", plan_file)
    assert (ran.code, ran.err, "\nNext\n" in ran.out) == (0, "", True)
    doubt = "  warning  GRCN grcn_cmd_vel\n           which node obeys it on the robot is not known"
    assert f"To decide (1)\n{doubt}" in ran.out
    checked = rtron("check", plan_file, "--graph", graph_file)
    assert (checked.code, doubt in checked.out, "1 problem" in checked.out) == (0, True, True)
    (grcn,) = read_plan(plan_file).grcn
    assert (grcn.mode, [flow.publisher for flow in grcn.flows], grcn.successors) == (
        Mode.ENFORCE,
        ["/planner"],
        (),
    )


def test_what_nobody_here_publishes_is_guarded_and_to_be_decided(rtron, graph_file):
    document = json.loads(graph_file.read_text())
    without_publisher(document)
    graph_file.write_text(json.dumps(document))
    ran = rtron("plan", graph_file)
    assert (ran.code, ran.err) == (0, "")
    decided = ran.out.partition("To decide (1)\n")[2]
    assert decided.startswith(
        "  warning  GRCN grcn_cmd_vel\n           it has no flow, so it keeps"
    )


def test_a_plan_that_guards_nothing_is_written_all_the_same(rtron, quiet_file, tmp_path):
    ran = rtron("plan", quiet_file, "-o", tmp_path / "quiet.yaml")
    assert (ran.code, "rtron instrument" in ran.out) == (1, False)
    assert read_plan(tmp_path / "quiet.yaml").app == "quiet"
    ran = rtron("plan", quiet_file, "-o", "-")
    assert (ran.code, parse_plan(ran.out).app) == (1, "quiet")
    assert ran.err.startswith("This plan guards nothing: ")


def test_bad_input_is_2(rtron, tmp_path):
    assert rtron("plan").code == 2
    assert rtron("plan", tmp_path / "none.json").code == 2


def test_a_good_plan_is_0(rtron, plan_file, graph_file):
    assert rtron("check", plan_file).code == 0
    ran = rtron("check", plan_file, "--graph", graph_file)
    assert ran.code == 0
    assert "1 problem\n  warning  GRCN grcn_cmd_vel\n" in ran.out
    decided = plan_file.read_text().replace("priority: 2", "priority: 20")
    plan_file.write_text(decided)
    assert rtron("check", plan_file, "--graph", graph_file).out == f"{plan_file}  no problems\n"


def test_a_plan_that_does_not_fit_the_app_is_1(rtron, plan_file, graph_file):
    plan_file.write_text(plan_file.read_text().replace("topic: /cmd_vel", "topic: /cmd_vell"))
    ran = rtron("check", plan_file, "--graph", graph_file)
    assert ran.code == 1
    assert "/cmd_vell" in ran.out
    assert "  error " in ran.out


def test_a_check_of_a_plan_that_guards_nothing_says_so_first_and_is_1(rtron, plan_file, graph_file):
    plan_file.write_text(plan_file.read_text().replace("mode: enforce", "mode: observe"))
    for words in ((), ("--graph", graph_file)):
        ran = rtron("check", plan_file, *words)
        assert ran.code == 1
        assert ran.out.startswith("This plan guards nothing: ")
        assert "/cmd_vel" in ran.out
        assert "its coordination node only observes" in ran.out


def test_a_plan_with_a_fault_is_2_with_its_line(rtron, plan_file):
    plan_file.write_text("schema: rtron.plan/1\napp: x\nflws: []\ngrnc: []\n")
    ran = rtron("check", plan_file)
    assert (ran.code, ran.out) == (2, "")
    assert f"error: {plan_file}:3: " in ran.err
    assert f"\n{plan_file}:4: " in ran.err
    assert "\nhelp: " in ran.err


def test_no_plan_is_2(rtron, tmp_path):
    assert rtron("check", tmp_path / "none.yaml").code == 2
