import json
import os
import pickle
import struct

import pytest
from rosbags.rosbag1 import Writer
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_typestore

from rtron.errors import InputError
from rtron.planning.plan_file.loader import parse_plan, read_plan
from rtron.sources.run_json import RunFileWriter, read_run, run_to_json
from rtron.vocabulary import MeasuredRun

STORE = get_typestore(Stores.ROS1_NOETIC)
TWIST = "geometry_msgs/msg/Twist"
PLAN = """
app: base
grcn:
  - topic: /cmd_vel
    type: geometry_msgs/Twist
    mode: enforce
    policy: Preemption
    flows:
      - {name: flow1, publisher: /nav, priority: 2}
      - {name: flow2, publisher: /teleop, priority: 1}
    successors: [/driver]
    release_after: 2 s
"""


def forward(speed):
    return struct.pack("<6d", speed, 0, 0, 0, 0, 0)


@pytest.fixture
def bag(tmp_path):
    path = tmp_path / "run.bag"
    with Writer(path) as writer:
        nav, teleop, rogue = (
            writer.add_connection("/cmd_vel", TWIST, typestore=STORE, callerid=node)
            for node in ("/nav", "/teleop", "/rogue\x1b[31m")
        )
        for n in range(1500):
            writer.write(nav, n * 10**8, forward(0.2))
            if n % 500 >= 460:
                writer.write(teleop, n * 10**8 + 1, forward(0.5))
        writer.write(rogue, 140 * 10**9, forward(9.0))
    return path


@pytest.fixture
def plan(tmp_path):
    path = tmp_path / "rtron.yaml"
    path.write_text(PLAN)
    return path


@pytest.fixture
def run(tmp_path):
    path = tmp_path / "run.json"
    path.write_text(json.dumps(run_to_json(MeasuredRun(app="base"))))
    return path


def test_a_bag_gives_a_plan_with_the_figures_beside_it(rtron, bag, plan, tmp_path):
    out = tmp_path / "tuned.yaml"
    ran = rtron("plan", "--from-run", bag, "--plan", plan, "-o", out)
    assert (ran.code, ran.err) == (0, "")
    assert "1621 messages in 150 s" in ran.out
    rows = [line.split() for line in ran.out.splitlines()]
    assert ["grcn_cmd_vel", "release_after", "2", "s", "->", "0.3", "s"] in rows
    assert "/teleop spoke in 3 phases" in ran.out
    assert "/rogue" in ran.out
    assert "\x1b" not in ran.out
    assert f"rtron check {out}" in ran.out
    made = read_plan(out)
    assert [flow.priority for flow in made.grcn[0].flows] == [1, 2]
    assert made.grcn[0].release_after == 3 * 10**8
    assert "# release_after: 2 s -> 0.3 s (flow" in out.read_text()
    assert rtron("check", out).code == 0


def test_an_older_plan_stays_beside_the_new_one(rtron, bag, plan):
    ran = rtron("plan", "--from-run", bag, "--plan", plan, "-o", plan)
    assert ran.code == 0
    assert plan.with_name("rtron.yaml.bak").read_text() == PLAN
    again = rtron("plan", "--from-run", bag, "--plan", plan)
    assert "What changes (0)" in again.out


def test_the_yaml_alone_is_printed_to_a_dash(rtron, bag, plan):
    ran = rtron("plan", "--from-run", bag, "--plan", plan, "-o", "-")
    assert parse_plan(ran.out).grcn[0].release_after == 3 * 10**8
    assert plan.read_text() == PLAN


def test_proposals_for_programs(rtron, bag, plan):
    ran = rtron("plan", "--from-run", bag, "--plan", plan, "--format", "json")
    found = json.loads(ran.out)
    assert found["schema"] == "rtron.proposals/1"
    release = next(each for each in found["proposals"] if each["key"] == "release_after")
    assert (release["kind"], release["before"], release["after"]) == ("change", "2 s", "0.3 s")
    assert release["samples"] == 117


def test_what_a_bag_of_ros_2_does_not_tell_is_noted(rtron, plan, tmp_path):
    path, store = tmp_path / "run2", get_typestore(Stores.ROS2_HUMBLE)
    with Writer2(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        stream = writer.add_connection("/cmd_vel", TWIST, typestore=store)
        writer.write(stream, 10**9, bytes((0, 1, 0, 0)) + forward(0.1))
    plan.write_text(PLAN + "ros: 2\n")
    ran = rtron("plan", "--from-run", path, "--plan", plan)
    assert ran.code == 0
    told = " ".join(ran.out.split())
    assert "note: /cmd_vel: its publisher is not recorded: nobody that the plan knows" in told
    assert "/nav never spoke" in told


def test_the_next_step_writes_the_plan(rtron, run, plan):
    ran = rtron("plan", "--from-run", run, "--plan", plan)
    assert ran.code == 0
    assert f"rtron plan --from-run {run} --plan {plan} -o tuned.yaml" in ran.out


def test_options_that_contradict_each_other_are_refused(rtron, run, plan, graph_file):
    refused = [
        ("--from-run", run),
        ("--from-run", run, "--plan", plan, graph_file),
        ("--from-run", run, "--plan", plan, "--live"),
        ("--from-run", run, "--plan", plan, "--launch", "a/b.launch"),
        ("--from-run", run, "--plan", plan, "-o", "-", "--format", "json"),
        ("--plan", plan, graph_file),
    ]
    for words in refused:
        ran = rtron("plan", *words)
        assert (ran.code, ran.out) == (2, "")
        assert "help: " in ran.err


def test_what_is_no_run_is_refused(rtron, plan, tmp_path):
    broken = tmp_path / "broken.json"
    broken.write_text('{"schema": "rtron.run/1", "app": "base", "duration": -1}')
    for path in (broken, tmp_path / "none.json", plan, tmp_path / "none.bag"):
        ran = rtron("plan", "--from-run", path, "--plan", plan)
        assert (ran.code, ran.out) == (2, "")
        assert path.name in ran.err


def test_figures_need_a_dry_run(rtron, plan, tmp_path):
    ran = rtron("guard", "--plan", plan, "--measurements", tmp_path / "run.json")
    assert ran.code == 2
    assert "--dry-run" in ran.err
    assert not (tmp_path / "run.json").exists()


def test_figures_are_whole_at_every_moment(tmp_path):
    path = tmp_path / "run.json"
    path.write_text("old")
    keep = pickle.loads(pickle.dumps(RunFileWriter(path)))
    for duration in (1, 2):
        keep(MeasuredRun(app="base", duration=duration))
        assert read_run(path).duration == duration
    assert [each.name for each in tmp_path.iterdir()] == ["run.json"]


def test_figures_that_cannot_be_written_leave_nothing_behind(tmp_path):
    folder = tmp_path / "run.json"
    folder.mkdir()
    for path in (folder, tmp_path / "none" / "run.json"):
        with pytest.raises(InputError):
            RunFileWriter(path)(MeasuredRun(app="base"))
    assert [each.name for each in tmp_path.iterdir()] == ["run.json"]


def test_nobody_is_made_to_write_elsewhere(tmp_path):
    mine = tmp_path / "mine"
    mine.write_text("mine")
    (tmp_path / f".run.json.{os.getpid()}").symlink_to(mine)
    RunFileWriter(tmp_path / "run.json")(MeasuredRun(app="base"))
    assert mine.read_text() == "mine"
    assert read_run(tmp_path / "run.json").app == "base"
