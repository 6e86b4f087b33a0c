import shutil

import pytest
from file_tree import write

from rtron.errors import InputError
from rtron.sources.static.common.launch_paths import find_launch_file
from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.ros1.app import scan_app
from rtron.sources.workspace import read_workspace
from rtron.vocabulary import ActionRole, Direction, Resolution, Trust

ONE = ScanOptions(workers=1)


def scan(folder, *launches, args=None, options=ONE, environ=None):
    workspace = read_workspace([folder], {})
    wanted = [(find_launch_file(f"robot/{name}", workspace), args or {}) for name in launches]
    return scan_app([folder], wanted, environ or {}, options)


def ends(graph, node, *, implicit=False):
    """Return the topics of a node, published with `>` and subscribed with `<`."""
    return {
        ("> " if e.direction is Direction.PUBLISH else "< ") + e.topic
        for e in graph.endpoints
        if e.node == node and e.implicit is implicit
    }


@pytest.fixture
def app(folder):
    return scan(folder, "app.launch", args={"odom": "wheels"}).graph


def test_names_are_namespaced_filled_and_remapped(app):
    assert ends(app, "/base/driver") == {"< /cmd_vel", "> /base/wheels"}
    odom = next(e for e in app.endpoints if e.topic == "/base/wheels")
    assert odom.resolution is Resolution.PARAMETER
    command = next(e for e in app.endpoints if e.node == "/base/driver" and e.topic == "/cmd_vel")
    assert command.declared_name == "/base/cmd_vel"
    assert command.type == "geometry_msgs/Twist"
    assert command.evidence[0].file.endswith("driver.cpp")
    assert command.evidence[0].line == 9


def test_the_last_remap_of_a_name_counts(app):
    assert "> /cmd_vel" in ends(app, "/teleop")
    assert "> /joy_vel" not in ends(app, "/teleop")


def test_an_action_has_five_topics_each_remapped_on_its_own(app):
    topics = {"> /elsewhere", "> /go/cancel", "< /go/status", "< /go/feedback", "< /go/result"}
    assert ends(app, "/teleop", implicit=True) == topics | {"< /clock"}
    types = {e.topic: e.type for e in app.endpoints if e.node == "/teleop"}
    assert types["/elsewhere"] == "move_base_msgs/MoveBaseActionGoal"
    assert types["/go/cancel"] == "actionlib_msgs/GoalID"
    assert types["/go/result"] == "move_base_msgs/MoveBaseActionResult"
    (action,) = app.actions
    assert (action.node, action.type) == ("/teleop", "move_base_msgs/MoveBaseAction")
    assert action.role is ActionRole.CLIENT


CALLERS = {
    "src/caller.cpp": """#include <ros/ros.h>
#include <actionlib/client/simple_action_client.h>
#include <move_base_msgs/MoveBaseAction.h>
int main(int c, char** v) {
  ros::init(c, v, "x");
  actionlib::SimpleActionClient<move_base_msgs::MoveBaseAction> client("arm/go", true);
}
""",
    "scripts/caller.py": """#!/usr/bin/env python
import actionlib
from move_base_msgs.msg import MoveBaseAction
actionlib.SimpleActionClient("arm/go", MoveBaseAction)
""",
}


@pytest.mark.parametrize(("type", "target"), [("caller", "/real"), ("caller.py", "/arm/go")])
def test_a_remap_of_the_name_of_an_action_counts_in_roscpp_alone(folder, type, target):
    write(folder / "robot", CALLERS)
    cmake = folder / "robot/CMakeLists.txt"
    cmake.write_text(cmake.read_text() + "\nadd_executable(caller src/caller.cpp)\n")
    remap = '<remap from="arm/go" to="/real"/>'
    node = f'<launch><node pkg="robot" type="{type}" name="n">{remap}</node></launch>'
    (folder / "robot/launch/one.launch").write_text(node)
    graph = scan(folder, "one.launch").graph
    assert [action.name for action in graph.actions] == [target]
    goal = next(end for end in graph.endpoints if end.topic == f"{target}/goal")
    assert goal.declared_name == "/arm/go/goal"


def test_nodes_tell_where_they_come_from(app):
    driver = next(node for node in app.nodes if node.name == "/base/driver")
    assert (driver.package, driver.executable, driver.trust) == ("robot", "driver", Trust.OWN)
    assert driver.origin.endswith("launch/app.launch:5")


def test_simulated_time_only_where_it_is_set(folder, app):
    assert "< /clock" in ends(app, "/base/driver", implicit=True)
    graph = scan(folder, "nodelets.launch").graph
    assert not any(e.topic == "/clock" for e in graph.endpoints)


def test_a_nodelet_talks_through_its_manager(folder):
    graph = scan(folder, "nodelets.launch").graph
    assert ends(graph, "/manager") == {"< /camera/image", "> /filter/out"}
    assert ends(graph, "/filter") == set()
    assert "> /manager/bond" in ends(graph, "/filter", implicit=True)
    notes = {note.what: note.why for note in graph.unresolved}
    reason = "its package is here, and registers no class of this name: choose from robot/Filter"
    assert notes["nodelet robot/Unknown"] == reason
    assert notes["node /elsewhere"] == "no launch file that is read starts it"


def test_what_nodes_start_is_read_once_however_it_circles(folder):
    app = scan(folder, "boss.launch")
    nodes = {node.name: node for node in app.graph.nodes}
    assert set(nodes) == {"/boss", "/run", "/late", "/by_hand", "/thing"}
    assert nodes["/late"].origin.startswith("started by /boss (")
    assert nodes["/by_hand"].origin.startswith("started by /run (")
    assert "> /by_hand/cmd_vel" in ends(app.graph, "/by_hand")
    assert [tree.root.path.rpartition("/")[2] for tree in app.trees] == [
        "boss.launch",
        "more.launch",
    ]
    notes = " ".join(f"{note.what}: {note.why}" for note in app.graph.unresolved)
    assert "robot" in {note.package for note in app.graph.unresolved}
    assert "none.launch" in notes
    assert "roslaunch $PACKAGE x.launch" in notes
    assert "node /thing (nowhere/thing): its package is not here" in notes


@pytest.mark.parametrize(
    ("type", "missing"),
    [
        ("teleop.py", ""),
        ("driver", ""),
        ("teleop", "robot/teleop"),
        ("unmade", "robot/unmade"),
        ("closed.py", "robot/closed.py"),
        ("named", ""),
    ],
)
def test_a_program_that_its_package_does_not_have_is_noted(folder, type, missing):
    (folder / "robot/scripts/closed.py").write_text("#!/usr/bin/env python\n")
    cmake = folder / "robot/CMakeLists.txt"
    cmake.write_text(cmake.read_text() + "\ncuda_add_executable(named x.cu)\n")
    node = f'<launch><node pkg="robot" type="{type}" name="n"/></launch>'
    (folder / "robot/launch/one.launch").write_text(node)
    notes = scan(folder, "one.launch").graph.unresolved
    assert "".join(note.missing for note in notes) == missing


def test_a_name_that_several_places_start_is_noted(folder):
    launch = (folder / "robot/launch/app.launch").read_text()
    (folder / "robot/launch/again.launch").write_text(launch)
    graph = scan(folder, "app.launch", "again.launch").graph
    assert [n.name for n in graph.nodes].count("/teleop") == 1
    assert "/teleop" in [f.subject for f in graph.wiring if f.kind == "duplicate_node"]


def test_one_worker_and_two_find_the_same(folder):
    launches = ("app.launch", "nodelets.launch", "boss.launch")
    assert scan(folder, *launches) == scan(folder, *launches, options=ScanOptions(workers=2))


def test_a_program_that_takes_too_long_is_a_note(folder):
    app = scan(folder, "app.launch", options=ScanOptions(workers=1, seconds=1e-6))
    notes = [note for note in app.graph.unresolved if "not done within" in note.why]
    assert {note.what for note in notes} == {
        "the program of /base/driver",
        "the program of /teleop",
    }
    assert {node.name for node in app.graph.nodes} == {"/base/driver", "/teleop"}


def test_files_that_are_no_programs_leave_the_rest(folder):
    (folder / "robot/src/driver.cpp").write_bytes(b"\xff\x00 int main( {{{{ #include <" * 50)
    (folder / "robot/scripts/teleop.py").write_bytes(b"def ((((\n\x00")
    graph = scan(folder, "app.launch").graph
    assert {node.name for node in graph.nodes} == {"/base/driver", "/teleop"}
    assert any(e.file.endswith("teleop.py") for note in graph.unresolved for e in note.evidence)


def test_a_deeply_nested_source_does_not_end_the_scan(folder):
    deep = "#!/usr/bin/env python\nx = " + "(" * 90 + "0" + ")" * 90 + "+1" * 20_000 + "\n"
    (folder / "robot/scripts/teleop.py").write_text(deep)
    graph = scan(folder, "app.launch").graph
    assert "> /base/odom" in ends(graph, "/base/driver")


def test_launch_files_are_found_as_roslaunch_finds_them(folder):
    workspace = read_workspace([folder], {})
    path = folder / "robot/launch/app.launch"
    assert find_launch_file("robot/app.launch", workspace) == path
    assert find_launch_file("robot/launch/app.launch", workspace) == path
    assert find_launch_file(str(path), workspace) == path
    shutil.copy(path, folder / "robot/app.launch")
    assert (
        find_launch_file("robot/app.launch", read_workspace([folder], {}))
        == path.parents[1] / path.name
    )
    with pytest.raises(InputError) as raised:
        find_launch_file("robot/ap.launch", workspace)
    assert "robot/app.launch" in raised.value.help
    for missing in ("", "/", "robot/", "nowhere/app.launch", "robot/../robot/package.xml/"):
        with pytest.raises(InputError):
            find_launch_file(missing, workspace)


def test_a_missing_argument_is_the_users_to_give(folder):
    with pytest.raises(InputError, match="needs a value for who"):
        scan(folder, "more.launch")


def test_what_starts_ever_new_launches_ends(folder, monkeypatch):
    boss = folder / "robot/scripts/boss.py"
    boss.write_text(
        "#!/usr/bin/env python\nimport subprocess\nimport rospy\nrospy.init_node('boss')\n"
        "n = rospy.get_param('~n')\n"
        "subprocess.Popen(['roslaunch', 'robot', 'chain.launch', 'n:=%d' % (n + 1)])\n"
    )
    (folder / "robot/launch/chain.launch").write_text(
        '<launch><arg name="n"/><node pkg="robot" type="boss.py" name="boss$(arg n)">'
        '<param name="n" value="$(arg n)"/></node></launch>'
    )
    monkeypatch.setattr("rtron.sources.static.ros1.app.MAX_ROUNDS", 3)
    graph = scan(folder, "chain.launch", args={"n": "0"}).graph
    assert {node.name for node in graph.nodes} == {"/boss0", "/boss1", "/boss2"}
    notes = {note.what: note.why for note in graph.unresolved}
    assert notes["node /boss3"] == "launch files start each other more than 3 levels deep"


def test_an_argument_that_one_of_several_launch_files_declares_is_declared(tmp_path):
    paths = [tmp_path / name for name in ("a.launch", "b.launch")]
    paths[0].write_text("<launch/>")
    paths[1].write_text('<launch><arg name="joystick" default="0"/></launch>')

    def notes(name):
        wanted = [(path, {name: "1"}) for path in paths]
        return [note.what for note in scan_app([tmp_path], wanted, {}, ONE).graph.unresolved]

    assert notes("joystick") == []
    assert notes("joystik") == ["launch argument joystik"]
