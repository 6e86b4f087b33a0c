"""A person at the service says who is in command, and a real base under a real guard obeys."""

import pytest
from commanded_base import LEASE, Commander
from driven_base import CMD_VEL
from harness import wait_for
from leased_base import AGENT, NAV, TELEOP
from linked_app import ROBOT, LinkedApp
from plans import grcn, plan_of

from rtron.vocabulary import SECOND, CommanderRank, Flow, LeaseGroup, PolicyName

pytestmark = pytest.mark.ros1
RANKS = {
    TELEOP: CommanderRank.OPERATOR_ON_SITE,
    NAV: CommanderRank.AUTONOMY,
    AGENT: CommanderRank.AGENT,
}
LEASES = (LeaseGroup(name="base", ttl=600 * SECOND, service=CommanderRank.REMOTE_OPERATOR),)


def leased_plan():
    flows = tuple(
        Flow(name=node.strip("/"), publisher=node, rank=rank, silent_after=3 * SECOND)
        for node, rank in RANKS.items()
    )
    settings = {"flows": flows, "policy": PolicyName.LEASE, "lease": "base"}
    return plan_of(grcn(CMD_VEL, (), ["/driver"], **settings), app="base", leases=LEASES)


class Scene(LinkedApp):
    """Commanders at a guard that is linked to a service, and a person there."""

    def __init__(self, ros1, service, ann):
        super().__init__(ros1, service, leased_plan())
        self._ann = ann
        self._path = f"/api/v1/robots/{ROBOT}/leases"

    def commander(self, name):
        return Commander(self.ros1, name, name.strip("/"), (LEASE,))

    def speed(self):
        return float(self.driven.messages()[-1][0])

    def wait_for_speed(self, speed):
        """Wait until the base is driven at a speed by a message that comes from now on."""
        known = len(self.driven.messages())
        wait_for(
            lambda: speed in [float(x) for x, _ in self.driven.messages()[known:]],
            what=f"{speed} m/s at the driver",
        )

    def status(self):
        (base,) = self._ann.get(self._path).json()
        return base["status"] or {}

    def wait_for_holder(self, name):
        wait_for(lambda: self.status().get("holder") == name, what=f"{name} in command")

    def change(self, do, **body):
        body = {"do": do, "grant": self.status()["grant"], "reason": "the door is shut", **body}
        return self._ann.post(f"{self._path}/base", json=body)


@pytest.fixture
def scene(ros1, service_with_person):
    return Scene(ros1, *service_with_person)


def test_a_person_takes_over_by_rank_and_the_base_obeys(scene):
    nav, agent, teleop = (scene.commander(name) for name in (NAV, AGENT, TELEOP))
    nav.ask("acquire a goal has come")
    nav.drive_neutral()
    scene.wait_for_speed(0.0)
    nav.drive(0.25)
    scene.wait_for_speed(0.25)
    scene.wait_for_holder(NAV)
    agent.drive(0.125)
    answer = scene.change("give", to=AGENT)
    assert answer.status_code == 200, answer.text
    assert "given by ann (remote_operator): the door is shut" in answer.json()["reason"]
    wait_for(lambda: scene.speed() == 0.0, what="rest")
    taken = len(scene.driven.messages())
    agent.drive_neutral()
    scene.wait_for_speed(0.0)
    agent.drive(0.125)
    scene.wait_for_speed(0.125)
    assert "0.25" not in [x for x, _ in scene.driven.messages()[taken:]]
    scene.wait_for_holder(AGENT)
    teleop.ask("take_over a person is near")
    scene.wait_for_holder(TELEOP)
    refused = scene.change("end")
    assert refused.status_code == 409
    assert "ann (remote_operator) has no higher rank" in refused.json()["error"]
    wait_for(lambda: len(scene.events(kind="lease")) == 3, what="the events")
    holders = [each["publisher"] for each in scene.events(kind="lease")]
    assert holders == [TELEOP, AGENT, NAV]


@pytest.mark.long
def test_what_a_person_ends_stops_the_base(scene):
    nav = scene.commander(NAV)
    nav.ask("acquire")
    nav.drive_neutral()
    scene.wait_for_speed(0.0)
    nav.drive(0.25)
    scene.wait_for_speed(0.25)
    scene.wait_for_holder(NAV)
    assert scene.change("end").status_code == 200
    wait_for(lambda: scene.speed() == 0.0, what="rest")
    scene.wait_for_holder("")
