"""Leases between real nodes of ROS 1: who asks by its own name moves the base, nobody else."""

import pytest
from commanded_base import LEASE, CommandedBase, Commander
from driven_base import CMD_VEL_GUARD
from harness import wait_for
from leased_base import AGENT, NAV, STRANGER, TELEOP
from plans import grcn, plan_of

from rtron.vocabulary import GUARD_NODE, SECOND, CommanderRank, Flow, LeaseGroup, PolicyName

pytestmark = pytest.mark.ros1
LONG = 600 * SECOND
SHORT = 2 * SECOND
RANKS = {
    TELEOP: CommanderRank.OPERATOR_ON_SITE,
    NAV: CommanderRank.AUTONOMY,
    AGENT: CommanderRank.AGENT,
}


def leased_plan(ttl):
    flows = tuple(
        Flow(name=node.strip("/"), publisher=node, rank=rank, silent_after=3 * SECOND)
        for node, rank in RANKS.items()
    )
    base = grcn("/cmd_vel", (), ["/driver"], flows=flows, policy=PolicyName.LEASE, lease="base")
    return plan_of(base, app="leased", leases=(LeaseGroup(name="base", ttl=ttl),))


@pytest.fixture
def scene(ros1):
    return CommandedBase(ros1, leased_plan(LONG))


def test_who_has_the_lease_drives_after_a_neutral_command_and_nobody_else(scene):
    nav, teleop = scene.commander(NAV), scene.commander(TELEOP)
    nav.drive(0.25)
    teleop.drive(0.375)
    answers = f"{LEASE}/answer"
    wait_for(lambda: scene.ros1.connected(GUARD_NODE, NAV, answers), what="who hears the answer")
    nav.ask("acquire a goal has come")
    scene.wait_for_log("acquire by /nav: base is granted to /nav (autonomy)")
    wait_for(lambda: scene.ros1.received(CMD_VEL_GUARD, "/rtron/cmd_vel/nav") > 50)
    assert scene.speeds() == []
    nav.drive_neutral()
    scene.wait_for_speed(0.0)
    nav.drive(0.25)
    scene.wait_for_speed(0.25)
    assert 0.375 not in scene.speeds()
    answer = wait_for(lambda: [each for each in nav.answers() if each["to"] == NAV], what="it")[0]
    assert (answer["request"], answer["granted"]) == ("acquire", True)


def test_a_higher_rank_takes_over_and_the_base_stops_until_it_is_neutral(scene):
    nav, teleop = scene.commander(NAV), scene.commander(TELEOP)
    nav.ask("acquire")
    nav.drive_neutral()
    scene.wait_for_speed(0.0)
    nav.drive(0.25)
    scene.wait_for_speed(0.25)
    teleop.drive(0.125)
    teleop.ask("take_over a person is near")
    scene.wait_for_log("taken over from /nav (autonomy): a person is near")
    wait_for(lambda: scene.speeds()[-1] == 0.0, what="rest")
    taken = len(scene.speeds())
    nav.ask("take_over")
    scene.wait_for_log("/nav (autonomy) has no higher rank")
    teleop.drive_neutral()
    scene.wait_for_speed(0.0)
    teleop.drive(0.125)
    scene.wait_for_speed(0.125)
    assert 0.25 not in scene.speeds()[taken:]


def test_a_lease_that_nobody_renews_stops_the_base(ros1):
    scene = CommandedBase(ros1, leased_plan(SHORT))
    nav = scene.commander(NAV)
    nav.ask("acquire")
    nav.drive_neutral()
    scene.wait_for_speed(0.0)
    nav.drive(0.25)
    scene.wait_for_log("/nav (autonomy) held it last, it was not renewed")
    wait_for(lambda: scene.speeds()[-1] == 0.0, what="rest")
    dropped = ros1.received(CMD_VEL_GUARD, "/rtron/cmd_vel/nav")
    stopped = len(scene.speeds())
    wait_for(lambda: ros1.received(CMD_VEL_GUARD, "/rtron/cmd_vel/nav") > dropped + 25)
    assert set(scene.speeds()[stopped:]) <= {0.0}


def test_a_stranger_asks_in_vain(scene):
    nav, stranger = scene.commander(NAV), Commander(scene.ros1, STRANGER)
    scene.wait_for_log("/stranger may ask for nothing: it is no commander of base")
    stranger.ask("acquire")
    nav.ask("acquire")
    nav.drive_neutral()
    scene.wait_for_speed(0.0)
    assert "granted to /stranger" not in scene.guard.log


def test_active_and_the_command_line_tell_who_holds_it_and_a_person_ends_it(scene):
    nav = scene.commander(NAV)
    nav.ask("acquire a goal")
    scene.wait_for_log("granted to /nav")
    said = scene.ros1.run("rostopic", "echo", "-n", "1", f"{CMD_VEL_GUARD}/cmd_vel/active")
    assert "/nav (autonomy) holds base since 20" in said
    status = scene.ros1.run("rostopic", "echo", "-n", "1", f"{LEASE}/status")
    assert "/nav" in status
    listed = scene.rtron("lease", "list")
    assert listed.startswith("base: /nav (autonomy) since 20")
    assert listed.endswith(", acquired: a goal\n")
    given = scene.rtron("lease", "give", "base", AGENT, "--reason", "a demo")
    assert "base is granted to /agent (agent)" in given
    ended = scene.rtron("lease", "end", "base", "--reason", "it is over")
    assert ended.startswith("base is taken from /agent (agent) by ")
    again = scene.rtron("lease", "list")
    assert again == "base: nobody holds base; /agent (agent) held it last\n"
