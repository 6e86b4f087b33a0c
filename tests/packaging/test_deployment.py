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

ROOT = Path(__file__).parents[2]
DEPLOY = ROOT / "deploy"
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


def steps(instruction):
    """Return what each step of the image has after this instruction, in one line."""
    text = (DEPLOY / "Containerfile").read_text().replace("\\\n", " ")
    return re.findall(rf"^{instruction} (.*)$", text, re.MULTILINE)


def copied_files():
    copies = [copy.split() for copy in steps("COPY") if not copy.startswith("--from")]
    return [source for *sources, _ in copies for source in sources]


def test_the_image_copies_what_is_there():
    assert {"src", "pyproject.toml", "requirements.lock"} <= set(copied_files())
    assert all((ROOT / source).exists() for source in copied_files())


def test_the_image_has_the_uv_that_is_locked():
    locked = re.search(r"^uv==(\S+)", (ROOT / "requirements.lock").read_text(), re.MULTILINE)
    assert f"--from=ghcr.io/astral-sh/uv:{locked[1]} /uv /usr/local/bin/uv" in steps("COPY")


def test_the_image_installs_the_service_from_what_it_copies(tmp_path):
    """The first step that runs something, in a folder that has nothing but what was copied."""
    folder, home = tmp_path / "src", tmp_path / "rtron"
    folder.mkdir()
    subprocess.run(["cp", "-r", "--parents", *copied_files(), folder], cwd=ROOT, check=True)
    step = steps("RUN")[0].replace("/opt/rtron", str(home)).replace("--no-cache", "")
    step = step.replace("--python python3", f"--python {sys.executable}")
    path = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
    subprocess.run(["sh", "-c", step], cwd=folder, env=os.environ | {"PATH": path}, check=True)
    ran = subprocess.run(
        [home / "bin/rtron", "serve", "--help"],
        env={"PATH": os.environ["PATH"]},
        capture_output=True,
        text=True,
        check=True,
    )
    assert "--database" in ran.stdout
    assert {unit.name for unit in (home / "share/rtron/systemd").iterdir()} >= UNITS.keys()
    assert list(home.glob("lib/python*/site-packages/rtron/cli/__pycache__/*.pyc"))


@pytest.fixture
def enter(tmp_path):
    """Start the entry point with arguments, where `rtron` is another script."""

    def start(script, *arguments, **environment):
        rtron = tmp_path / "rtron"
        rtron.write_text(f"#!/bin/sh\n{script}\n")
        rtron.chmod(0o755)
        return subprocess.Popen(
            [DEPLOY / "container-entrypoint.sh", *arguments],
            env={"PATH": f"{tmp_path}:{os.environ['PATH']}"} | environment,
            stdout=subprocess.PIPE,
            text=True,
        )

    return start


@pytest.mark.parametrize("distro", ["", "jazzy"])
@pytest.mark.parametrize("command", ["guard", "serve"])
def test_the_images_entry_point_runs_rtron_with_its_arguments(command, distro, enter):
    entered = enter('echo "$ROS_DISTRO" "$@"; exit 3', command, "--x", "a b", ROS_DISTRO=distro)
    assert entered.communicate()[0] == f"{distro} {command} --x a b\n"
    assert entered.returncode == 3


def test_in_a_container_a_killed_supervisor_has_a_next_one(enter, tmp_path):
    killed = tmp_path / "killed"
    script = f"[ -e {killed} ] && {{ echo next; exit 0; }}; touch {killed}; kill -9 $$"
    entered = enter(script, "guard")
    assert (entered.communicate()[0], entered.returncode) == ("next\n", 0)


def test_a_container_that_is_stopped_waits_for_the_supervisor_to_end(enter):
    script = "trap 'sleep 0.3; echo ended; exit 143' TERM; echo began; while :; do sleep 0.1; done"
    entered = enter(script, "guard")
    assert entered.stdout.readline() == "began\n"
    entered.terminate()
    assert (entered.communicate()[0], entered.returncode) == ("ended\n", 143)
