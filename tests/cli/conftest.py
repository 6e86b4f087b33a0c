import json
import sys
from dataclasses import dataclass

import pytest

from rtron.cli.main import main


@dataclass
class CommandResult:
    code: int
    out: str
    err: str


@pytest.fixture
def rtron(monkeypatch, capsys):
    """Run `rtron` with arguments, in this process, and return its exit code and what it said."""
    monkeypatch.delenv("ROS_MASTER_URI", raising=False)

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["rtron", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            main()
        said = capsys.readouterr()
        return CommandResult(ended.value.code, said.out, said.err)

    return run


def endpoint(node, direction, topic, type):
    return {"node": node, "direction": direction, "topic": topic, "type": type}


CONTENDED = {
    "schema": "rtron.graph/1",
    "app": "small",
    "ros": 1,
    "nodes": [{"name": "/keyboard", "package": "teleop", "trust": "third_party"}],
    "endpoints": [
        endpoint("/keyboard", "publish", "/cmd_vel", "geometry_msgs/Twist"),
        endpoint("/planner", "publish", "/cmd_vel", "geometry_msgs/Twist"),
        endpoint("/base", "subscribe", "/cmd_vel", "geometry_msgs/Twist"),
    ],
}
QUIET = {"schema": "rtron.graph/1", "app": "quiet"}


@pytest.fixture
def graph_file(tmp_path):
    path = tmp_path / "graph.json"
    path.write_text(json.dumps(CONTENDED))
    return path


@pytest.fixture
def quiet_file(tmp_path):
    path = tmp_path / "quiet.json"
    path.write_text(json.dumps(QUIET))
    return path


@pytest.fixture
def plan_file(rtron, graph_file, tmp_path):
    path = tmp_path / "rtron.yaml"
    assert rtron("plan", graph_file, "-o", path).code == 0
    return path
