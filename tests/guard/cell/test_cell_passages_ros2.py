"""What passes between a cell of ROS 2 and the app is what the manifest lists."""

import re
import subprocess
from pathlib import Path
from tempfile import NamedTemporaryFile

import pytest
from celled_base import needs_cell, needs_open_packages
from harness import wait_for

pytest.importorskip("rclpy", reason="needs ROS 2")
from celled_base2 import NODE, CelledBase2, ros2_in_open_folder, start_cell2

pytestmark = [pytest.mark.ros2, needs_cell, needs_open_packages]
DOCS = Path(__file__).parents[3] / "docs" / "cell.md"
TRIGGER = "std_srvs/Trigger"
FLOAT, STRING = "std_msgs/msg/Float64", "std_msgs/msg/String"
PASSES = {
    "published": [
        {"topic": topic, "type": FLOAT, "publishers": [NODE]} for topic in ("/odom", "/state")
    ],
    "subscribed": [
        {"topic": "/lamp", "type": STRING, "publishers": ["/switch"]},
        {"topic": "/map", "type": STRING, "publishers": ["/mapper"]},
    ],
    "served": [
        {"service": "/reset", "type": "std_srvs/srv/Trigger", "clients": ["/nav"]},
        {
            "service": f"{NODE}/get_parameters",
            "type": "rcl_interfaces/srv/GetParameters",
            "clients": ["/tuner"],
        },
    ],
    "called": [{"service": "/map_of", "type": "std_srvs/srv/Trigger", "clients": [NODE]}],
}
OUTSIDE = {"CYCLONEDDS_URI": "<Elsewhere/>", "ROS_STATIC_PEERS": "127.0.0.1"}


@pytest.fixture(scope="module")
def carried2():
    with ros2_in_open_folder() as ros2:
        parameters = ros2.folder / "launch_params_x"
        parameters.write_text(f"{NODE}:\n  ros__parameters:\n    wheel: 2.5\n")
        parameters.chmod(0o600)
        arguments = ("--params-file", parameters)
        yield CelledBase2(ros2, arguments=arguments, environ=OUTSIDE, **PASSES)


@pytest.fixture(scope="module")
def switch(carried2):
    """The publisher of the lamp, which is empty ten times a second."""
    return carried2.ros2.node("topic_endpoints.py", ">/lamp:std_msgs/String", name="/switch")


def listen(base, end):
    return base.ros2.node("topic_endpoints.py", end, name="/listener")


def numbers(node):
    return [float(each) for each in re.findall(r"data=([\d.]+)", node.log)]


def test_a_topic_of_the_base_comes_out_in_order_and_under_its_name(carried2):
    odom = listen(carried2, "</odom:std_msgs/Float64")
    wait_for(lambda: len(numbers(odom)) > 10, what="odometry")
    found = numbers(odom)
    assert found == [found[0] + n for n in range(len(found))]


def test_a_latched_topic_is_latched_outside(carried2):
    for _ in range(2):
        late = listen(carried2, "</state:std_msgs/Float64@latched")
        wait_for(lambda late=late: numbers(late), what="the state")
        assert numbers(late) == [7.0]


@pytest.mark.long
def test_a_latched_topic_from_outside_is_latched_inside(carried2):
    carried2.ros2.node("latched_string.py", "/map", "house", name="/mapper")
    wait_for(lambda: ("house",) in carried2.said("/map"), what="the map")
    carried2.cell.stop()
    carried2.restart_cell()
    wait_for(lambda: carried2.said("/map").count(("house",)) == 2, what="the map again")


def test_a_topic_that_is_not_listed_stays_inside(carried2):
    unlisted = listen(carried2, "</unlisted:std_msgs/Float64")
    odom = listen(carried2, "</odom:std_msgs/Float64")
    wait_for(lambda: len(numbers(odom)) > 10, what="odometry")
    assert numbers(unlisted) == []


@pytest.mark.usefixtures("switch")
def test_only_the_publisher_of_the_manifest_reaches_the_base(carried2):
    carried2.ros2.node("latched_string.py", "/lamp", "wrong", name="/stranger")
    refused = "/stranger on /lamp is refused"
    wait_for(lambda: refused in carried2.cell.log, what="the refusal")
    wait_for(lambda: carried2.said("/lamp"), what="the lamp")
    assert ("wrong",) not in carried2.said("/lamp")


@pytest.mark.usefixtures("switch")
def test_a_topic_that_is_not_listed_does_not_come_in(carried2):
    carried2.ros2.node("latched_string.py", "/unlisted_in", "wrong", name="/mapper2")
    before = len(carried2.said("/lamp"))
    wait_for(lambda: len(carried2.said("/lamp")) > before + 10, what="the lamp")
    assert carried2.said("/unlisted_in") == []


def test_what_leads_dds_elsewhere_stays_outside(carried2):
    (names,) = {*carried2.said("environ")}
    assert set(names) == {"FASTDDS_BUILTIN_TRANSPORTS=UDPv4", "SKIP_DEFAULT_XML=1"}


def test_the_base_reads_a_parameter_file_that_only_root_may_read(carried2):
    wait_for(lambda: carried2.said("wheel"), what="the parameter")
    assert set(carried2.said("wheel")) == {("2.5",)}


def test_what_is_refused_stands_in_the_diagnostics(carried2):
    echo = listen(carried2, "</diagnostics:diagnostic_msgs/DiagnosticArray")
    carried2.ros2.node("latched_string.py", "/lamp", "wrong", name="/stranger2")
    wait_for(lambda: "/stranger2 on /lamp" in echo.log, what="the diagnostics")


def test_a_service_of_the_base_is_called_by_its_client_and_nobody_else(carried2):
    stranger = carried2.ros2.node("service_client.py", TRIGGER, "/reset", name="/stranger")
    refused = "/stranger to /reset is refused"
    wait_for(lambda: refused in carried2.cell.log, what="the refusal")
    client = carried2.ros2.node("service_client.py", TRIGGER, "/reset", name="/nav")
    wait_for(lambda: "answer" in client.log, what="the answer")
    assert "was reset" in client.log
    assert "answer" not in stranger.log
    assert carried2.said("reset") == [()]


def test_the_base_calls_a_service_outside_once_it_is_there(carried2):
    assert carried2.said("map") == []
    carried2.ros2.node("node_group.py", "/maps", "+/map_of")
    wait_for(lambda: carried2.said("map") == [()], what="the map")


def test_a_parameter_of_the_base_is_read_by_a_service_of_the_manifest(carried2):
    words = ("rcl_interfaces/GetParameters", f"{NODE}/get_parameters", "names=wheel")
    client = carried2.ros2.node("service_client.py", *words, name="/tuner")
    wait_for(lambda: "double_value=2.5" in client.log, what="the parameter")


@pytest.mark.parametrize(
    ("manifest", "why"),
    [
        ({"served": [{"service": "/reset"}]}, "does not give the type of /reset"),
        ({"parameters": [NODE]}, "there are no shared parameters in ROS 2"),
    ],
)
def test_a_cell_of_ros2_refuses_what_it_cannot_carry(manifest, why):
    with ros2_in_open_folder() as ros2:
        cell = start_cell2(ros2, **manifest)
        wait_for(lambda: cell.ended, what="the end of the cell")
        assert cell.code == 2
        assert why in cell.log


def test_by_the_script_of_the_docs_another_user_reads_what_launch_writes(tmp_path):
    shown = DOCS.read_text(encoding="utf-8").partition("#!/bin/sh\nfor word do\n  case")[2]
    script = "#!/bin/sh\nfor word do\n  case" + shown.partition("```")[0]
    assert "--reuid robot --regid robot --init-groups" in script
    script = script.replace("--init-groups", "--clear-groups").replace(" robot", " 4324")
    path = tmp_path / "as-robot"
    path.write_text(script)
    path.chmod(0o755)
    with NamedTemporaryFile("w", prefix="launch_params_", dir="/tmp") as file:
        file.write("wheel: 2.5")
        file.flush()
        words = ("sh", "-c", 'id -u && cat "$1"', "sh", file.name)
        ran = subprocess.run([path, *words], capture_output=True, text=True, check=False)
    assert ran.stdout == "4324\nwheel: 2.5", ran.stderr


@pytest.mark.parametrize(
    ("environ", "why"),
    [
        ({"RMW_IMPLEMENTATION": "rmw_zenoh_cpp"}, "rmw_zenoh_cpp does not work in a cell"),
        ({"ROS_SECURITY_ENABLE": "true"}, "SROS2 and a cell do not work together"),
    ],
)
def test_a_middleware_that_cannot_be_carried_is_refused(environ, why):
    with ros2_in_open_folder() as ros2:
        cell = start_cell2(ros2, environ=environ)
        wait_for(lambda: cell.ended, what="the end of the cell")
        assert cell.code == 2
        assert why in cell.log
