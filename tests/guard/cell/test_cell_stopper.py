"""When the second stopper of a cell stops the robot, in time that the tests pass."""

from collections import Counter

import pytest

from rtron.guard.cell.access import GUARD, SUPERVISOR
from rtron.guard.cell.stopper import CellStopper
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.vocabulary import SECOND, Flow, Mode, StopProfile, Stream, output_topic

MILLISECOND = SECOND // 1000
PERIOD = 10 * MILLISECOND
WITHIN, GRACE = 400 * MILLISECOND, 500 * MILLISECOND
CMD_VEL = Stream(
    topic="/cmd_vel",
    type="geometry_msgs/Twist",
    mode=Mode.ENFORCE,
    flows=(Flow(name="nav", publisher="/nav"),),
    stages=(),
    successors=("/base",),
    stop=StopProfile(within=WITHIN, period=50 * MILLISECOND),
)


class Cell:
    """A stopper, and who is connected to it; `alive` names the roles that beat."""

    def __init__(self, *, is_carried=False):
        self.beats, self.carrier_beats, self.has_left = Counter(), 0, False
        self.connected, self.alive = {GUARD, SUPERVISOR}, {GUARD, SUPERVISOR}
        self.is_carrier_alive = True
        self.transport = MemoryTransport()
        self.stopper = CellStopper(
            self.transport, self.transport, (CMD_VEL,), self, is_carried=is_carried
        )
        self.zeros = self.transport.listen(output_topic("/cmd_vel"))
        self.stopper.open()
        self.live(100 * MILLISECOND)

    def has(self, role):
        return role in self.connected

    def live(self, duration):
        """Let time pass in which those that live beat each 10 ms."""
        for _ in range(duration // PERIOD):
            self._beat()
            self.transport.advance(PERIOD)

    def live_late(self, duration, lateness):
        """Let time pass in which all, the stopper too, run once each `lateness`."""
        for _ in range(duration // lateness):
            self._beat()
            self.transport.jump(lateness)

    def _beat(self):
        self.beats.update(self.alive & self.connected)
        self.carrier_beats += self.is_carrier_alive


@pytest.fixture
def cell():
    return Cell()


def test_it_says_nothing_while_the_guard_beats(cell):
    cell.alive = {GUARD}
    cell.live(5 * WITHIN)
    assert cell.zeros == []


def test_it_waits_for_the_stop_of_a_supervisor_that_is_alone_and_no_longer(cell, caplog):
    cell.connected.remove(GUARD)
    cell.live(WITHIN + GRACE - PERIOD)
    assert cell.zeros == []
    cell.live(3 * PERIOD)
    assert len(cell.zeros) == 1
    assert "nobody guards the cell any more" in caplog.text


def test_it_sends_a_zero_each_period_of_the_stop(cell):
    cell.connected.clear()
    cell.live(500 * MILLISECOND)
    assert len(cell.zeros) == 10


def test_it_stops_the_robot_at_once_when_the_connections_of_both_end(cell):
    cell.connected.clear()
    cell.live(PERIOD)
    assert len(cell.zeros) == 1


def test_silence_of_both_is_borne_for_a_tenth_of_a_second(cell):
    cell.alive = set()
    cell.live(90 * MILLISECOND)
    assert cell.zeros == []
    cell.live(2 * PERIOD)
    assert len(cell.zeros) == 1


@pytest.mark.parametrize(("lateness", "silence"), [(60, 170), (200, 300)])
def test_silence_is_borne_for_longer_where_the_stopper_is_late_itself(cell, lateness, silence):
    cell.live_late(10 * lateness * MILLISECOND, lateness * MILLISECOND)
    cell.alive = set()
    cell.live(silence * MILLISECOND - PERIOD)
    assert cell.zeros == []
    cell.live(2 * PERIOD)
    assert len(cell.zeros) == 1


def test_a_guard_that_comes_back_ends_the_stop(cell, caplog):
    cell.connected.clear()
    cell.live(100 * MILLISECOND)
    cell.connected.add(GUARD)
    cell.live(PERIOD)
    cell.zeros.clear()
    cell.live(500 * MILLISECOND)
    assert cell.zeros == []


def test_a_carrier_that_dies_is_a_stop_although_the_supervisor_beats():
    cell = Cell(is_carried=True)
    cell.connected.remove(GUARD)
    cell.live(PERIOD)
    assert len(cell.zeros) == 1


def test_a_carrier_that_hangs_is_a_stop_although_the_supervisor_beats():
    cell = Cell(is_carried=True)
    cell.alive, cell.is_carrier_alive = {SUPERVISOR}, False
    cell.live(200 * MILLISECOND)
    assert cell.zeros != []


def test_the_supervisor_stops_the_robot_for_a_guard_whose_carrier_tells_its_end():
    cell = Cell(is_carried=True)
    cell.connected.remove(GUARD)
    cell.has_left = True
    cell.live(WITHIN + GRACE - PERIOD)
    assert cell.zeros == []
