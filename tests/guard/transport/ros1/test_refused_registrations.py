"""What the guard says when a master refuses to register it, as a proxy does that came too late."""

import logging

import pytest
from harness import wait_for
from masters import Master, running, serving

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.transport.ros1 import registrar as registrars
from rtron.guard.transport.ros1.middleware import Ros1Transport

NODES = ("/a", "/b", "/c")


class RefusingMaster(Master):
    """Refuses whatever registers."""

    def _dispatch(self, method, params):
        answer = super()._dispatch(method, params)
        if method.startswith("register"):
            return [-1, f"refused by rtron master: {params[0]}", []]
        return [1, "", 7] if method == "getPid" else answer

    def registrations(self):
        return [params[0] for method, params in self.asked if method.startswith("register")]


@pytest.fixture
def said(caplog):
    caplog.set_level(logging.ERROR)
    return lambda: [r.getMessage() for r in caplog.records if "refused by" in r.getMessage()]


def test_a_refused_registration_is_an_error_in_the_log_once_for_each_text(said):
    master, loop = RefusingMaster(), EventLoop()
    with serving(master) as uri:
        transport = Ros1Transport(loop, uri, "127.0.0.1")
        for node in NODES:
            transport.advertise(node, "/topic", "std_msgs/String")
            transport.advertise(node, "/other", "std_msgs/String")
        with running(loop):
            wait_for(lambda: len(master.registrations()) >= 12, what="registrations, said again")
        transport.close()
        loop.close()
    assert len(said()) == len(NODES)
    assert all("start `rtron master` first" in text for text in said())


def test_what_is_said_of_refusals_is_bounded(said):
    refused = registrars._RefusalLog()
    for number in range(1000):
        refused.log_once(f"refused by {number}")
    assert len(said()) == len(refused._logged_at) == 16


def test_a_master_that_is_not_there_is_no_refusal(said):
    loop = EventLoop()
    with serving(RefusingMaster()) as uri:
        pass
    transport = Ros1Transport(loop, uri, "127.0.0.1")
    transport.advertise("/a", "/topic", "std_msgs/String")
    transport.close()
    loop.close()
    assert not said()
