"""Fixtures that tests of every folder use."""

import shutil
import signal
from contextlib import ExitStack, closing
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from compiler import compiled
from harness import Ros1
from ros2_harness import Ros2
from roslaunch_oracle import RosLoader

_HEARD = {signal.SIGINT: signal.default_int_handler, signal.SIGHUP: signal.SIG_DFL}


@pytest.fixture(scope="session", autouse=True)
def interrupts():
    """Let processes hear what a shell that runs the tests with `&`, or nohup, has ignored."""
    for number, handler in _HEARD.items():
        if signal.getsignal(number) is signal.SIG_IGN:
            signal.signal(number, handler)


def _runtime_folder():
    with TemporaryDirectory(prefix="rtron-") as folder, pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_RUNTIME_DIR", folder)
        patch.setenv("XDG_STATE_HOME", f"{folder}/state")
        yield


@pytest.fixture(scope="session", autouse=True)
def runtime_folder():
    """Let guards listen where those of other runs, and of the machine's robots, do not."""
    yield from _runtime_folder()


@pytest.fixture(scope="session")
def programs_folder(tmp_path_factory):
    """Return the folder in which all processes of this run find what one has compiled."""
    return tmp_path_factory.getbasetemp()


@pytest.fixture(scope="session")
def driver(programs_folder):
    """Compile a wheel driver against roscpp."""
    return compiled(programs_folder, "driver", "roscpp")


@pytest.fixture(scope="session")
def migrated_file(tmp_path_factory):
    """Make a service's database file for tests to copy, which takes less than to make each."""
    from rtron.service.server.database_setup import open_database  # noqa: PLC0415 - few need it

    path = tmp_path_factory.mktemp("migrated") / "rtron.db"
    open_database(path).close()
    return path


@pytest.fixture
def database_file(tmp_path, migrated_file):
    """Give a new file of a service's database that has its tables."""
    return Path(shutil.copy(migrated_file, tmp_path))


@pytest.fixture
def deep_folder(tmp_path):
    """Return what makes 1,200 folders in each other: deeper than Python calls, or removes."""
    made = []

    def dig(top):
        made.extend(top.joinpath(*["d"] * depth) for depth in range(1, 1201))
        for folder in made:
            folder.mkdir()

    yield dig
    for folder in reversed(made):
        folder.rmdir()


@pytest.fixture
def own_runtime_folder():
    """Let guards of a test find nothing that those of other tests have left."""
    yield from _runtime_folder()


@pytest.fixture
def ros1(tmp_path, own_runtime_folder):
    """Run a master of the test's own."""
    with Ros1(tmp_path) as running:
        yield running


@pytest.fixture
def ros2(tmp_path, own_runtime_folder):
    """Have a domain of the test's own."""
    with Ros2(tmp_path) as running:
        yield running


@pytest.fixture(scope="module")
def ros():
    """Run ROS's own loader of launch files."""
    with RosLoader() as loader:
        yield loader


@pytest.fixture
def stand(ros2, monkeypatch):
    """Give places in the test's domain, each a participant of its own."""
    from rclpy_nodes import RclpyParticipant  # noqa: PLC0415 - it needs rclpy

    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    with ExitStack() as stack:
        yield lambda: stack.enter_context(closing(RclpyParticipant(ros2.domain)))
