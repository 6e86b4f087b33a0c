"""`rtron verify --live` on a real app: closed, open, drifted, and when it cannot be told."""

import json
from dataclasses import replace

import pytest
from audit_scene import OUT, Scene
from driven_base import CMD_VEL_GUARD, Driven, drive_plan
from harness import NODES, ROS_PYTHON, wait_for

from bench.ros1.intruder import Intruder
from rtron.vocabulary import Audit, OnForeign
from rtron.vocabulary.names import BULK_NODE

pytestmark = pytest.mark.ros1
OFF = ("--absent", "/nav", "--absent", "/rogue")
ALARM = replace(drive_plan(), audit=Audit(on_foreign=OnForeign.ALARM))


@pytest.fixture
def scene(ros1):
    with Scene(ros1, "driver.py", ALARM) as made:
        yield made


def verified(ros1, code, *more):
    """Verify; return the document, or what was said where there is none."""
    plan = ros1.folder / "rtron.yaml"
    words = ("verify", "--live", "--plan", plan, "--timeout", "20", *more)
    process = ros1.rtron(*words)
    wait_for(lambda: process.ended, what="the end of verify")
    assert process.code == code, process.log
    return json.loads(process.log) if process.log.startswith("{") else process.log


def states(report):
    return {path["node"]: path["state"] for path in report["paths"]}


def test_a_closed_app_is_0(ros1, scene):
    found = verified(ros1, 0, *OFF, "--format", "json")
    assert (found["verdict"], found["problems"]) == ("closed", [])
    assert states(found) == {"/driver": "closed", "/nav": "absent", "/rogue": "absent"}
    said = verified(ros1, 0, *OFF)
    assert "closed" in said.splitlines()[0]
    scene.navigate()
    wait_for(scene.driven.navigation, what="what navigation sends to the driver")
    found = verified(ros1, 0, *OFF, "--format", "json")
    assert states(found) == {"/driver": "closed", "/nav": "closed", "/rogue": "absent"}


@pytest.mark.long
def test_what_does_not_run_is_not_closed(ros1):
    with Scene(ros1, "driver.py", ALARM, drives=False):
        found = verified(ros1, 2, "--format", "json")
        assert (found["verdict"], found["problems"]) == ("unknown", [])
        assert sorted(found["not_seen"]) == ["/driver", "/nav", "/rogue"]
        said = verified(ros1, 2, *OFF)
        assert "unknown" in said.splitlines()[0]
        assert "not seen: /driver;" in said
        assert "the plan has no node /nva" in verified(ros1, 2, "--absent", "/nva")


@pytest.mark.long
def test_what_a_new_master_does_not_list_is_not_closed(ros1, scene):
    """No client library registers again; the guard does, and knows whom it is connected to."""
    ros1.master.kill()
    ros1.start_master()
    for node in (CMD_VEL_GUARD, BULK_NODE):
        wait_for(lambda node=node: ros1.uri_of(node), what=f"{node} at the new master")
    found = verified(ros1, 2, *OFF, "--format", "json")
    (path,) = (path for path in found["paths"] if path["node"] == "/driver")
    assert path["state"] == "unknown"
    assert "the master does not list it" in path["reason"]


def test_a_ghost_is_1_and_named(ros1, scene):
    with Intruder("/ghost", OUT) as ghost:
        ghost.announce_to(scene.driver_uri(), ros1.uri_of(CMD_VEL_GUARD))
        wait_for(lambda: ghost.first_connection, what="the ghost's connection")
        found = verified(ros1, 1, "--format", "json")
    (path,) = (path for path in found["paths"] if path["node"] == "/driver")
    assert (path["state"], path["foreign"]) == ("open", [ghost.uri.rstrip("/")])


def test_missing_remaps_are_1(ros1, scene):
    driven = Driven(ros1.folder / "other.txt")
    scene.driver.stop()
    ros1.spawn(ROS_PYTHON, NODES / "driver.py", driven.path, "__name:=driver")
    ros1.node("nav.py", "/nav")
    wait_for(driven.navigation, what="what navigation sends to the driver")
    found = verified(ros1, 1, "--format", "json")
    assert states(found) | {"/rogue": ""} == {"/driver": "open", "/nav": "drift", "/rogue": ""}
    wait_for(lambda: len(scene.alarms("alarm: drift")) == 2, what="the guard's own alarms")


@pytest.mark.long
def test_a_dead_guard_is_1(ros1, scene):
    scene.guard.stop()
    found = verified(ros1, 1, "--format", "json")
    assert any("is not running" in problem for problem in found["problems"])


@pytest.mark.long
def test_it_cannot_be_told_without_a_master_or_a_plan(ros1, scene):
    ros1.master.kill()
    assert "nothing can be verified" in verified(ros1, 2)
    (ros1.folder / "rtron.yaml").write_text("grcn: 7")
    assert "rtron.yaml" in verified(ros1, 2)
