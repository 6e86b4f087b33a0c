import asyncio

import pytest
from service_app import FakeLink

from rtron.service.live import console_listener
from rtron.service.live.console_listener import ConsoleListener, Interest
from rtron.service.live.hub import Hub
from rtron.vocabulary import Alarm, AlarmKind, GuardState, Mode, OpenRequests, StreamState

ALARM = Alarm(kind=AlarmKind.INTRUSION, reason="a stranger")


class Robots:
    """A hub with robots that say what a test says."""

    def __init__(self, *names):
        self.hub, self.links = Hub(), {}
        for name in names:
            self.connect(name)
            self.state(name)

    def connect(self, name):
        self.links[name] = FakeLink()
        self.hub.register(name, self.links[name], dry_run=False)

    def state(self, name, **more):
        self.hub.set_state(name, self.links[name], GuardState(at=1, revision=0, **more))

    def event(self, name):
        self.hub.broadcast({"type": "event", "event": {"robot": name}})


def told(listener):
    """Return what waits for the console."""
    return list(listener._queue)


def run(work):
    async def whole():
        return await asyncio.wait_for(work(), 60)

    return asyncio.run(whole())


def test_of_a_robot_that_nobody_watches_only_what_differs_is_told():
    robots = Robots("a", "b")

    async def work():
        with ConsoleListener(robots.hub) as listener:
            for _ in range(3):
                robots.state("a")
            calm = listener.take_changes()
            robots.state("a", alarms=(ALARM,))
            waiting = OpenRequests(count=2)
            robots.state("b", stopped=True, overridden=("rsrcn",), requests=waiting)
            return calm, listener.take_changes(), listener.take_changes(), told(listener)

    calm, changes, again, queue = run(work)
    assert (calm, again, queue) == ({}, {}, [])
    assert changes["a"]["alarms"][0]["reason"] == "a stranger"
    assert changes["a"]["requests"] == 0
    known = {"alarms": [], "stopped": True, "overridden": ["rsrcn"], "requests": 2}
    assert changes["b"] == known


def test_a_robot_that_is_watched_is_told_whole_and_then_by_what_differs():
    robots = Robots("a", "b")
    streams = [
        StreamState(topic=f"/t{n}", nodes=("n",), mode=Mode.ENFORCE, owner="flow1")
        for n in range(2)
    ]
    robots.state("a", streams=tuple(streams))

    async def work():
        with ConsoleListener(robots.hub) as listener:
            listener.watch(Interest(robots=frozenset({"a"}), events=False))
            changed = StreamState(topic="/t1", nodes=("n",), mode=Mode.ENFORCE, owner="flow2")
            robots.state("a", streams=(streams[0], changed))
            robots.state("b")
            listener.watch(Interest(events=False))
            robots.state("a")
            return told(listener)

    whole, delta = run(work)
    assert (whole["type"], whole["robot"], len(whole["state"]["streams"])) == ("state", "a", 2)
    assert (delta["type"], delta["robot"]) == ("state_delta", "a")
    assert [(each["topic"], each["owner"]) for each in delta["state"]["streams"]] == [
        ("/t1", "flow2")
    ]
    assert "alarms" in delta["unchanged"]


def test_many_changes_of_a_robot_are_one():
    robots = Robots("a")

    async def work():
        with ConsoleListener(robots.hub) as listener:
            for n in range(5000):
                robots.state("a", stopped=n % 2 == 0)
                robots.hub.unregister("a", robots.links["a"])
                robots.connect("a")
            return listener.take_changes(), robots.hub.has_listeners

    changes, listening = run(work)
    assert list(changes) == ["a"]
    assert changes["a"]["connected"]
    assert listening


def test_a_robot_that_goes_has_no_alarms_any_more():
    robots = Robots("a")
    robots.state("a", alarms=(ALARM,))

    async def work():
        with ConsoleListener(robots.hub) as listener:
            robots.hub.unregister("a", robots.links["a"])
            gone = listener.take_changes()
            robots.connect("a")
            robots.state("a", alarms=(ALARM,))
            return gone, listener.take_changes()

    gone, back = run(work)
    assert gone["a"]["connected"] is False
    assert gone["a"]["alarms"] == []
    assert back["a"]["connected"] is True
    assert len(back["a"]["alarms"]) == 1


def test_a_guard_that_says_nothing_is_silent_until_it_speaks(monkeypatch):
    monkeypatch.setattr(console_listener, "SILENT_AFTER_S", -1.0)
    robots = Robots("a")

    async def work():
        with ConsoleListener(robots.hub) as listener:
            silent, again = listener.take_changes(), listener.take_changes()
            monkeypatch.setattr(console_listener, "SILENT_AFTER_S", 3600.0)
            robots.state("a")
            return silent, again, listener.take_changes()

    silent, again, spoken = run(work)
    assert silent == {"a": {"silent": True}}
    assert again == {}
    assert spoken == {"a": {"silent": False}}


@pytest.mark.parametrize(
    ("interest", "heard"),
    [
        (None, ["a", "b"]),
        (Interest(events=False), []),
        (Interest(robots=frozenset({"b"}), events=False), ["b"]),
        (Interest(robots=frozenset({"b"}), events=True), ["a", "b"]),
    ],
)
def test_events_are_told_to_who_asks_for_them(interest, heard):
    robots = Robots("a", "b")

    async def work():
        with ConsoleListener(robots.hub) as listener:
            if interest:
                listener.watch(interest)
            robots.event("a")
            robots.event("b")
            return [each["event"]["robot"] for each in told(listener) if each["type"] == "event"]

    assert run(work) == heard


def test_who_has_closed_hears_nothing():
    robots = Robots("a")

    async def work():
        with ConsoleListener(robots.hub):
            pass
        return robots.hub.has_listeners

    assert not run(work)
