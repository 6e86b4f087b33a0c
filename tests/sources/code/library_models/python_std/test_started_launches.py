"""Launches that a node starts by roslaunch's API, a process or launch: followed, else noted."""

import pytest
import ros2_runs
from ros1_runs import run_text

HEAD = "import os, subprocess, roslaunch, rospy\n"
FILE = ("p/a.launch", ("x:=1",))
FOLLOWED = {
    "roslaunch.main(['roslaunch', 'p', 'a.launch', 'x:=1'])": FILE,
    "roslaunch.main(argv=['', 'p', 'a.launch', 'x:=1'])": FILE,
    "roslaunch.parent.ROSLaunchParent(0, ['/a.launch']).start()": ("/a.launch", ()),
    "roslaunch.ROSLaunchParent(0, [('/a.launch', ['x:=1'])])": ("/a.launch", ("x:=1",)),
    "f = roslaunch.rlutil.resolve_launch_arguments(['p', 'a'])\nroslaunch.ROSLaunchParent(0, f)": (
        "p/a",
        (),
    ),
    "l = roslaunch.scriptapi.ROSLaunch()\nl.load('/a.launch')": ("/a.launch", ()),
    "roslaunch.scriptapi.ROSLaunch().launch(roslaunch.core.Node('p', 't'))": ("p/t", ("rosrun",)),
    "roslaunch.Node('p', 't', name='n', args='a b', remap_args=[('c', 'd')], namespace='/s')": (
        "p/t",
        ("rosrun", "a", "b", "c:=d", "__name:=n", "__ns:=/s"),
    ),
    "subprocess.Popen(['roslaunch', 'p', 'a.launch', 'x:=1'])": FILE,
    "subprocess.run(args='roslaunch p a.launch x:=1', shell=True)": FILE,
    "subprocess.getoutput('roslaunch p a.launch x:=1')": FILE,
    "os.system(f'roslaunch p {\"a\"}.launch x:={1} &')": FILE,
    "os.spawnlp(os.P_NOWAIT, 'roslaunch', 'roslaunch', 'p', 'a.launch', 'x:=1')": FILE,
    "subprocess.call(['ros2', 'launch', 'p', 'a.launch', 'x:=1'])": FILE,
    "subprocess.call(['ros2', 'run', 'p', 't', 'a'])": ("p/t", ("rosrun", "a")),
}
NOTED = {
    "roslaunch.main(unknown())": "the command is not known",
    "roslaunch.parent.ROSLaunchParent(0, unknown())": "its path is not known",
    "roslaunch.parent.ROSLaunchParent(0, [unknown()])": "its path is not known",
    "roslaunch.parent.ROSLaunchParent(0, [], roslaunch_strs=['<launch/>'])": (
        "what a program launches from a text is not followed"
    ),
    "roslaunch.core.Node(unknown(), 't')": "which program it is is not known",
    "subprocess.Popen(unknown())": "the command is not known",
    "subprocess.Popen(['roslaunch', *unknown()])": "the command is not known",
    "os.system(unknown() + ' a.launch')": "the command is not known",
    "subprocess.Popen(['ros2', 'topic', 'pub', '/x', 'std_msgs/msg/Bool'])": (
        "what this command joins is not followed"
    ),
    "os.system('rosbag record -a')": "what this command joins is not followed",
}
QUIET = ["os.system('ros2 topic list')", "subprocess.run(['ls', unknown()])", "os.system('rosbag')"]


@pytest.mark.parametrize("body", FOLLOWED)
def test_what_is_known_of_a_launch_is_followed(body):
    interface = run_text(HEAD + body)
    assert [(start.path, start.args) for start in interface.runtime_starts] == [FOLLOWED[body]]
    assert interface.unresolved == ()


@pytest.mark.parametrize("body", NOTED)
def test_what_is_not_known_of_a_launch_is_noted_with_its_line(body):
    interface = run_text(HEAD + body)
    assert interface.runtime_starts == ()
    assert [note.why for note in interface.unresolved] == [NOTED[body]]
    assert interface.unresolved[0].evidence[0].line == 2
    is_launch = "ROSLaunchParent" in body
    assert [note.hides for note in interface.unresolved] == ["nodes" if is_launch else None]


def test_the_package_of_a_launch_is_known_though_it_is_not_here():
    path = "rospkg.RosPack().get_path('no') + '/x.launch'"
    body = f"import rospkg\nroslaunch.ROSLaunchParent(0, [{path}])"
    assert [note.package for note in run_text(HEAD + body).unresolved] == ["no"]
    commands = (
        f"os.system('roslaunch {words}')" for words in ("p a.launch", "a.launch", "/a.launch")
    )
    starts = run_text("\n".join((HEAD, *commands))).runtime_starts
    assert [start.unread("/n", "").package for start in starts] == ["p", "", ""]


@pytest.mark.parametrize("body", QUIET)
def test_other_commands_are_none_of_ours(body):
    interface = run_text(HEAD + body)
    assert (interface.runtime_starts, interface.unresolved) == ((), ())


def test_a_process_that_replaces_the_program_ends_it():
    after = "rospy.Publisher('x', rospy.AnyMsg)"
    interface = run_text(f"{HEAD}os.execvp('roslaunch', ['roslaunch', 'p', 'a'])\n{after}\n")
    assert ([start.path for start in interface.runtime_starts], interface.declarations) == (
        ["p/a"],
        (),
    )
    assert [note.evidence[0].line for note in interface.unresolved] == [2]


def test_a_launch_service_is_noted():
    interface = ros2_runs.run_text("import launch\ndef main():\n    launch.LaunchService()\n", "py")
    (note,) = interface.unresolved
    assert note.why.startswith("what a node launches itself is not followed")
    assert note.evidence[0].line == 3
