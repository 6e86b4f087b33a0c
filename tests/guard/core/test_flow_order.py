"""After a guard was killed the lowest flow does not go first: the next guard knows the order."""

import pytest
from streams import WORDS, peer, stage, stream

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.handover_state import HandoverState
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.vocabulary import SECOND, Flow, PolicyName

OUT = "/rtron/cmd_vel/out"
HIGH, LOW, BLOCKED = (
    Flow(name="high", publisher="/high", priority=2),
    Flow(name="low", publisher="/low", priority=1),
    Flow(name="blocked", publisher="/blocked", priority=3, block=True),
)
FLOWS = (HIGH, LOW, BLOCKED)
ORDERED = [PolicyName.PREEMPTION, PolicyName.PRIORITY_QUEUE, PolicyName.FIFO_QUEUE]
SILENCE = SECOND // 2


class Guards:
    """One guard after the other; each leaves to the next what it has stored when it is killed."""

    def __init__(self, policy, **more):
        self.stream = stream(
            stage(policy=policy, flows=FLOWS, release_after=SILENCE),
            type=WORDS.type,
            flows=FLOWS,
            **more,
        )
        self.left = b"{}"
        self.start()

    def start(self):
        self.transport = MemoryTransport()
        handover = HandoverState(self.left, self.keep)
        self.coordinator = Coordinator(self.transport, (self.stream,), handover=handover)
        self.coordinator.open()
        self.driver = self.transport.listen(OUT)

    def keep(self, document):
        self.left = document

    def beat(self):
        """Do what the guard does with each beat."""
        for each in self.coordinator.streams:
            each.store_order()

    def connect(self, flow):
        return self.transport.publisher(f"/rtron/cmd_vel/{flow.name}", peer(flow.publisher, WORDS))

    def kill(self, *speakers):
        """Let flows speak, then kill the guard; the next one has no publisher yet."""
        for flow in speakers:
            self.connect(flow)(b"before")
        self.beat()
        self.start()
        self.beat()


@pytest.mark.parametrize("policy", ORDERED)
def test_the_lower_flow_waits_for_the_higher_one(policy):
    guards = Guards(policy)
    guards.kill(HIGH, LOW)
    low = guards.connect(LOW)
    low(b"too early")
    guards.transport.advance(SILENCE - 1)
    low(b"still too early")
    assert guards.driver == []
    guards.connect(HIGH)(b"first")
    assert guards.driver == [b"first"]


@pytest.mark.parametrize("policy", ORDERED)
def test_the_lower_flow_goes_when_the_higher_one_does_not_come_back(policy):
    guards = Guards(policy)
    guards.kill(HIGH, LOW)
    low = guards.connect(LOW)
    guards.transport.advance(SILENCE)
    low(b"its turn")
    assert guards.driver == [b"its turn"]


@pytest.mark.parametrize("policy", ORDERED)
def test_the_wait_begins_when_the_first_publisher_is_back(policy):
    guards = Guards(policy)
    guards.kill(HIGH, LOW)
    guards.transport.advance(10 * SILENCE)
    guards.connect(LOW)(b"too early")
    assert guards.driver == []


@pytest.mark.parametrize("policy", ORDERED)
def test_a_guard_that_dies_before_anybody_is_back_hands_the_order_on(policy):
    guards = Guards(policy)
    guards.kill(HIGH, LOW)
    guards.kill()
    guards.connect(LOW)(b"too early")
    assert guards.driver == []


@pytest.mark.parametrize("policy", [*ORDERED, PolicyName.BLOCK])
def test_nobody_waits_for_a_blocked_flow_nor_at_the_first_start(policy):
    guards = Guards(policy)
    guards.connect(LOW)(b"at the first start")
    assert guards.driver == [b"at the first start"]
    guards.kill(BLOCKED, LOW)
    guards.connect(LOW)(b"first")
    assert guards.driver == [b"first"]


@pytest.mark.parametrize("policy", ORDERED)
def test_nobody_waits_for_a_flow_that_was_silent_before(policy):
    guards = Guards(policy)
    guards.connect(HIGH)(b"before")
    guards.beat()
    guards.transport.advance(SILENCE)
    guards.kill(LOW)
    guards.connect(LOW)(b"first")
    assert guards.driver == [b"first"]


def test_a_stranger_waits_for_all_others_where_the_plan_lets_strangers_through():
    guards = Guards(PolicyName.PREEMPTION, block_unapproved=False)
    guards.kill(LOW)
    guards.transport.publisher("/cmd_vel", peer("/stranger", WORDS))(b"too early")
    assert guards.driver == []


def test_a_stranger_who_is_blocked_does_not_let_the_wait_begin():
    guards = Guards(PolicyName.PREEMPTION)
    guards.kill(HIGH, LOW)
    guards.transport.publisher("/cmd_vel", peer("/stranger", WORDS))(b"ignored")
    guards.transport.advance(SILENCE)
    guards.connect(LOW)(b"too early")
    assert guards.driver == []


@pytest.mark.parametrize("policy", ORDERED)
def test_what_was_in_force_goes_on(policy):
    guards = Guards(policy)
    guards.kill(HIGH, LOW)
    guards.connect(LOW)
    assert guards.coordinator.streams[0].pipeline.policies[0].owner == "high"
