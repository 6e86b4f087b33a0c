"""`rtron functions`, and the functions of nodes in `rtron scan` and `rtron plan`."""

import json
import os
import shutil
import subprocess
from xml.etree import ElementTree as ET

import pytest

CORPUS = [
    {"repo": "laser_driver", "packages": [{"name": "laser_driver"}]},
    {"repo": "teleop_keyboard", "packages": [{"name": "teleop_keyboard"}]},
    {
        "repo": "mobile_base_driver",
        "packages": [{"name": "mobile_base_driver", "description": "Driver of a mobile base."}],
    },
]


def script(*calls):
    types = "from geometry_msgs.msg import Twist\nfrom sensor_msgs.msg import LaserScan, Image\n"
    return f"#!/usr/bin/env python\nimport rospy\n{types}" + "\n".join(calls) + "\n"


DESCRIPTIONS = {
    "teleop_keyboard": "Teleoperation of a robot by keyboard.",
    "mobile_base_driver": "Driver of a mobile base.",
    "qwert": "Detects and recognizes faces of people in camera images.",
}
SCRIPTS = {
    "teleop_keyboard": script('rospy.Publisher("cmd_vel", Twist, queue_size=1)'),
    "mobile_base_driver": script('rospy.Subscriber("cmd_vel", Twist)'),
    "qwert": script('rospy.Subscriber("image", Image)'),
}
LAUNCH = """<launch>
<node pkg="teleop_keyboard" type="run.py" name="keys"/>
<node pkg="mobile_base_driver" type="run.py" name="base"/>
<node pkg="qwert" type="run.py" name="watcher"/>
</launch>"""


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.delenv("ROS_PACKAGE_PATH", raising=False)


@pytest.fixture
def corpus(tmp_path):
    path = tmp_path / "corpus.jsonl"
    path.write_text("".join(json.dumps(line) + "\n" for line in CORPUS))
    return path


@pytest.fixture
def repositories(tmp_path):
    folder = tmp_path / "repositories"
    for name, text in SCRIPTS.items():
        package = folder / name / name
        (package / "scripts").mkdir(parents=True)
        words = f"<description>{DESCRIPTIONS[name]}</description>"
        (package / "package.xml").write_text(f"<package><name>{name}</name>{words}</package>")
        (package / "CMakeLists.txt").write_text(f"project({name})")
        (package / "scripts" / "run.py").write_text(text)
        (package / "scripts" / "run.py").chmod(0o755)
    (folder / "qwert" / "qwert" / "app.launch").write_text(LAUNCH)
    return folder


def edges(text):
    return {(e["from"], e["to"]): e["messages"] for e in json.loads(text)["direct"]}


def test_a_corpus_gives_what_is_typical(rtron, corpus):
    ran = rtron("functions", "graph", corpus)
    assert (ran.code, ran.err) == (0, "")
    (message, *_) = edges(ran.out)["Teleoperation", "Mobile"]
    assert (message["type"], message["basis"]) == ("geometry_msgs/Twist", "typical")


def test_a_package_of_which_nothing_tells_counts_with_its_repository(rtron, corpus):
    line = {"repo": "teleop_keyboard", "packages": [{"name": "qwert"}]}
    corpus.write_text(json.dumps(line) + "\n")
    (node,) = json.loads(rtron("functions", "graph", corpus).out)["functions"]
    assert (node["name"], node["packages"]) == ("Teleoperation", 1)


def test_a_folder_gives_what_its_source_says(rtron, repositories):
    ran = rtron("functions", "graph", repositories, "-j", "1")
    assert (ran.code, ran.err) == (0, "")
    (message, *_) = edges(ran.out)["Teleoperation", "Mobile"]
    assert message == {
        "type": "geometry_msgs/Twist",
        "publishers": 1,
        "subscribers": 1,
        "from_depends": 0,
        "to_depends": 0,
        "basis": "source",
    }
    names = [node["name"] for node in json.loads(ran.out)["functions"]]
    assert names == ["Teleoperation", "Mobile", "Image Recognition"]


def test_a_program_that_cannot_be_read_is_told_and_counted(rtron, repositories):
    program = repositories / "qwert" / "qwert" / "scripts" / "run.py"
    program.write_text("#!/usr/bin/env python\nimport rospy\ndef (\n")
    ran = rtron("functions", "graph", repositories, "-j", "1")
    assert ran.code == 0
    (line,) = ran.err.splitlines()
    assert line.startswith(f"left out: {program}")
    (note,) = json.loads(ran.out)["unresolved"]
    assert note["evidence"][0]["file"] == str(program)
    page = rtron("functions", "graph", repositories, "-j", "1", "--format", "html").out
    assert "1 thing in programs could not be read." in page


def copy_of_teleop(repositories, repository, *calls):
    """Add a repository with another package `teleop_keyboard`."""
    package = repositories / repository / "teleop_keyboard"
    shutil.copytree(repositories / "teleop_keyboard" / "teleop_keyboard", package)
    (package / "scripts" / "run.py").write_text(script(*calls))


@pytest.mark.parametrize(("repository", "publishes"), [("a_first", False), ("z_last", True)])
def test_of_packages_with_one_name_the_first_counts_with_its_own_traffic(
    rtron, repositories, repository, publishes
):
    copy_of_teleop(repositories, repository, 'rospy.Subscriber("cmd_vel", Twist)')
    ran = rtron("functions", "graph", repositories, "-j", "1")
    document = json.loads(ran.out)
    assert (document["packages"], document["repeated"]) == (3, 1)
    counts = {node["name"]: node["packages"] for node in document["functions"]}
    assert counts["Teleoperation"] == 1
    (message, *_) = edges(ran.out)["Teleoperation", "Mobile"]
    assert (message["publishers"], message["subscribers"]) == (int(publishes), 1)
    (line,) = ran.err.splitlines()
    later = "teleop_keyboard" if repository == "a_first" else repository
    assert line.startswith(f"left out: {later}: ")
    assert line.endswith(": teleop_keyboard")


def test_a_corpus_counts_a_repeated_package_once(rtron, corpus):
    again = {"repo": "other", "packages": [{"name": "laser_driver"}, {"name": "sonar_driver"}]}
    corpus.write_text(corpus.read_text() + json.dumps(again) + "\n")
    ran = rtron("functions", "graph", corpus)
    document = json.loads(ran.out)
    assert (document["packages"], document["repeated"]) == (4, 1)
    assert "left out: other: " in ran.err


@pytest.mark.parametrize(
    ("format", "start"), [("dot", "digraph"), ("svg", "<svg"), ("html", "<!doctype html>")]
)
def test_pictures(rtron, corpus, tmp_path, format, start):
    file = tmp_path / f"out.{format}"
    assert rtron("functions", "graph", corpus, "--format", format, "-o", file).code == 0
    assert file.read_text().startswith(start)
    if format == "svg":
        ET.parse(file)


def test_no_input_is_2(rtron, tmp_path):
    ran = rtron("functions", "graph", tmp_path / "none.jsonl")
    assert (ran.code, ran.out) == (2, "")
    assert "error" in ran.err


def test_what_is_left_out_is_told(rtron, corpus):
    corpus.write_text(corpus.read_text() + "no json\n")
    ran = rtron("functions", "graph", corpus)
    assert ran.code == 0
    assert "left out" in ran.err
    assert "corpus.jsonl" in ran.err


def slam(tmp_path, name="slam"):
    ends = [
        ("/slam", "subscribe", "sensor_msgs/LaserScan"),
        ("/slam", "publish", "nav_msgs/OccupancyGrid"),
        ("/gazebo", "publish", "sensor_msgs/LaserScan"),
        ("/gazebo", "subscribe", "geometry_msgs/Twist"),
    ]
    packages = {"/slam": "gmapping", "/move_base": "move_base", "/gazebo": "gazebo_ros"}
    document = {
        "schema": "rtron.graph/1",
        "app": "house",
        "nodes": [{"name": n, "package": p} for n, p in packages.items()],
        "endpoints": [
            {"node": node, "direction": way, "topic": f"/{type}", "type": type}
            for node, way, type in ends
        ],
    }
    path = tmp_path / f"{name}.json"
    path.write_text(json.dumps(document))
    return path


def test_one_app(rtron, tmp_path):
    ran = rtron("functions", "apps", slam(tmp_path))
    assert (ran.code, ran.err) == (0, "")
    assert "house  SLAM" in ran.out
    assert "Mapping 1" in ran.out
    assert "beside the paper" not in ran.out


def test_a_folder_of_apps_is_counted_beside_the_papers(rtron, tmp_path):
    folder = tmp_path / "graphs"
    folder.mkdir()
    slam(folder, "a"), slam(folder, "b")
    text = rtron("functions", "apps", folder).out
    assert "2 apps, beside the paper's 110" in text
    (row,) = [line.split() for line in text.splitlines() if line.strip().startswith("SLAM")]
    assert row[1:5] == ["2", "(100.0%)", "11", "(10.0%)"]
    document = json.loads(rtron("functions", "apps", folder, "--format", "json").out)
    assert document["schema"] == "rtron.apps/1"
    assert [app["app"] for app in document["apps"]] == ["a", "b"]
    assert document["apps"][0]["functions"]["Mobile"] == ["/gazebo"]
    assert {"names": ["SLAM"], "apps": 2, "paper": 11} in document["categories"]


def test_an_app_of_no_category(rtron, quiet_file):
    out = rtron("functions", "apps", quiet_file).out
    assert "quiet  none of the paper's categories" in out
    assert "no function is known" in out


def test_a_folder_without_graphs_is_2(rtron, tmp_path):
    ran = rtron("functions", "apps", tmp_path)
    assert ran.code == 2
    assert "--format graph" in ran.err


APP = ("--launch", "qwert/app.launch", "-j", "1")


def test_a_scan_tells_the_functions_of_nodes(rtron, repositories):
    ran = rtron("scan", repositories, *APP, "--format", "graph", "--fail-on", "never")
    nodes = {n["name"]: (n["function"], n["domain"]) for n in json.loads(ran.out)["nodes"]}
    assert nodes == {
        "/keys": ("Teleoperation", "Control"),
        "/base": ("Mobile", "Drivers"),
        "/watcher": ("Recognition", "Perception"),
    }


def test_a_scan_shows_them_to_people(rtron, repositories):
    text = rtron("scan", repositories, *APP, "--level", "auditor").out
    assert "Functions of the nodes" in text
    assert "  Perception, Recognition: /watcher" in text
    page = rtron("scan", repositories, *APP, "--format", "html").out
    assert '"function":"Recognition","domain":"Perception"' in page


def test_a_plan_shows_those_of_what_it_guards(rtron, graph_file):
    text = rtron("plan", graph_file).out
    assert "Functions of the nodes" in text
    assert "Control, Teleoperation: /keyboard" in text
    assert "/base" not in text.partition("Functions of the nodes")[2].partition("Next")[0]


def test_a_packages_description_tells_what_it_recognizes(rtron, corpus):
    package = {"name": "qqq", "description": "Speech recognition: understands spoken commands."}
    corpus.write_text(json.dumps({"repo": "qqq", "packages": [package]}))
    (node,) = json.loads(rtron("functions", "graph", corpus).out)["functions"]
    assert node["name"] == "Speech Recognition"


@pytest.mark.parametrize(
    ("name", "words", "start"),
    [
        ("x.svg", (), "<svg"),
        ("x.HTML", (), "<!doctype html>"),
        ("x.dot", (), "digraph"),
        ("x.json", (), "{"),
        ("x.txt", (), "{"),
        ("x", (), "{"),
        ("x.svg", ("--format", "json"), "{"),
    ],
)
def test_the_output_is_what_its_name_says(rtron, corpus, tmp_path, name, words, start):
    assert rtron("functions", "graph", corpus, "-o", tmp_path / name, *words).code == 0
    assert (tmp_path / name).read_text().startswith(start)


def test_readmes_count_in_the_graph(rtron, corpus, tmp_path):
    corpus.write_text(json.dumps({"repo": "zzz", "packages": [{"name": "zzz"}]}))
    readmes = tmp_path / "readmes.jsonl"
    text = "This package estimates the pose of the robot: localization with a particle filter."
    readmes.write_text(json.dumps({"repo": "zzz", "readme": text}))
    graph = ("functions", "graph", corpus)
    assert json.loads(rtron(*graph).out)["functions"] == []
    (node,) = json.loads(rtron(*graph, "--readmes", readmes).out)["functions"]
    assert node["name"] == "Localization"


def test_a_graph_shows_how_far_it_is(rtron, corpus, monkeypatch):
    monkeypatch.setenv("FORCE_COLOR", "1")
    assert "3/3" in rtron("functions", "graph", corpus).err


def test_what_is_left_out_is_told_before_an_error_too(rtron, corpus):
    corpus.write_text("no json\n" * 1001)
    ran = rtron("functions", "graph", corpus)
    assert (ran.code, ran.out) == (2, "")
    rows = ran.err.splitlines()
    assert rows[0].startswith(f"left out: {corpus}:1: not JSON")
    assert rows[10] == "left out: 990 more"
    assert rows[11] == "error: more than 1000 entries cannot be read"


@pytest.fixture
def graphs(tmp_path):
    folder = tmp_path / "graphs"
    folder.mkdir()
    slam(folder, "good")
    (folder / "bad.json").write_text("{")
    os.mkfifo(folder / "pipe.json")
    return folder


def test_a_graph_that_cannot_be_read_costs_itself_only(rtron, graphs):
    ran = rtron("functions", "apps", graphs, graphs / "absent.json", "--format", "json")
    assert ran.code == 0
    assert [app["app"] for app in json.loads(ran.out)["apps"]] == ["good"]
    pipe, bad, absent = ran.err.splitlines()
    assert pipe == f"left out: {graphs}/pipe.json: is no file"
    assert bad.startswith(f"left out: {graphs}/bad.json:1: not JSON: EOF")
    assert absent == f"left out: {graphs}/absent.json: No such file or directory"


def test_no_graph_that_can_be_read_is_2(rtron, graphs):
    (graphs / "good.json").unlink()
    ran = rtron("functions", "apps", graphs, graphs / "absent.json")
    assert (ran.code, ran.out) == (2, "")
    assert f"error: {graphs}/bad.json:1: not JSON: EOF" in ran.err
    (graphs / "bad.json").unlink()
    assert f"error: {graphs}: has no *.json" in rtron("functions", "apps", graphs).err


def test_a_pipe_that_is_named_is_read(rtron, tmp_path):
    pipe = tmp_path / "pipe.json"
    os.mkfifo(pipe)
    with subprocess.Popen(["cp", slam(tmp_path), pipe]) as writer:
        ran = rtron("functions", "apps", pipe)
        assert writer.wait() == 0
    assert "house  SLAM" in ran.out
