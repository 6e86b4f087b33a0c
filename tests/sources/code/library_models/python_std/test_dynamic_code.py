"""Code that Python hides: followed where that is plain, else noted with its line; never silent."""

import pytest
from ros1_runs import names, run_text

from rtron.sources.code.program_runner import run_python
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.declaration import NodeSite
from rtron.sources.workspace import Workspace

HEAD = "import rospy\nfrom std_msgs.msg import Bool\n"


def python(body, **site):
    return run_text(HEAD + body, **site)


FOLLOWED = {
    "__import__": "__import__('rospy').Publisher('x', Bool)",
    "import_module": "import importlib\nimportlib.import_module('rospy').Publisher('x', Bool)",
    "import_module of a part": "import importlib\n"
    "importlib.import_module('rospy.topics').Publisher('x', Bool)",
    "globals": "globals()['rospy'].Publisher('x', Bool)",
    "globals in a function": "def f():\n    globals()['rospy'].Publisher('x', Bool)\nf()",
    "vars": "vars(rospy)['Publisher']('x', Bool)",
    "__dict__": "rospy.__dict__['Publisher']('x', Bool)",
    "sorted": "sorted([1], key=lambda one: rospy.Publisher('x', Bool))",
    "sort": "l = [1]\nl.sort(key=lambda one: rospy.Publisher('x', Bool))",
    "max": "max([1], key=lambda one: rospy.Publisher('x', Bool))",
    "filter": "filter(lambda one: rospy.Publisher('x', Bool), [1])",
    "filter of what is not known": "filter(lambda one: rospy.Publisher('x', Bool), unknown())",
    "defaultdict": "import collections\n"
    "collections.defaultdict(lambda: rospy.Publisher('x', Bool))['y']",
}
CODE = "runs code that the source does not show"
MASTER = "registers at the master itself"
NOTED = {
    "exec('P(1)')": CODE,
    "eval('P' + '(1)')": CODE,
    "compile('P(1)', '', 'exec')": CODE,
    "import runpy; runpy.run_path('/x.py')": CODE,
    "import ctypes; ctypes.CDLL('libx.so')": CODE,
    "__import__(unknown())": "which module is not known",
    "import importlib; importlib.import_module(unknown())": "which module is not known",
    "getattr(rospy, unknown())('x', Bool)": "which member is not known",
    "import rospy.topics; rospy.topics.get_topic_manager()": MASTER,
    "import rosgraph; rosgraph.Master('/n').registerPublisher('x', 'y', 'z')": MASTER,
    "import xmlrpclib; xmlrpclib.ServerProxy(1).registerPublisher('n', 'x')": MASTER,
    "from xmlrpc.client import ServerProxy; ServerProxy(1).registerService('x')": MASTER,
    "rospy.init_node('n', argv=['a:=b'])": "is given to init_node: what it remaps is not followed",
    "import os; os.environ.get('T', 'x')": "is not given; `x` counts",
    "import os; os.environ.get('T', '')": "is not given, so it is empty",
    "import os; os.getenv('T')": "is not given",
    "import vendor\nclass A(vendor.Node): pass": "its base class vendor.Node is not in the source: "
    "what that declares is not known",
}
QUIET = [
    "eval('[1, 2]')",
    "getattr(unknown(), unknown())",
    "import rosgraph; rosgraph.Master('/n').getSystemState()",
    "import sys; rospy.init_node('n', argv=sys.argv)",
    "rospy.init_node('n', anonymous=True)",
    "import os; os.environ.get('HOME', 'x')",
    "import threading, smach\nclass A(threading.Thread): pass\nclass B(smach.State): pass",
    "from PyQt5 import QtWidgets\nclass A(QtWidgets.QWidget): pass",
    "class A(Exception): pass",
    "import os; os.system('rostopic list')",
    "import subprocess; subprocess.Popen('link | cut -d \" \" -f 2', shell=True)",
]


@pytest.mark.parametrize("body", FOLLOWED.values(), ids=FOLLOWED)
def test_what_is_plain_is_followed(body):
    interface = python(body)
    assert names(interface) == ["x"]
    assert interface.unresolved == ()


@pytest.mark.parametrize("body", NOTED)
def test_what_is_not_followed_is_noted_with_its_line(body):
    interface = python(body)
    assert names(interface) == []
    assert [note.why for note in interface.unresolved] == [NOTED[body]]
    assert interface.unresolved[0].evidence[0].line == len((HEAD + body).split("\n"))


@pytest.mark.parametrize("body", QUIET)
def test_what_joins_no_nodes_is_not_noted(body):
    interface = python(body, environ=(("HOME", "/h"),), args=("a:=b",))
    assert (interface.declarations, interface.unresolved) == ((), ())


def test_a_variable_that_is_given_counts():
    interface = python(
        "import os\nrospy.Publisher(os.environ.get('T', 'x'), Bool)", environ=(("T", "y"),)
    )
    assert (names(interface), interface.unresolved) == (["y"], ())


COMMANDS = [
    "os.system(\"rostopic pub -r 10 /a std_msgs/Bool '{data: 1}'\")",
    "subprocess.Popen(['rostopic', 'pub', '-r', '10', '/a', 'std_msgs/Bool', '{data: 1}'])",
    "subprocess.call('/opt/ros/noetic/bin/rostopic pub -r 10 /a std_msgs/Bool \"{data: 1}\"')",
]


@pytest.mark.parametrize("command", COMMANDS)
def test_rostopic_is_started_as_a_node(command):
    (started,) = python(f"import os, subprocess\n{command}").runtime_starts
    words = ("pub", "-r", "10", "/a", "std_msgs/Bool", "{data: 1}")
    assert (started.path, started.args[:-1]) == ("rostopic/rostopic", ("rosrun", *words))


def test_rostopic_with_a_topic_that_is_not_known_is_noted():
    interface = python("import os\nos.system('rostopic pub ' + unknown() + ' std_msgs/Bool')")
    assert interface.runtime_starts == ()
    assert [note.why for note in interface.unresolved] == ["the command is not known"]


def beside(tmp_path, module, text, script="import tf\ntf.go()\n"):
    (tmp_path / module).parent.mkdir(exist_ok=True)
    (tmp_path / module).write_text(text)
    (tmp_path / "n.py").write_text(script)
    files = WorkspaceSources(Workspace({"p": tmp_path}, [tmp_path]))
    return names(run_python(tmp_path / "n.py", NodeSite(name="/ns/n"), files))


GO = "import rospy\nfrom std_msgs.msg import Bool\ndef go():\n    rospy.Publisher('x', Bool)\n"


@pytest.mark.parametrize("module", ["tf.py", "tf/__init__.py"])
def test_a_module_beside_the_script_goes_before_a_library(tmp_path, module):
    assert beside(tmp_path, module, GO) == ["x"]


def test_a_module_elsewhere_does_not_go_before_a_library(tmp_path):
    assert beside(tmp_path, "src/tf.py", GO) == []


UNKNOWN_CALLS = {
    "unknown().Publisher('x', Bool)": "what it is called on is not known",
    "from vendor import *\nPublisher('x', Bool)": "what it is called on is not known",
    "import vendor\nvendor.make('x', Bool)": (
        "its code is not here, and it gets a name and a type: it may make an endpoint; "
        "give the source of vendor too"
    ),
    "import smach_ros\nsmach_ros.IntrospectionServer('x', 1, '/')": "what it joins is not known",
    "rospy.Publisher = unknown()": (
        "is replaced by the program: what calls it is not followed there"
    ),
}


@pytest.mark.parametrize("body", UNKNOWN_CALLS)
def test_a_call_of_what_is_not_known_is_noted_with_its_line(body):
    interface = python(body)
    assert [note.why for note in interface.unresolved] == [UNKNOWN_CALLS[body]]
    assert interface.unresolved[0].evidence[0].line == len((HEAD + body).split("\n"))


SMACH = {
    "SimpleActionState('x', Bool)": "action_client",
    "ServiceState('x', Bool)": "service_client",
    "MonitorState('x', Bool, print)": "subscribe",
}


@pytest.mark.parametrize("made", SMACH)
def test_a_state_of_smach_joins_what_its_name_says(made):
    (found,) = python(f"import smach_ros\nsmach_ros.{made}").declarations
    assert (found.kind, found.name) == (SMACH[made], "/ns/x")


def package(tmp_path, text, depends="helper_ros"):
    (tmp_path / "package.xml").write_text(
        f"<package><name>p</name><exec_depend>{depends}</exec_depend></package>"
    )
    (tmp_path / "n.py").write_text(text)
    files = WorkspaceSources(Workspace({"p": tmp_path}, [tmp_path]))
    return run_python(tmp_path / "n.py", NodeSite(name="/ns/n"), files)


def test_a_ros_package_that_is_not_here_is_noted_once(tmp_path):
    found = package(
        tmp_path, "import helper_ros, numpy\nhelper_ros.go()\nhelper_ros.go()\nnumpy.a()"
    )
    (note,) = found.unresolved
    assert (note.what, note.evidence[0].line) == ("package helper_ros", 2)


@pytest.mark.parametrize("depends", ["cv_bridge", "some_msgs", "pygame"])
def test_a_package_that_joins_nothing_is_not_noted(tmp_path, depends):
    text = "import cv_bridge, pygame, some_msgs\npygame.init()\ncv_bridge.CvBridge()\nsome_msgs.a()"
    assert package(tmp_path, text, depends).unresolved == ()


def test_a_module_of_a_package_that_is_here_and_is_not_built_is_noted_as_that(tmp_path):
    found = package(tmp_path, "from p.made import call_pb2\ncall_pb2.Request()")
    missing, called = found.unresolved
    assert missing.what == "import of p.made"
    assert called.what == "package p"
    assert "a module of it that is called is not, which a build may make" in called.why


@pytest.mark.parametrize(
    ("line", "module"),
    [
        ("from p.tools import make", "p.tools"),
        ("from p import tools", "p.tools"),
        ("import p.tools", "p.tools"),
        ("from .tools import make", ".tools"),
        ("from . import tools", ".tools"),
    ],
)
def test_a_module_of_the_workspace_that_is_not_there_is_noted(tmp_path, line, module):
    (note,) = package(tmp_path, f"{line}\nfrom p.msg import A\nfrom p.cfg import B\n").unresolved
    assert (note.what, note.evidence[0].line) == (f"import of {module}", 1)


WRITES = {
    "o.__dict__.update(topic='b')": ["b"],
    "vars(o).update({'topic': 'b'})": ["b"],
    "o.__dict__['topic'] = 'b'": ["b"],
    "for k, v in {'topic': 'b'}.items(): setattr(o, k, v)": ["b"],
    "setattr(o, unknown(), 'b')": ["{topic}"],
    "o.__dict__.update(unknown())": ["{topic}"],
    "o.__dict__[unknown()] = 'b'": ["{topic}"],
    "vars(o).update(**unknown())": ["{topic}"],
}


@pytest.mark.parametrize("write", WRITES)
def test_a_member_that_may_have_been_replaced_is_no_literal(write):
    body = (
        f"class A:\n    topic = 'a'\n    def __init__(self): self.topic = 'a'\no = A()\n{write}\n"
    )
    assert names(python(f"{body}rospy.Publisher(o.topic, Bool)")) == WRITES[write]


VARIABLES = {
    "topic = 'a'\nglobals()['topic'] = 'b'": ["b"],
    "topic = 'a'\nglobals()[unknown()] = 'b'": ["{topic}"],
    "topic = 'a'\nglobals().update(unknown())": ["{topic}"],
    "topic = 'a'\nlocals()['topic'] = 'b'": ["b"],
    "def f(topic='a', **k): return topic\ntopic = f(**unknown())": ["{topic}"],
    "def f(topic='a'): return topic\ntopic = f(*unknown())": ["{topic}"],
    "topic = {'t': 'a', **unknown()}['t']": ["{t}"],
    "d = {'t': 'a'}\nd.update(unknown())\ntopic = d['t']": ["{t}"],
}


@pytest.mark.parametrize("body", VARIABLES)
def test_a_variable_that_may_have_been_replaced_is_no_literal(body):
    assert names(python(f"{body}\nrospy.Publisher(topic, Bool)")) == VARIABLES[body]
