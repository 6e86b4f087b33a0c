"""`rtron master` where it cannot start: it says why, and nothing is left behind."""

import os
import subprocess
import sys

import pytest
from plans import grcn, plan_of

from rtron.planning.plan_file.writer import write_plan

PLAN = plan_of(grcn("/cmd_vel", ["/nav"], ["/driver"]))


@pytest.fixture
def plan(tmp_path):
    path = tmp_path / "rtron.yaml"
    path.write_text(write_plan(PLAN))
    return path


def master(*words, **environ):
    """Run `rtron master` to its end; it must not be one that starts."""
    kept = {name: text for name, text in os.environ.items() if not name.startswith("ROS_")}
    ran = subprocess.run(
        [sys.executable, "-m", "rtron", "master", *map(str, words)],
        env=kept | environ,
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert "Traceback" not in ran.stderr
    return ran.returncode, ran.stderr


def test_a_plan_that_cannot_be_read(plan):
    plan.write_text("schema: rtron.plan/1\napp: x\nros: 1\nwrong: 1\n")
    code, said = master("--plan", plan)
    assert code == 2
    assert f"{plan}:4" in said
    assert master("--plan", plan.with_name("none.yaml"))[0] == 2


def test_ros_2_has_no_master(plan):
    plan.write_text(plan.read_text().replace("app: app\n", "app: app\nros: 2\n"))
    assert master("--plan", plan) == (
        2,
        "error: only ROS 1 has a master\nhelp: the plan says `ros: 2`\n",
    )


def test_no_rosmaster(plan):
    code, said = master("--plan", plan, PATH="/nowhere")
    assert code == 2
    assert "rosmaster is not installed" in said


@pytest.mark.parametrize("uri", ["nonsense", "http://localhost", "http://localhost:99999"])
def test_a_master_uri_without_a_port(plan, uri):
    code, said = master("--plan", plan, ROS_MASTER_URI=uri)
    assert code == 2
    assert "ROS_MASTER_URI" in said


def test_a_rosmaster_that_ends_at_once(plan, tmp_path):
    program = tmp_path / "rosmaster"
    program.write_text("#!/bin/sh\nexit 7\n")
    program.chmod(0o755)
    code, said = master("--plan", plan, PATH=f"{tmp_path}:{os.environ['PATH']}")
    assert code == 2
    assert "rosmaster ended with code 7" in said
