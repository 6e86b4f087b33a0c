"""Settings change while real nodes drive, and while real goals wait."""

from dataclasses import replace

import pytest
from action_app import GUARD, Act, action_plan, compile_actions
from compiler import compiled
from driven_base import Driven
from guard_with_settings import GuardWithSettings
from harness import wait_for
from plans import grcn, plan_of
from rostopic import TWIST, say
from traffic_light import Light, ruled

from rtron.vocabulary import (
    RSRCN,
    SECOND,
    EmergencyStop,
    Flow,
    FlowSettings,
    GuardedTopic,
    Mode,
    PolicyName,
    RuleSettings,
    StopProfile,
)

pytestmark = pytest.mark.ros1
NAV, TELEOP = "/rtron/cmd_vel/flow1", "/rtron/cmd_vel/flow2"
STOP = EmergencyStop(by="ann", reason="a child", at=0)
PATIENCE = 10 * SECOND
"""How long a flow keeps the base without a word: a stalled machine is not a silent node."""
STOP_PROFILE = StopProfile(decel=0.5, within=2 * SECOND)
"""A ramp that lasts longer than a machine stands still."""
FLOWS = (
    Flow(name="flow1", publisher="/nav", priority=2, silent_after=PATIENCE),
    Flow(name="flow2", publisher="/teleop", priority=1, silent_after=PATIENCE),
)


@pytest.fixture(scope="module")
def speaker(programs_folder):
    """Compile a publisher against roscpp."""
    return compiled(programs_folder, "speaker", "roscpp")


@pytest.fixture(scope="module")
def programs(programs_folder):
    return compile_actions(programs_folder)


def drive_plan():
    general = grcn("/cmd_vel", (), ["/driver"], flows=FLOWS, release_after=PATIENCE)
    vflows = tuple(replace(f, name=f"v{f.name}", priority=0) for f in FLOWS)
    topic = GuardedTopic(topic="/cmd_vel", type="geometry_msgs/Twist", flows=vflows)
    robot = RSRCN(
        id="rsrcn",
        mode=Mode.ENFORCE,
        policy=PolicyName.CONSTRAIN,
        max_vel_limit=5.0,
        vflows=(topic,),
    )
    return ruled(plan_of(general, rsrcn=robot, stop=STOP_PROFILE, app="base"), "/cmd_vel")


class Drive:
    """A base that a rospy node (1 m/s) and a roscpp node (2 m/s) drive at once."""

    def __init__(self, ros1, driver, speaker):
        self._ros1 = ros1
        self.driven = Driven(ros1.folder / "driven.txt")
        remap = "/cmd_vel:=/rtron/cmd_vel/out"
        ros1.spawn(driver, self.driven.path, "__name:=driver", remap)
        self.nav = say(ros1, "nav", NAV, "geometry_msgs/Twist", TWIST % 1.0, 20)
        teleop = ("2.0", "20", "__name:=teleop", f"/cmd_vel:={TELEOP}")
        self.teleop = ros1.spawn(speaker, *teleop)
        self.wait_for(1.0)
        wait_for(lambda: ros1.received("/rtron/grcn_cmd_vel", TELEOP) > 5, what="teleop")

    def xs(self):
        return [float(x) for x, _ in self.driven.messages()]

    def wait_for(self, x, count=5):
        """Wait until the base was told a velocity so often, without another between."""
        wait_for(lambda: self.xs()[-count:] == [x] * count, what=f"{x} m/s")

    def after(self, act):
        """Return what the base was told from `act` on."""
        told = len(self.xs())
        act()
        return lambda: self.xs()[told:]


@pytest.fixture
def base(ros1, driver, speaker):
    guard = GuardWithSettings(ros1, drive_plan())
    light = Light(ros1, "green")
    return guard, Drive(ros1, driver, speaker), light


def test_priorities_swap_while_both_drive(base):
    guard, drive, _ = base
    swapped = drive.after(
        lambda: guard.put({"grcn_cmd_vel": {"flows": {"flow2": FlowSettings(priority=9)}}})
    )
    drive.wait_for(2.0)
    told = swapped()
    first = told.index(2.0)
    assert set(told[first:]) == {2.0}
    back = drive.after(guard.put)
    drive.wait_for(1.0)
    told = back()
    assert set(told[told.index(1.0) :]) == {1.0}


def test_blocking_the_flow_that_drives_stops_the_base_and_another_takes_over(base):
    guard, drive, _ = base
    drive.teleop.stop()
    blocked = drive.after(
        lambda: guard.put({"grcn_cmd_vel": {"flows": {"flow1": FlowSettings(block=True)}}})
    )
    drive.wait_for(0.0, 10)
    told = blocked()
    assert told == sorted(told, reverse=True)
    assert any(0 < x < 1 for x in told)
    guard.put()
    drive.wait_for(1.0)


def test_a_lowered_limit_slows_the_moving_base_within_one_message(base):
    guard, drive, _ = base
    lowered = drive.after(lambda: guard.put({"rsrcn": {"max_vel_limit": 0.3}}))
    drive.wait_for(0.3)
    told = lowered()
    assert set(told[told.index(0.3) :]) == {0.3}
    assert set(told) <= {0.3, 1.0}
    guard.put({"rsrcn": {"max_vel_limit": 0.6}})
    drive.wait_for(0.6)


def test_an_emergency_stop_holds_until_it_is_taken_back(base):
    guard, drive, _ = base
    stopped = drive.after(lambda: guard.put(stop=STOP))
    drive.wait_for(0.0, 40)
    told = stopped()
    assert told == sorted(told, reverse=True)
    guard.put({"grcn_cmd_vel": {"flows": {"flow2": FlowSettings(priority=9)}}}, stop=STOP)
    wait_for(lambda: len(stopped()) > len(told) + 10, what="further stops")
    assert set(stopped()[len(told) :]) == {0.0}
    guard.put()
    drive.wait_for(1.0)


@pytest.mark.long
def test_a_rule_that_is_deselected_and_selected_again(base):
    guard, drive, light = base
    light.turn("red")
    drive.wait_for(0.0, 10)
    guard.put({"msrcn": {"rules": {"light": RuleSettings(selected=False)}}})
    drive.wait_for(1.0)
    guard.put()
    drive.wait_for(0.0, 10)


class ChangingAct(Act):
    """The ends of /act around a guard of the test's own process."""

    def __init__(self, ros1, programs):
        self.ros1, self._programs = ros1, programs
        self.guarded, self._clients = True, 0


@pytest.mark.long
def test_goals_that_wait_move_to_a_priority_queue_and_each_is_answered_once(ros1, programs):
    plan = action_plan(PolicyName.FIFO_QUEUE, ("/one", "/two"))
    guard = GuardWithSettings(ros1, plan)
    act = ChangingAct(ros1, programs)
    served = act.server("cpp")
    one = act.client("py", name="/one", flow="flow1")
    two = act.client("cpp", name="/two", flow="flow2")
    for client in (one, two):
        client.wait_for("connected")
    two.send(6000, 11)
    served.wait_for("started")
    two.send(12)
    two.wait_for_state(3, "PENDING")
    one.send(21, 22)
    one.wait_for_state(2, "PENDING")
    guard.put({GUARD.rpartition("/")[2]: {"policy": PolicyName.PRIORITY_QUEUE}})
    assert set(two.done(3).values()) == {"SUCCEEDED"}
    assert set(one.done(2).values()) == {"SUCCEEDED"}
    order = [int(number) for _, number in served.of("started")]
    assert order == [6000, 21, 22, 11, 12]
    assert set(one.results().values()) | set(two.results().values()) == {1}
    assert set(served.executed().values()) == {1}


@pytest.mark.long
def test_goals_that_wait_are_recalled_where_the_new_policy_holds_none(ros1, programs):
    plan = action_plan(PolicyName.FIFO_QUEUE, ("/one",))
    guard = GuardWithSettings(ros1, plan)
    act = ChangingAct(ros1, programs)
    served = act.server("py")
    one = act.client("cpp", name="/one", flow="flow1")
    one.wait_for("connected")
    one.send(5000, 1, 2)
    served.wait_for("started")
    one.wait_for_state(3, "PENDING")
    guard.put({"grcn_act": {"policy": PolicyName.BLOCK}})
    assert one.done(3) == {1: "SUCCEEDED", 2: "RECALLED", 3: "RECALLED"}
    assert "the policy has changed" in one.text(2)
    assert set(one.results().values()) == {1}


def test_an_emergency_stop_cancels_the_goal_in_progress(ros1, programs):
    plan = action_plan(PolicyName.FIFO_QUEUE, ("/one",))
    guard = GuardWithSettings(ros1, plan)
    act = ChangingAct(ros1, programs)
    served = act.server("cpp")
    one = act.client("py", name="/one", flow="flow1")
    one.wait_for("connected")
    one.send(60_000, 1)
    served.wait_for("started")
    one.wait_for_state(2, "PENDING")
    guard.put(stop=STOP)
    assert one.done(2) == {1: "PREEMPTED", 2: "RECALLED"}
    one.send(1)
    assert one.done(3)[3] == "REJECTED"
    guard.put()
    one.send(1)
    assert one.done(4)[4] == "SUCCEEDED"
    assert len(served.executed()) == 2
