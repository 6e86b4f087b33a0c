"""The stop that the supervisor sends in the place of a guard that cannot."""

import json

import pytest
from streams import stage, stream
from velocity_messages import FLOAT64, float64, speeds, twist

from rtron.guard.core.message_types import standard_info
from rtron.guard.supervision.guard_config import is_stoppable
from rtron.guard.supervision.shared_memory import (
    GuardMemory,
    StatusWord,
    encode_last_message,
    encode_type_info,
)
from rtron.guard.supervision.stream_brakes import StreamBrakes
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.guard.transport.common.protocol import TypeInfo
from rtron.messages.common.encoding import Encoding
from rtron.vocabulary import SECOND, Mode, StopProfile, StreamKind

OUT = "/rtron/cmd_vel/out"
STOP = StopProfile(decel=2.0, angular_decel=4.0, period=SECOND // 10, repeat=SECOND // 2)
LOOK = SECOND // 100


class Braked:
    """A supervisor's brakes in memory, and what the driver hears of them."""

    def __init__(self, **more):
        self.transport = MemoryTransport()
        self.page = GuardMemory.create(1)
        self.transport.advance(SECOND)
        self.brakes = StreamBrakes((stream(stage(), stop=STOP, **more),), self.transport, self.page)
        self.driver = self.transport.listen(OUT)

    def says(self, message, in_force=SECOND // 2):
        """Let the guard say a message, and be alive at that moment."""
        now = self.transport.now()
        self.page[StatusWord.GUARD_BEAT] = now
        self.page.last_messages[0].write(encode_last_message(now, now + in_force, message))

    def advance(self, duration):
        for _ in range(duration // LOOK):
            self.transport.advance(LOOK)
            self.brakes.tick(self.transport.now())

    def brake(self):
        self.brakes.brake("gone", self.transport.now())

    @property
    def told(self):
        return [x for x, _ in speeds(self.driver)]


@pytest.fixture
def braked():
    made = Braked()
    yield made
    made.page.close()


def test_nothing_is_said_while_the_guard_is_well(braked):
    braked.says(twist(1.0))
    braked.advance(2 * SECOND)
    assert braked.told == []


def test_the_robot_is_ramped_down_from_the_last_message_at_once_and_kept_at_rest(braked):
    braked.says(twist(1.0, turn=0.5))
    braked.brake()
    assert braked.told == pytest.approx([0.8])
    braked.advance(5 * SECOND)
    assert braked.told[:5] == pytest.approx([0.8, 0.6, 0.4, 0.2, 0.0])
    assert set(braked.told[4:]) == {0.0}
    assert len(braked.told) == 51


@pytest.mark.parametrize(("successors", "private"), [((), []), (("/seen",), [0.8])])
def test_who_obeys_and_is_not_in_the_plan_is_stopped_on_the_public_topic(successors, private):
    made = Braked(successors=successors)
    base = made.transport.listen("/cmd_vel")
    made.says(twist(1.0))
    made.brake()
    made.page.close()
    assert ([x for x, _ in speeds(base)], made.told) == (pytest.approx([0.8]), private)


def test_the_stop_ends_after_a_while_when_there_is_a_guard_again(braked):
    braked.says(twist(1.0))
    braked.brake()
    braked.advance(SECOND // 2)
    braked.brakes.release()
    braked.advance(5 * SECOND)
    assert len(braked.told) == 9
    assert braked.told[-5:] == [0.0] * 5


def test_the_stop_ends_at_once_when_the_guard_speaks_again(braked):
    braked.says(twist(1.0))
    braked.brake()
    braked.brakes.release()
    braked.advance(SECOND // 5)
    told = len(braked.told)
    braked.says(twist(0.7))
    braked.advance(SECOND)
    assert len(braked.told) == told


def test_a_guard_that_stands_still_but_speaks_does_not_end_the_stop(braked):
    braked.says(twist(1.0))
    braked.brake()
    braked.advance(SECOND // 5)
    braked.says(twist(1.0))
    braked.advance(2 * SECOND)
    assert braked.told[-1] == 0.0


def test_the_next_guard_speaks_and_the_stop_for_the_one_before_ends(braked):
    braked.says(twist(1.0))
    braked.brake()
    page = GuardMemory.create(1)
    braked.brakes.follow(page)
    braked.brakes.release()
    braked.advance(SECOND // 10)
    told = len(braked.told)
    now = braked.transport.now()
    page.last_messages[0].write(encode_last_message(now, now + SECOND, twist(0.3)))
    braked.advance(SECOND)
    assert len(braked.told) == told
    page.close()


@pytest.mark.parametrize("in_force", [SECOND // 2, SECOND // 2 - 1])
def test_a_message_is_ramped_down_only_if_it_was_in_force_when_the_guard_last_beat(
    braked, in_force
):
    braked.says(twist(1.0), in_force)
    braked.transport.advance(SECOND // 2)
    braked.page[StatusWord.GUARD_BEAT] = braked.transport.now()
    braked.brake()
    assert braked.told == pytest.approx([0.8] if in_force == SECOND // 2 else [0.0])


@pytest.mark.parametrize("message", [b"", b"\x30\0\0\0short", twist(float("nan"))])
def test_a_message_that_cannot_be_read_is_followed_by_rest(braked, message):
    braked.says(message)
    braked.brake()
    assert braked.told == [0.0]


def test_who_said_nothing_is_told_to_rest_too(braked):
    braked.brake()
    braked.advance(SECOND)
    assert set(braked.told) == {0.0}


def test_to_brake_twice_is_to_brake_once(braked):
    braked.says(twist(1.0))
    braked.brake()
    braked.brake()
    assert len(braked.told) == 1


def test_the_guard_is_told_when_the_robot_was_stopped(braked):
    braked.brake()
    assert braked.page[StatusWord.STOPPED] == SECOND


def test_a_maximal_velocity_and_other_types_are_left_alone():
    for info in (FLOAT64, TypeInfo("a/B", "0" * 32)):
        braked = Braked(type=info.type)
        braked.page.type_infos[0].write(encode_type_info(info))
        braked.says(float64(1.0))
        braked.advance(LOOK)
        braked.brake()
        braked.advance(SECOND)
        assert braked.driver == []
        braked.page.close()


def test_only_what_moves_the_robot_and_is_enforced_is_stopped():
    assert is_stoppable(stream(stage()))
    assert not is_stoppable(stream(stage(kind=StreamKind.STATE)))
    assert not is_stoppable(stream(stage(), mode=Mode.OBSERVE))


@pytest.mark.parametrize("is_stopped", [True, False])
def test_who_comes_hears_first_to_rest_while_an_intruder_has_stopped_the_robot(braked, is_stopped):
    topic = "/cmd_vel" if is_stopped else "/other"
    braked.page.handover_state.write(json.dumps({"intrusions": {topic: "a ghost"}}).encode())
    braked.page.type_infos[0].write(
        encode_type_info(standard_info("geometry_msgs/Twist", Encoding.ROS1))
    )
    braked.advance(LOOK)
    assert speeds(braked.transport.listen(OUT)) == [(0.0, 0.0)] * is_stopped


def test_who_comes_hears_the_stop_first(braked):
    braked.says(twist(1.0))
    braked.brake()
    assert speeds(braked.transport.listen(OUT)) == [(pytest.approx(0.8), 0.0)]
