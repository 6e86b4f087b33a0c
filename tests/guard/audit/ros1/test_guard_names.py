"""Which streams a second node stops that takes a name of the guard."""

import time
from contextlib import closing
from types import SimpleNamespace

import pytest
from plans import grcn, plan_of

from rtron.guard.audit.ros1 import guard_names
from rtron.guard.audit.ros1.expected_graph import ExpectedGraph
from rtron.guard.core.event_loop import EventLoop
from rtron.vocabulary import BULK_NODE, GUARD_NODE, Mode


def plan_with(*arm_publishers, **arm):
    return plan_of(
        grcn("/cmd_vel", ("/nav",), ["/base"]),
        grcn("/arm", ("/nav", *arm_publishers), ["/arm"], **arm),
        grcn("/scan", ("/nav",), ["/map"], mode=Mode.OBSERVE),
    )


PLANS = [plan_with(), plan_with(block_unapproved=False), plan_with("/*")]
ROGUE = "http://rogue:1/"


@pytest.fixture
def taken(monkeypatch):
    """Return what finds the streams that are stopped when somebody else takes a name."""

    def take(name, plan):
        expected = ExpectedGraph(plan)
        nodes = {each: f"http://guard:7{each}" for each in expected.guard_nodes}
        owners = nodes | {name: ROGUE}
        monkeypatch.setattr(guard_names, "query_uri", lambda master, node: owners[node])
        monkeypatch.setattr(guard_names, "refuses_connections", lambda uri: False)
        raised, registered, loop = [], [], EventLoop()
        response = SimpleNamespace(
            stops_streams=True, raise_=lambda alarm, now, *streams: raised.append((alarm, streams))
        )
        guard = SimpleNamespace(node_uris=lambda: nodes, register_node=registered.append)
        names = guard_names.GuardNames(loop, "", guard, expected, response, {})
        with closing(loop), closing(names):
            names.check()
            until = time.monotonic() + 10
            while not names.is_checked and time.monotonic() < until:
                loop.step(0.1)
        ((alarm, streams),) = raised
        assert (alarm.node, registered) == (name, [name])
        return set(streams)

    return take


@pytest.mark.parametrize("plan", PLANS)
def test_the_name_of_a_coordination_node_stops_its_stream(taken, plan):
    assert taken("/rtron/grcn_cmd_vel", plan) == {"/cmd_vel"}


@pytest.mark.parametrize("plan", PLANS)
@pytest.mark.parametrize("name", [GUARD_NODE, BULK_NODE])
def test_a_name_that_speaks_for_the_whole_guard_stops_every_stream(taken, name, plan):
    assert taken(name, plan) == {"/cmd_vel", "/arm"}


def test_the_stop_of_a_name_leaves_what_only_observes_alone(taken):
    assert taken("/rtron/grcn_scan", plan_with()) == {"/cmd_vel", "/arm"}
