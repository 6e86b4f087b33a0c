"""The link between a service and a bridge: open requests go up, answers of persons come down."""

import os
import shutil
from threading import Event

import pytest
from approving_bridge import ApprovingBridge
from cancelled_tasks import assert_ends_when_cancelled
from harness import LIMIT_S
from link_parts import Guard, Service, options, running_relay, serving

from rtron.guard.link import bridge_requests
from rtron.guard.link.bridge_requests import BridgeRequests
from rtron.vocabulary import Settings
from rtron.wire.common.link_protocol import (
    ApprovalCommand,
    CommandResponse,
    Hello,
    NewSettings,
    StateDelta,
    StateReport,
)
from rtron.wire.common.state_deltas import apply_state_delta


class Scene:
    """A guard with its link, a service that we control, and a bridge that comes and goes."""

    def __init__(self, service, guard):
        self.service, self.guard = service, guard
        self._revision = 0

    def welcome(self, **takes):
        """Let the service say what it takes."""
        self.guard.until(lambda: self.service.of(Hello), "the hello")
        self._revision += 1
        self.service.say(NewSettings(settings=Settings(revision=self._revision), now=1, **takes))
        self.guard.until(lambda: self.guard.settings, "the settings")

    def states(self):
        """Return the states that the service has heard, differences put together."""
        states = []
        for message in self.service.heard:
            if isinstance(message, StateReport):
                states.append(message.state)
            elif isinstance(message, StateDelta):
                states.append(apply_state_delta(states[-1], message))
        return states

    def until_told(self, is_it, what):
        def told():
            self.guard.line.send(self.guard.state())
            return is_it(self.states()[-1].requests if self.states() else None)

        self.guard.until(told, what)
        return self.states()[-1].requests

    def answer(self, digest, do="approve", roles=("end_user",)):
        """Let a person at the service answer; return what comes back."""
        count = len(self.service.of(CommandResponse))
        self.say(digest, do, roles)
        self.guard.until(lambda: len(self.service.of(CommandResponse)) > count, "the response")
        response = self.service.of(CommandResponse)[-1]
        assert response.number == count
        return response

    def say(self, digest, do="approve", roles=("end_user",)):
        number = len(self.service.of(CommandResponse))
        command = ApprovalCommand(
            number=number, digest=digest, do=do, by="ann", roles=roles, reason="it is free"
        )
        self.service.say(command)


@pytest.fixture
def scene(tmp_path):
    with serving(Service()) as service:
        made = options(tmp_path, service.url)
        guard = Guard(made)
        with running_relay(made):
            yield Scene(service, guard)
        guard.close()
        shutil.rmtree(made.counter_folder, ignore_errors=True)


def has(count):
    return lambda requests: requests is not None and requests.count == count


@pytest.mark.parametrize("deltas", [False, True])
def test_a_request_reaches_the_service_and_its_answer_the_bridge(scene, deltas):
    scene.welcome(takes_requests=True, takes_state_deltas=deltas)
    assert scene.service.of(Hello)[0].takes_approval_commands
    with ApprovingBridge() as bridge:
        assert "request 1 waits" in bridge.ask()
        (request,) = scene.until_told(has(1), "the request").shown
        assert (request.client, request.what) == ("assistant", "publish /goal")
        response = scene.answer(request.digest)
        assert (response.granted, response.reason) == (
            True,
            "request 1 of assistant, publish /goal, is approved by ann at the service",
        )
        scene.until_told(has(0), "no request")
        assert bridge.ask() == ""
        again = scene.answer(request.digest)
        assert (again.granted, "does not wait any more" in again.reason) == (False, True)
        assert not scene.answer(request.digest, roles=("developer",)).granted
    scene.until_told(lambda requests: requests is None, "the end of the bridge")


def test_without_a_bridge_a_person_is_told_that_nothing_answers(scene):
    scene.welcome(takes_requests=True)
    response = scene.answer("0" * 64)
    assert (response.granted, response.reason) == (
        False,
        "the bridge of the app does not answer: look what is so now",
    )
    assert scene.until_told(lambda requests: requests is None, "a state") is None


def test_the_bridge_of_another_app_is_not_asked(scene):
    scene.welcome(takes_requests=True)
    with ApprovingBridge("other") as bridge:
        bridge.ask()
        assert "does not answer" in scene.answer("0" * 64).reason
        assert len(bridge.approvals.waiting(bridge.loop.now())) == 1


def test_a_service_that_takes_no_requests_gets_states_as_it_knows_them(scene):
    scene.welcome(takes_state_deltas=True)
    with ApprovingBridge() as bridge:
        bridge.ask()
        count = len(scene.states())
        scene.until_told(lambda _: len(scene.states()) > count + 2, "states")
    deltas = scene.service.of(StateDelta)
    assert deltas
    assert not any("requests" in each.unchanged for each in deltas)
    assert {each.requests for each in scene.states()} == {None}


def test_the_watch_ends_at_whatever_moment_a_connection_to_the_service_does():
    """A guard that begins ends the connection, and the next one waits for the end of the watch."""
    assert_ends_when_cancelled(lambda: BridgeRequests().watch("an app without a bridge"))


def test_a_bridge_that_hangs_is_given_up(scene, monkeypatch):
    monkeypatch.setattr(bridge_requests, "_TIMEOUT_S", 0.5)
    scene.welcome()
    with ApprovingBridge() as bridge:
        release = hold(bridge)
        try:
            assert "does not answer" in scene.answer("0" * 64).reason
        finally:
            release()


def test_a_bridge_that_is_slow_delays_no_settings(scene, monkeypatch):
    monkeypatch.setattr(bridge_requests, "_TIMEOUT_S", LIMIT_S)
    scene.welcome()
    with ApprovingBridge() as bridge:
        bridge.ask()
        (waiting,) = bridge.approvals.waiting(bridge.loop.now())
        release = hold(bridge)
        try:
            scene.say(waiting.digest)
            scene.guard.settings.clear()
            scene.welcome()
            assert not scene.service.of(CommandResponse)
        finally:
            release()
        scene.guard.until(lambda: scene.service.of(CommandResponse), "the response")
        assert scene.service.of(CommandResponse)[0].granted


def hold(bridge):
    """Let a bridge's loop do nothing until the returned function is called."""
    held, going_on = Event(), Event()

    def wait():
        held.set()
        going_on.wait(60)

    bridge.loop.post(wait)
    assert held.wait(60)
    return going_on.set


def test_another_users_socket_in_the_place_of_the_bridges_hears_nothing(scene, monkeypatch):
    scene.welcome()
    with ApprovingBridge() as bridge:
        bridge.ask()
        (waiting,) = bridge.approvals.waiting(bridge.loop.now())
        stranger = os.getuid() + 1
        monkeypatch.setattr(bridge_requests, "peer_credentials", lambda _: (1, stranger))
        assert not scene.answer(waiting.digest).granted
        monkeypatch.undo()
        assert scene.answer(waiting.digest).granted
