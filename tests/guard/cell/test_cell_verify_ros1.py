"""`rtron verify` looks into the cell, and tries to get in from outside."""

import json
import subprocess

import pytest
from celled_base import NODE, CelledBase, needs_cell, ros1_in_open_folder
from harness import wait_for

pytestmark = [pytest.mark.ros1, needs_cell]


def verified(base):
    words = ("--plan", base.ros1.folder / "rtron.yaml")
    ended = base.ros1.rtron(
        "verify", "--live", *words, "--absent", "/rogue", "--format", "json", "--timeout", "5"
    )
    wait_for(lambda: ended.ended, what="the verification")
    return json.loads(ended.log)


def path_of(report, node):
    (path,) = [each for each in report["paths"] if each["node"] == node]
    return path


def test_a_cell_is_closed_and_its_publishers_own_end_is_told(moving_base):
    stranger = subprocess.Popen(["setpriv", "--reuid=4711", "--clear-groups", "sleep", "60"])
    try:
        report = verified(moving_base)
    finally:
        stranger.kill()
        stranger.wait()
    assert path_of(report, NODE)["state"] == "closed"
    assert report["problems"] == []
    assert "/nav" in [each["what"] for each in report["unguarded"]]


@pytest.mark.long
def test_what_the_user_lets_open_is_told(driver):
    with ros1_in_open_folder() as ros1:
        base = CelledBase(ros1, driver, "--allow-shared-user", "--allow-shared-memory")
        base.navigate()
        report = verified(base)
    told = [each["why"] for each in report["unguarded"]]
    assert any("/dev/shm is shared" in each for each in told)
    assert any("the user is shared" in each for each in told)


@pytest.mark.long
def test_a_node_without_its_cell_is_not_closed(open_ros1, driver):
    base = CelledBase(open_ros1, driver)
    base.navigate()
    base.cell.kill()
    assert path_of(verified(base), NODE)["state"] == "unknown"
