import json
import struct

import pytest
from rosbags.rosbag1 import Writer
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_typestore
from service_events import ACTION, goal_request_event

STORE = get_typestore(Stores.ROS1_NOETIC)
STORE2 = get_typestore(Stores.ROS2_HUMBLE)
TWIST = "geometry_msgs/msg/Twist"
PLAN = """
app: base
ros: {ros}
rsrcn:
  mode: enforce
  policy: Constrain
  max_vel_limit: 0.2 m/s
  vflows:
    - topic: /cmd_vel
      type: geometry_msgs/Twist
      flows: [{{name: vflow1, publisher: /nav}}]
      successors: [/driver]
"""


def forward(speed):
    return struct.pack("<6d", speed, 0, 0, 0, 0, 0)


@pytest.fixture
def bag(tmp_path):
    path = tmp_path / "run.bag"
    with Writer(path) as writer:
        nav, rogue = (
            writer.add_connection("/cmd_vel", TWIST, typestore=STORE, callerid=node)
            for node in ("/nav", "/rogue\x1b[31m")
        )
        for n in range(10):
            writer.write(nav, n * 10**8, forward(0.1 * n))
            writer.write(rogue, n * 10**8 + 1, forward(9.0))
    return path


@pytest.fixture(params=["mcap", "sqlite3"])
def ros2_bag(request, tmp_path):
    path = tmp_path / "run"
    with Writer2(path, version=9, storage_plugin=StoragePlugin[request.param.upper()]) as writer:
        stream = writer.add_connection("/cmd_vel", TWIST, typestore=STORE2)
        for n in range(10):
            writer.write(stream, n * 10**8, b"\x00\x01\x00\x00" + forward(0.1 * n))
    return path


@pytest.fixture
def plan(tmp_path):
    def write(ros=1):
        path = tmp_path / "rtron.yaml"
        path.write_text(PLAN.format(ros=ros))
        return path

    return write


def test_a_replay_tells_what_would_have_passed(rtron, bag, plan):
    ran = rtron("replay", bag, "--plan", plan())
    assert (ran.code, ran.err) == (0, "")
    rows = {words[0]: words for words in map(str.split, ran.out.splitlines()) if words}
    assert rows["vflow1"][1:] == ["/nav", "3", "0", "0", "7"]
    assert rows["unapproved"][1:] == ["0", "0", "10", "0"]
    assert "limited to 0.2 m/s (max_vel_limit)" in ran.out
    assert "20 messages in 0.9 s" in ran.out
    assert "\x1b" not in ran.out


def test_a_replay_for_programs(rtron, bag, plan, tmp_path):
    out = tmp_path / "replay.json"
    ran = rtron("replay", bag, "--plan", plan(), "--format", "json", "-o", out)
    assert (ran.code, ran.out, ran.err) == (0, "", "")
    found = json.loads(out.read_text())
    assert found["schema"] == "rtron.replay/1"
    assert found["streams"][0]["flows"][0]["modified"] == 7
    assert found["changes"][-1]["at"] == pytest.approx(0.3)


def test_a_bag_of_ros_2_is_played(rtron, ros2_bag, plan):
    ran = rtron("replay", ros2_bag, "--plan", plan(2), "--format", "json")
    assert (ran.code, ran.err) == (0, "")
    found = json.loads(ran.out)
    assert found["streams"][0]["flows"][0] == {
        "flow": "vflow1",
        "publisher": "/nav",
        "passed": 3,
        "held": 0,
        "dropped": 0,
        "modified": 7,
    }
    assert "taken for /nav" in found["notes"][0]


def test_a_bag_of_the_other_ros_is_refused(rtron, bag, ros2_bag, plan):
    for recording, ros in ((bag, 2), (ros2_bag, 1)):
        ran = rtron("replay", recording, "--plan", plan(ros))
        assert ran.code == 2
        assert "the bag is not" in ran.err


WEAR = "Part[] parts\nbool worn\n" + "=" * 80 + "\nMSG: my_msgs/Part\nfloat64 hours\n"
CUSTOM = """
ros: 2
msrcn:
  mode: enforce
  aflows:
    - topic: /cmd_vel
      type: geometry_msgs/Twist
      flows: [{name: a1, publisher: /nav}]
  eflows:
    - {name: bad, topic: /wear, publisher: /arm, type: my_msgs/msg/Wear, when: event.worn}
  rules:
    - {name: worn, when: bad, block: [/cmd_vel]}
"""


@pytest.fixture(params=["mcap", "sqlite3"])
def worn_bag(request, tmp_path):
    """Return what writes a bag of an arm that is worn after a while."""

    def write(**more):
        path = tmp_path / "worn"
        storage = StoragePlugin[request.param.upper()]
        with Writer2(path, version=9, storage_plugin=storage) as writer:
            drive = writer.add_connection("/cmd_vel", TWIST, typestore=STORE2)
            wear = writer.add_connection("/wear", "my_msgs/msg/Wear", rihs01="RIHS01_0", **more)
            for n in range(10):
                writer.write(wear, n * 10**8, b"\0\1\0\0" + bytes(4) + bytes([n >= 6]))
                writer.write(drive, n * 10**8 + 1, b"\0\1\0\0" + forward(0.1))
        return path

    return write


@pytest.fixture
def custom(tmp_path):
    path = tmp_path / "custom.yaml"
    path.write_text(CUSTOM)
    return path


def test_a_recording_brings_the_definitions_of_its_types(rtron, worn_bag, custom):
    ran = rtron("replay", worn_bag(msgdef=WEAR), "--plan", custom, "--format", "json")
    assert (ran.code, ran.err) == (0, "")
    (flow, _) = json.loads(ran.out)["streams"][0]["flows"]
    assert (flow["passed"], flow["dropped"]) == (6, 4)


def test_a_plan_is_fitted_with_the_definitions_of_the_recording(rtron, worn_bag, custom, tmp_path):
    tuned = tmp_path / "tuned.yaml"
    words = ("--from-run", worn_bag(msgdef=WEAR), "--plan", custom, "-o", tuned)
    assert rtron("plan", *words).code == 0
    assert rtron("check", tuned).code == 0
    assert rtron("check", custom).code == 2


def test_a_recording_without_readable_definitions_leaves_the_type_unknown(rtron, worn_bag, custom):
    ran = rtron("replay", worn_bag(msgdef="wstring worn"), "--plan", custom)
    assert ran.code == 2
    said = " ".join(ran.err.split())
    assert "RTron does not know the type my_msgs/msg/Wear" in said
    assert "source the workspace that has it, or add its text under `messages`" in said


def test_goals_of_ros_2_are_played_from_a_bag(rtron, tmp_path):
    plan, bag = tmp_path / "rtron.yaml", tmp_path / "goals"
    plan.write_text(DIGGING)
    with Writer2(bag, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        send = writer.add_connection(
            "/dig/_action/send_goal/_service_event",
            "my_msgs/action/Dig_SendGoal_Event",
            msgdef=ACTION,
            rihs01="RIHS01_0",
        )
        for n in (1, 2):
            writer.write(send, n * 10**9, goal_request_event(n))
    ran = rtron("replay", bag, "--plan", plan)
    assert (ran.code, ran.err) == (0, "")
    rows = {words[0]: words for words in map(str.split, ran.out.splitlines()) if words}
    assert rows["flow1"][1:] == ["/digger", "1", "1", "0", "0"]
    said = " ".join(ran.out.split())
    assert "note: /dig: whose its goals are is not recorded: taken for /digger" in said
    assert "note: /dig: no status is recorded: a goal ends only when it is overdue" in said


DIGGING = """
ros: 2
grcn:
  - topic: /dig
    type: my_msgs/action/Dig
    mode: enforce
    policy: FIFO_Queue
    flows: [{name: flow1, publisher: /digger}]
    successors: [/arm]
"""


def test_what_is_no_bag_is_refused(rtron, plan, tmp_path):
    broken = tmp_path / "broken.bag"
    broken.write_bytes(b"#ROSBAG V2.0\n" + b"\xff" * 99)
    for path in (broken, tmp_path / "none.bag", tmp_path / "rtron.yaml"):
        ran = rtron("replay", path, "--plan", plan())
        assert ran.code == 2
        assert str(path) in ran.err.replace("\n", "")


def test_missions_are_listed_and_shown(rtron):
    listed = rtron("mission-rules")
    assert (listed.code, listed.err) == (0, "")
    assert "recharge" in listed.out
    shown = rtron("mission-rules", "recharge")
    assert shown.out.startswith("# Warehouse: the AGV must recharge")
    unknown = rtron("mission-rules", "rechrage")
    assert unknown.code == 2
    assert "did you mean recharge?" in unknown.err


def test_an_override_without_a_guard_tells_what_to_do(rtron, plan, tmp_path):
    words = ("override", "rsrcn", "--plan", plan(), "--control-socket", tmp_path / "none.sock")
    ran = rtron(*words, "--for", "30s", "--reason", "docking")
    assert ran.code == 2
    assert "no guard answers" in ran.err
    assert "is the guard running" in ran.err
    assert rtron(*words, "--for", "30 parsec").code == 2
