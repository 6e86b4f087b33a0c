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
    "attrgetter": "import operator\noperator.attrgetter('Publisher')(rospy)('x', Bool)",
    "methodcaller": "import operator\noperator.methodcaller('Publisher', 'x', Bool)(rospy)",
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
    "import operator; operator.attrgetter(unknown())(rospy)": "which member is not known",
    "import rospy.topics; rospy.topics.get_topic_manager()": MASTER,
    "import rosgraph; rosgraph.Master('/n').registerPublisher('x', 'y', 'z')": MASTER,
    "import xmlrpclib; xmlrpclib.ServerProxy(1).registerPublisher('n', 'x')": MASTER,
    "from xmlrpc.client import ServerProxy; ServerProxy(1).registerService('x')": MASTER,
    "rospy.init_node('n', argv=['a:=b'])": "is given to init_node: what it remaps is not followed",
    "import os; os.environ.get('T', 'x')": "is not given; `x` counts",
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
