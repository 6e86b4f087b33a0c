"""A cell of an ordinary user: none without the flag, and one that its user can enter with it."""

import os
import subprocess
import sys
from pathlib import Path

import h11
import pytest
from celled_base import NODE, celled_plan, needs_open_packages, open_folder
from harness import ROS_PYTHON, SOURCE

from rtron.planning.plan_file.writer import write_plan

USER = "4321"
AS_USER = ["setpriv", f"--reuid={USER}", f"--regid={USER}", "--clear-groups"]
NAMESPACES = ["unshare", "--user", "--map-root-user", "--net", "--mount", "--fork", "true"]
HAS_NAMESPACES = (
    os.getuid() == 0
    and subprocess.run([*AS_USER, *NAMESPACES], check=False, capture_output=True).returncode == 0
)
pytestmark = [
    pytest.mark.ros1,
    pytest.mark.skipif(
        not HAS_NAMESPACES, reason="it changes the user, who must be allowed user namespaces"
    ),
]
SCRIPT = "echo begun; ls -A /dev/shm; cat /proc/net/dev; exit 3"


def run_as(user, *command, folder):
    """Run a command as a user who has no more than a folder for the runtime."""
    packages = Path(h11.__file__).parents[1]
    runtime = folder / f"run{user}"
    if not runtime.exists():
        runtime.mkdir(mode=0o700)
        os.chown(runtime, int(user), int(user))
    environ = {
        "PATH": os.environ["PATH"],
        "PYTHONPATH": f"{SOURCE}:{packages}",
        "XDG_RUNTIME_DIR": str(runtime),
        "ROS_MASTER_URI": "http://localhost:1",
        "HOME": str(runtime),
    }
    switch = ["setpriv", f"--reuid={user}", f"--regid={user}", "--clear-groups"]
    return subprocess.run(
        [*switch, *map(str, command)],
        env=environ,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )


@pytest.fixture
def folder():
    version = f"{sys.version_info.major}.{sys.version_info.minor}"
    shown = subprocess.run([ROS_PYTHON, "--version"], capture_output=True, text=True, check=True)
    if version not in shown.stdout:
        pytest.skip(f"{ROS_PYTHON} cannot use the packages of Python {version}")
    with open_folder() as folder:
        (folder / "rtron.yaml").write_text(write_plan(celled_plan()))
        (folder / "cell.json").write_text(f'{{"schema": "rtron.cell/1", "node": "{NODE}"}}')
        yield folder


def cell(folder, *options):
    files = ("--plan", folder / "rtron.yaml", "--manifest", folder / "cell.json")
    command = (ROS_PYTHON, "-m", "rtron", "cell", *files, *options, "--", "sh", "-c", SCRIPT)
    return run_as(USER, *command, folder=folder)


@needs_open_packages
def test_an_ordinary_user_is_told_why_there_is_no_cell(folder):
    ended = cell(folder)
    assert ended.returncode == 2
    assert "--allow-shared-user" in ended.stderr
    assert "begun" not in ended.stdout


@pytest.mark.long
def test_with_the_flag_the_cell_has_a_network_and_shared_memory_of_its_own(folder):
    ended = cell(folder, "--allow-shared-user")
    assert ended.returncode == 3, ended.stderr
    assert "the user is shared" in ended.stderr
    shared_memory, _, devices = ended.stdout.partition("Inter-|")
    assert [line.partition(":")[0].strip() for line in devices.splitlines()[2:]] == ["lo"]
    assert all(name.startswith("rtron-") for name in shared_memory.split()[1:])
