"""systemd's units and the image: what of them can be checked without a robot."""

import configparser
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from rtron.guard.supervision.supervisor_fsm import END_TIMEOUT
from rtron.vocabulary import SECOND, Supervision

DEPLOY = Path(__file__).parents[2] / "deploy"
UNITS = {"rtron-guard@.service": "rtron-guard@car.service", "rtron.service": "rtron.service"}
PROGRAM = "/opt/rtron/bin/rtron"
RTRON = f"{sys.executable} -m rtron"
MAX_EXPOSURE = 20
"""Ten times systemd's figure from 0 to 10."""

systemd_analyze = pytest.mark.skipif(
    shutil.which("systemd-analyze") is None, reason="needs systemd-analyze (Debian's systemd)"
)


def read_unit(name):
    unit = configparser.ConfigParser(strict=False, interpolation=None)
    unit.optionxform = str
    unit.read_string((DEPLOY / "systemd" / name).read_text())
    return unit


def analyze(*arguments):
    command = ["systemd-analyze", *map(str, arguments)]
    return subprocess.run(
        command, capture_output=True, text=True, check=False, env=os.environ | {"LANG": "C.UTF-8"}
    )


@pytest.fixture(params=UNITS)
def unit(request, tmp_path):
    """Return a unit as it is installed; its program is there on every machine."""
    text = (DEPLOY / "systemd" / request.param).read_text()
    path = tmp_path / UNITS[request.param]
    path.write_text(text.replace(PROGRAM, "/bin/true"))
    return path


@systemd_analyze
def test_systemd_understands_every_line(unit):
    verified = analyze("verify", "--man=no", "--recursive-errors=no", unit)
    assert (verified.returncode, verified.stderr) == (0, "")


@systemd_analyze
def test_a_unit_exposes_little(unit):
    looked_at = analyze("security", "--offline=true", f"--threshold={MAX_EXPOSURE}", unit)
    assert "Overall exposure level" in looked_at.stdout
    assert looked_at.returncode == 0, looked_at.stdout.splitlines()[-1]


@pytest.mark.parametrize("name", UNITS)
def test_systemd_waits_for_readiness_and_watches(name):
    service = read_unit(name)["Service"]
    assert service["Type"] == "notify"
    assert int(service["WatchdogSec"]) > 0


def test_the_times_of_the_guards_unit_fit_the_supervisor():
    service = read_unit("rtron-guard@.service")["Service"]
    longest_pause = 10 * SECOND
    assert int(service["WatchdogSec"]) * SECOND > Supervision().start_within + longest_pause
    assert int(service["TimeoutStopSec"]) * SECOND > END_TIMEOUT
    assert service["KillMode"] == "process"


def test_the_guards_command_sources_ros_and_reads_the_plan_of_the_instance(tmp_path):
    setup = tmp_path / "setup.bash"
    setup.write_text("echo sourced")
    command = read_unit("rtron-guard@.service")["Service"]["ExecStart"]
    words = shlex.split(command.replace("%i", "no-such-robot").replace(PROGRAM, RTRON))
    environment = os.environ | {"ROS_SETUP": str(setup)}
    ran = subprocess.run(words, env=environment, capture_output=True, text=True, check=False)
    assert (ran.returncode, ran.stdout) == (2, "sourced\n")
    assert "/etc/rtron/no-such-robot.yaml" in ran.stderr


def test_the_image_copies_what_is_there():
    text = (DEPLOY / "Containerfile").read_text()
    sources = [
        word
        for words in re.findall(r"^COPY (?!--from)(.*) \S+$", text, re.MULTILINE)
        for word in words.split()
    ]
    assert {"src", "pyproject.toml", "requirements.lock"} <= set(sources)
    assert all((DEPLOY.parent / source).exists() for source in sources)


@pytest.mark.parametrize("distro", ["", "jazzy"])
def test_the_images_entry_point_runs_rtron_with_its_arguments(distro, tmp_path):
    rtron = tmp_path / "rtron"
    rtron.write_text('#!/bin/sh\necho "$ROS_DISTRO" "$@"\n')
    rtron.chmod(0o755)
    environment = {"PATH": f"{tmp_path}:{os.environ['PATH']}", "ROS_DISTRO": distro}
    command = [DEPLOY / "container-entrypoint.sh", "guard", "--plan", "a b.yaml"]
    ran = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert ran.stdout == f"{distro} guard --plan a b.yaml\n"
