"""Which ROS `--live` reads: as told, as sourced, or the only one that is there."""

import sys
from types import ModuleType
from xmlrpc.client import dumps

import pytest
from faulty_nodes import garbage, saying, stranger
from harness import free_port

from rtron.sources.graph_json import read_graph
from rtron.workflows import live_app

HERE = "http://localhost:11311"
PID = saying(dumps(((1, "", 5),), methodresponse=True).encode())


@pytest.fixture
def opened_sources(monkeypatch, graph_file):
    """Take the place of both sources, and tell what they were made with."""
    made = []

    class Source:
        domain_description = "ROS 2 domain x"

        def __init__(self, *arguments):
            made.append((type(self).__name__, *arguments))

        def read(self):
            return read_graph(graph_file)

    places = {
        "Ros1LiveSource": "rtron.sources.live.ros1.source",
        "Ros2LiveSource": "rtron.sources.live.ros2.source",
    }
    for name, place in places.items():
        module = ModuleType(place)
        setattr(module, name, type(name, (Source,), {}))
        monkeypatch.setitem(sys.modules, place, module)
    for name in ("ROS_VERSION", "ROS_DOMAIN_ID"):
        monkeypatch.delenv(name, raising=False)
    return made


@pytest.fixture
def rclpy(monkeypatch):
    """Say whether rclpy is installed."""

    def there(*, installed):
        monkeypatch.setattr(live_app, "find_spec", lambda name: object() if installed else None)

    return there


def unused_master_uri():
    return f"http://localhost:{free_port()}"


@pytest.mark.parametrize(
    ("words", "environ", "source"),
    [
        (["--ros", "1"], {}, ("Ros1LiveSource", HERE, 5.0)),
        (["--ros", "1", "--domain", "3"], {}, ("Ros1LiveSource", HERE, 5.0)),
        (["--ros", "2"], {}, ("Ros2LiveSource", None, 15.0)),
        (["--ros", "2", "--timeout", "3"], {}, ("Ros2LiveSource", None, 3.0)),
        (["--ros", "2"], {"ROS_VERSION": "1"}, ("Ros2LiveSource", None, 15.0)),
        (["--domain", "232"], {"ROS_VERSION": "1"}, ("Ros2LiveSource", 232, 15.0)),
        (["--master", "http://a:1"], {"ROS_VERSION": "2"}, ("Ros1LiveSource", "http://a:1", 5.0)),
        ([], {"ROS_VERSION": "1"}, ("Ros1LiveSource", HERE, 5.0)),
        ([], {"ROS_VERSION": "2", "ROS_DOMAIN_ID": "9"}, ("Ros2LiveSource", None, 15.0)),
        ([], {"ROS_VERSION": "1", "ROS_DOMAIN_ID": "x"}, ("Ros1LiveSource", HERE, 5.0)),
    ],
)
@pytest.mark.parametrize("command", ["scan", "plan"])
def test_what_is_told_counts(rtron, opened_sources, monkeypatch, command, words, environ, source):
    for name, value in environ.items():
        monkeypatch.setenv(name, value)
    assert rtron(command, "--live", *words).err == ""
    assert opened_sources == [source]


@pytest.mark.parametrize("version", ["", "3", "noetic"])
def test_else_what_is_there(rtron, opened_sources, rclpy, monkeypatch, version):
    monkeypatch.setenv("ROS_VERSION", version)
    rclpy(installed=False)
    with stranger(PID) as master:
        monkeypatch.setenv("ROS_MASTER_URI", master)
        rtron("scan", "--live")
    rclpy(installed=True)
    monkeypatch.setenv("ROS_MASTER_URI", unused_master_uri())
    rtron("scan", "--live")
    with stranger(garbage) as master:
        monkeypatch.setenv("ROS_MASTER_URI", master)
        rtron("scan", "--live")
    assert [made[0] for made in opened_sources] == [
        "Ros1LiveSource",
        "Ros2LiveSource",
        "Ros2LiveSource",
    ]


def test_both_or_none_is_an_error_that_says_what_to_do(rtron, opened_sources, rclpy, monkeypatch):
    rclpy(installed=True)
    with stranger(PID) as master:
        monkeypatch.setenv("ROS_MASTER_URI", master)
        ran = rtron("scan", "--live")
    assert ran.code == 2
    assert f"a master answers at {master}, and ROS 2 is here, too" in ran.err
    assert "--ros 1 or --ros 2" in ran.err
    rclpy(installed=False)
    monkeypatch.setenv("ROS_MASTER_URI", unused_master_uri())
    ran = rtron("plan", "--live")
    assert ran.code == 2
    assert "no ROS 2 is installed" in ran.err
    assert "--master" in ran.err
    assert "rtron[ros2]" in ran.err
    assert opened_sources == []


def test_a_master_and_a_domain_are_not_one_app(rtron, opened_sources):
    ran = rtron("scan", "--live", "--master", "http://a:1", "--domain", "1")
    assert (ran.code, opened_sources) == (2, [])
    assert "both --master and --domain" in ran.err


@pytest.mark.parametrize("domain", ["233", "-1", "x"])
def test_a_domain_that_is_none_is_bad_input(rtron, opened_sources, domain):
    assert rtron("scan", "--live", "--domain", domain).code == 2
    assert opened_sources == []


def test_without_rclpy_there_is_help(rtron, monkeypatch):
    monkeypatch.setitem(sys.modules, "rtron.sources.live.ros2.source", None)
    ran = rtron("scan", "--live", "--ros", "2")
    assert ran.code == 2
    assert "ROS 2 is not there" in ran.err
    assert "pip install 'rtron[ros2]'" in ran.err


def test_the_next_step_leads_to_the_same_app(rtron, opened_sources):
    ran = rtron("scan", "--live", "--ros", "2", "--domain", "4")
    assert "the app running in ROS 2 domain x" in ran.out
    assert "rtron plan --live --ros 2 --domain 4 -o rtron.yaml" in ran.out


def test_verify_refuses_another_ros_than_the_plans(rtron, plan_file):
    ran = rtron("verify", "--live", "--ros", "2", "--plan", plan_file)
    assert (ran.code, ran.out) == (2, "")
    assert "says `ros: 1`, not 2" in ran.err
