"""The way of commands is kept warm, without a trace and without a message that waits."""

import itertools
import select
from collections import deque
from dataclasses import replace
from functools import partial

import pytest
from settings_app import PLAN, Base, limit
from velocity_messages import twist

from rtron.guard.core.event_loop import EventLoop, IoHandler
from rtron.guard.rehearsal import PERIOD, SHARE, Rehearsal
from rtron.guard.transport.common.memory import Stage
from rtron.guard.transport.common.protocol import OutputOptions
from rtron.guard.transport.ros1.stage import Ros1Stage
from rtron.messages.common.encoding import Encoding
from rtron.vocabulary import SECOND, MissionRule

PARTS = 3
"""A message arrives, is handled, and leaves."""


class Recorder(Stage):
    """A stage that writes down each part, and lets it take `lasts` ns."""

    def __init__(self, base):
        super().__init__(Encoding.ROS1, base.transport.now)
        self.base, self.log, self.lasts = base, [], 0
        self.handled = []

    def arrive(self, message):
        self._note("arrive")
        super().arrive(message)

    def handle(self, receive):
        self._note("handle")
        super().handle(lambda message: self.handled.append(receive(message)))

    def take_output(self):
        self._note("leave")

    def _note(self, part):
        self.log.append(part)
        self.base.transport.advance(self.lasts)


MESSAGE_FD = 1 << 20


class ScriptedEpoll:
    """Nothing is ready, but a socket at one look; looks are counted from 1."""

    def __init__(self, look, fd):
        self.look = look
        self.fd = fd
        self.looks = 0

    def poll(self, timeout, _most):
        assert timeout == 0, "nobody waits while a rehearsal is on"
        self.looks += 1
        return [(self.fd, select.EPOLLIN)] if self.looks == self.look else []


class World:
    """A base whose guard rehearses, on a loop that does one step when it is told."""

    def __init__(self, create_stage=Recorder, **more):
        self.base = Base(**more)
        self.loop = EventLoop()
        self.loop.now = self.base.transport.now
        self.stage = create_stage(self.base)
        self.rehearsal = Rehearsal(self.base.host, self.loop, self.stage)

    def begin(self):
        self.rehearsal.open()
        return self

    def pass_time(self, duration):
        """Let time pass, one period after the other, with all that the loop has to do then."""
        for _ in range(duration // PERIOD):
            self.base.transport.advance(PERIOD)
            self.run_idle()

    def run_idle(self):
        for _ in range(PARTS + 2):
            self.loop.step(0)

    def close(self):
        self.stage.close()
        self.loop.close()


@pytest.fixture
def world():
    world = World()
    world.base.ask(2.0)
    world.base.drive(0.4)
    yield world
    world.close()


def rehearsed(world):
    """Return a world whose stream was copied and rehearsed once."""
    world.begin()
    world.pass_time(3 * PERIOD)
    assert world.stage.log[:PARTS] == ["arrive", "handle", "leave"]
    return world


def test_the_last_command_takes_the_way_of_a_real_one(world):
    rehearsed(world)
    assert world.stage.handled[0].decision == world.base.tally("flow1").last.decision
    assert world.stage.handled[0].flow == "flow1"


@pytest.mark.parametrize("interrupted", range(1, PARTS + 1))
def test_a_message_that_comes_before_a_part_is_handled_before_it(world, interrupted, monkeypatch):
    log = rehearsed(world).stage.log
    log.clear()
    finished = world.rehearsal.finished
    message = IoHandler(None, lambda: log.append("message"), pytest.fail)
    monkeypatch.setitem(world.loop._handlers, MESSAGE_FD, message)
    monkeypatch.setattr(world.loop, "_epoll", ScriptedEpoll(interrupted + 1, MESSAGE_FD))
    world.base.transport.advance(PERIOD)
    world.run_idle()
    assert log == [*["arrive", "handle", "leave"][: interrupted - 1], "message"]
    assert world.rehearsal.finished == finished
    world.base.transport.advance(SHARE * PERIOD)
    world.run_idle()
    parts = [each for each in log if each != "message"]
    assert parts[:PARTS] == ["arrive", "handle", "leave"], "it goes on where it was interrupted"
    monkeypatch.undo()


def test_a_timer_that_is_due_comes_before_a_part(world):
    rehearsed(world)
    world.base.transport.advance(PERIOD)
    log = world.stage.log
    log.clear()
    world.loop.step(0)
    world.loop.call_at(world.loop.now(), lambda: log.append("timer"))
    world.loop.step(0)
    assert log == ["timer"]


def test_there_is_one_rehearsal_in_a_period_at_most(world):
    rehearsed(world)
    before = world.rehearsal.finished
    world.pass_time(100 * PERIOD)
    assert 90 <= world.rehearsal.finished - before <= 100


def test_slow_rehearsals_come_seldom(world):
    rehearsed(world)
    world.stage.lasts = PERIOD
    world.pass_time(20 * PERIOD)
    before, began = world.rehearsal.finished, world.loop.now()
    for _ in range(10):
        world.base.drive(0.4)
        world.pass_time(100 * PERIOD)
    number = world.rehearsal.finished - before
    assert 10 <= number <= (world.loop.now() - began) / (SHARE * PERIOD) + 1


def test_a_stream_without_commands_is_not_rehearsed(world):
    rehearsed(world)
    world.pass_time(2 * SECOND)
    before = world.rehearsal.finished
    world.pass_time(SECOND)
    assert world.rehearsal.finished == before
    world.base.drive(0.4)
    world.pass_time(SECOND // 5)
    assert world.rehearsal.finished > before


def test_long_messages_and_strangers_are_not_rehearsed(world):
    world.base.stream().pipeline.last_emitted = ("flow1", bytes(2000), world.loop.now())
    world.base.stream("/max_vel").pipeline.last_emitted = ("unapproved", b"", world.loop.now())
    world.begin()
    world.pass_time(10 * PERIOD)
    assert world.stage.log == []


def test_other_settings_are_rehearsed_too(world):
    rehearsed(world)
    world.base.apply(limit(0.1))
    world.pass_time(10 * PERIOD)
    assert world.stage.handled[-1].revision == 2
    assert "0.1" in world.stage.handled[-1].reason


def test_an_internal_error_ends_rehearsals_and_is_logged_once(world, caplog):
    world.stage.handle = lambda receive: 1 / 0
    world.begin()
    world.pass_time(20 * PERIOD)
    assert [each.levelname for each in caplog.records] == ["ERROR"]
    assert world.stage.log == ["arrive"]


AFTER_A_COMMAND = MissionRule(
    name="after_a_command", when="fire", block=("/max_vel",), require="/cmd_vel"
)
"""A rehearsed command does not meet it."""


def drive_both(worlds, round):
    """Let a random-looking but equal day of commands, events and limits happen to both."""
    for base in worlds:
        if round % 5 == 0:
            base.drive(0.1 + round // 5 % 6 / 10, turn=0.1)
        if round % 1000 == 500:
            base.drive(0.3, by="teleop")
        if round % 3000 == 2001:
            base.event("fire")
        if round % 5 == 4:
            base.ask(1.0 + round % 3)


def test_ten_thousand_rehearsals_leave_no_trace():
    msrcn = replace(PLAN.msrcn, rules=(*PLAN.msrcn.rules, AFTER_A_COMMAND))
    plan = replace(PLAN, msrcn=msrcn)
    world, twin = World(lambda base: Ros1Stage(base.transport.now), plan=plan), Base(plan)
    world.begin()
    for round in itertools.count():
        drive_both((world.base, twin), round)
        if world.rehearsal.finished >= 10_000:
            break
        world.base.transport.advance(PERIOD)
        twin.transport.advance(PERIOD)
        world.run_idle()
    drive_both((world.base, twin), 0)
    world.close()
    assert world.base.driver == twin.driver
    assert world.base.limits == twin.limits
    assert state_of(world.base.host) == state_of(twin.host)
    assert state_of(world.base.transport) == state_of(twin.transport)


def state_of(thing):
    """Return all that can be reached from an object, as plain values; functions by their names."""
    return _state(thing, {}, deque())


def _state(thing, known, alive):  # noqa: PLR0911 - a kind of thing each
    if isinstance(thing, str | bytes | int | float | None):
        return thing
    if isinstance(thing, type):
        return thing.__qualname__
    if id(thing) in known:
        return known[id(thing)]
    known[id(thing)] = f"object {len(known)}"
    alive.append(thing)
    look = partial(_state, known=known, alive=alive)
    if isinstance(thing, dict):
        return [(look(key), look(value)) for key, value in sorted(thing.items(), key=_by_name)]
    if isinstance(thing, list | tuple | deque):
        return [type(thing).__name__, *map(look, thing)]
    if isinstance(thing, set | frozenset):
        return [look(each) for each in sorted(thing, key=str)]
    if isinstance(thing, partial):
        return [look(thing.func), look(thing.args), look(thing.keywords)]
    return _object_state(thing, look)


def _by_name(item):
    return item[0] if isinstance(item[0], str) else ""


def _object_state(thing, look):
    name = getattr(thing, "__qualname__", type(thing).__qualname__)
    owner = getattr(thing, "__self__", None)
    cells = [each.cell_contents for each in getattr(thing, "__closure__", None) or ()]
    slots = [
        slot
        for cls in type(thing).__mro__
        for slot in getattr(cls, "__slots__", ())
        if hasattr(thing, slot)
    ]
    fields = {slot: getattr(thing, slot) for slot in slots} | getattr(thing, "__dict__", {})
    return [name, look(owner), look(cells), look(fields)]


def test_the_states_of_two_bases_differ_where_one_heard_more():
    one, other = Base(), Base()
    assert state_of(one.host) == state_of(other.host)
    one.drive(0.3)
    assert state_of(one.host) != state_of(other.host)


def test_on_ros_1_a_message_goes_through_sockets_and_is_taken_out():
    now = iter(range(10**6)).__next__
    stage = Ros1Stage(now)
    sent = stage.advertise("/n", "/t", "x/Y", OutputOptions(successors=("/driver",)))
    silent = stage.advertise("/n", "/t", "x/Y")
    got = []
    for _ in range(20_000):
        stage.arrive(twist(0.1))
        stage.arrive(twist(0.1))
        stage.handle(lambda message: (got.append(message), sent.publish(message)))
        stage.take_output()
    silent.publish(twist(0.1))
    stage.close()
    assert 19_000 <= len(got) <= 20_000
    assert set(got) == {twist(0.1)}
    assert sent.lost == silent.lost == 0
