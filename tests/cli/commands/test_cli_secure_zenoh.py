"""`rtron secure --zenoh`, from graph and plan to sessions that the router lets in."""

import json
import socket

import pytest

zenoh = pytest.importorskip("zenoh", reason="needs eclipse-zenoh (extra `dev`)")

from rmw_zenoh_keys import data_key  # noqa: E402
from zenoh_robot import ROBOT, until  # noqa: E402

from rtron.sources.graph_json import graph_to_json  # noqa: E402

PLAN = """\
ros: 2
grcn:
  - topic: /cmd_vel
    mode: enforce
    policy: Block
    flows: [{name: nav, publisher: /nav}]
    successors: [/base]
"""
OUTPUT = data_key(0, "/rtron/cmd_vel/out")


@pytest.fixture
def secure(rtron, tmp_path, monkeypatch):
    """Run `rtron secure --zenoh` in a folder with a plan and a graph."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("ROS_DOMAIN_ID", raising=False)
    (tmp_path / "rtron.yaml").write_text(PLAN)
    (tmp_path / "graph.json").write_text(json.dumps(graph_to_json(ROBOT)))

    def run(*words):
        return rtron("secure", "rtron.yaml", "--graph", "graph.json", "-o", "keystore", *words)

    return run


def test_it_is_told_before_and_written_once(secure, tmp_path):
    looked = secure("--zenoh", "--diff")
    assert (looked.code, looked.err) == (1, "")
    assert "restart it" in " ".join(looked.out.split())
    assert not (tmp_path / "keystore").exists()
    assert secure("--zenoh").code == 0
    again = secure("--zenoh", "--diff")
    assert (again.code, "Zenoh" in again.out) == (0, False)
    moved = secure("--zenoh", "--diff", "--router", "robot.local", "--format", "json")
    told = json.loads(moved.out)["zenoh"]
    assert moved.code == 1
    assert told["certificate"] == ["is not for robot.local"]
    assert told["settings"] == ["listen"]
    assert (told["added"], told["removed"]) == ({}, {})


def test_without_the_option_there_is_nothing_of_zenoh(secure, tmp_path):
    ran = secure("--format", "json")
    assert "zenoh" not in json.loads(ran.out)
    assert not list((tmp_path / "keystore").rglob("*zenoh*"))


def test_a_revoked_certificate_is_told_to_be_open_still(secure):
    secure("--zenoh")
    ran = secure("--zenoh", "--revoke", "/nav")
    assert ran.code == 0
    assert "Zenoh knows no revocation" in " ".join(ran.out.split())


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--router", "localhost:7447#iface=lo"), "is no host"),
        (("--router", "localhost:99999"), "is no port"),
        (("--interface", "lo wlan0"), "no network interface"),
    ],
)
def test_bad_input_is_refused_before_anything_is_written(secure, tmp_path, words, message):
    ran = secure("--zenoh", *words)
    assert ran.code == 2
    assert message in ran.err
    assert not (tmp_path / "keystore").exists()


class Opened:
    """The router and three processes, with the files that `rtron secure` has written."""

    def __init__(self, keystore):
        self._sessions = []
        self.router = self._open(keystore / "zenoh/router.json5")
        self.guard, self.nav, self.base = (
            self._open(keystore / f"enclaves/{name}/zenoh.json5")
            for name in ("rtron_guard", "nav", "base")
        )

    def _open(self, path):
        self._sessions.append(zenoh.open(zenoh.Config.from_file(str(path))))
        return self._sessions[-1]

    def close(self):
        for session in reversed(self._sessions):
            session.close()

    def base_hears(self, key, true, false):
        """Return what the base hears of one that may publish a key, and one that may not."""
        heard = []
        self.base.declare_subscriber(key, lambda sample: heard.append(bytes(sample.payload)))
        output = true.declare_publisher(key)
        until(lambda: output.matching_status.matching, "the base's subscription")
        false.put(key, b"bad")
        zid = str(false.zid())
        false.close()
        until(lambda: zid not in self._connected(), "the end of the intruder's session")
        output.put(b"good")
        until(lambda: heard, "the message")
        return heard

    def _connected(self):
        return {str(transport.zid) for transport in self.router.info.transports()}


@pytest.fixture
def opened(secure, tmp_path):
    """Return a function that writes the files and opens sessions with them."""
    with socket.socket() as listener:
        listener.bind(("localhost", 0))
        address = f"localhost:{listener.getsockname()[1]}"
    robots = []

    def open_robot():
        ran = secure("--zenoh", "--router", address, "--interface", "lo")
        assert ran.code == 0
        robots.append(Opened(tmp_path / "keystore"))
        return robots[-1], ran.out

    yield open_robot
    for robot in robots:
        robot.close()


def test_the_guard_alone_moves_the_base(opened):
    robot, told = opened()
    assert robot.base_hears(OUTPUT, robot.guard, robot.nav) == [b"good"]
    assert "does not run on rmw_zenoh" in " ".join(told.split())


def test_where_the_plan_only_observes_the_planned_publisher_alone_moves_the_base(opened, tmp_path):
    (tmp_path / "rtron.yaml").write_text(PLAN.replace("enforce", "observe"))
    robot, told = opened()
    assert robot.base_hears(data_key(0, "/cmd_vel"), robot.nav, robot.guard) == [b"good"]
    assert "does not run" not in told
