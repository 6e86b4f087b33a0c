"""Whose a message is, by the id that comes with it, on whichever RMW these tests run."""

from contextlib import closing
from dataclasses import replace

import pytest
from harness import wait_for

pytest.importorskip("rclpy", reason="needs ROS 2")
from rclpy.qos import DurabilityPolicy, QoSProfile
from ros2_world import OnRos2
from test_msgs.srv import Empty

from rtron.errors import SourceError
from rtron.guard.transport.common.protocol import DEFAULT_INPUT
from rtron.guard.transport.ros2 import cyclone_ids, sender_ids
from rtron.guard.transport.ros2.rcl import Rcl
from rtron.guard.transport.ros2.sender_ids import find_sender_ids
from rtron.guard.transport.ros2.service_calls import ServiceCalls, request_id_parts
from rtron.wire.ros2.endpoints import await_publishers, clients_of, publishers_of
from rtron.wire.ros2.interfaces import find_interface
from rtron.wire.ros2.session import Ros2Session

pytestmark = [
    pytest.mark.ros2,
    pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning"),
]
TOPIC, EMPTY = "/words", b"\0\1\0\0\0"
UNKNOWN = b"\xff" * 16
KEPT = QoSProfile(depth=8, durability=DurabilityPolicy.TRANSIENT_LOCAL)


@pytest.fixture
def session(ros2, monkeypatch):
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    with closing(Ros2Session(domain=ros2.domain)) as session:
        yield session


@pytest.fixture
def stranger(ros2, session):
    with closing(Ros2Session(domain=ros2.domain)) as stranger:
        yield stranger


@pytest.fixture
def ids(session):
    with closing(find_sender_ids(session.node("/guard"))) as ids:
        yield ids


def publisher(session, node):
    return session.node(node).create_publisher(find_interface("std_msgs/Empty").cls, TOPIC, KEPT)


class Reader:
    """Reads all that is on the topic."""

    def __init__(self, session, ids):
        cls = find_interface("std_msgs/Empty").cls
        node = session.node("/guard")
        self._subscription = node.create_subscription(cls, TOPIC, print, KEPT, raw=True)
        self._rcl = Rcl(ids)

    def senders(self, count):
        """Return the GIDs that so many messages come with."""
        gids = []

        def take():
            while taken := self._rcl.take(self._subscription.handle.pointer):
                gids.append(taken[1])
            return len(gids) >= count

        wait_for(take, what="the messages")
        return gids


def test_a_message_has_the_gid_that_its_sender_has_in_the_graph(session, stranger, ids):
    publishers = [
        publisher(stranger, "/a"),
        publisher(stranger, "/a"),
        publisher(session, "/guard"),
    ]
    for each in publishers:
        each.publish(EMPTY)
    expected = {each.gid for each in await_publishers(session.node("/guard"), TOPIC, 3)}
    assert len(expected) == 3
    assert set(Reader(session, ids).senders(3)) == expected


def test_who_was_there_before_the_guard_is_known_like_who_comes_later(session, stranger):
    early = publisher(stranger, "/a")
    await_publishers(session.node("/guard"), TOPIC, 1)
    with closing(find_sender_ids(session.node("/guard"))) as ids:
        late = publisher(stranger, "/a")
        for each in (early, late):
            each.publish(EMPTY)
        expected = {each.gid for each in await_publishers(session.node("/guard"), TOPIC, 2)}
        assert set(Reader(session, ids).senders(2)) == expected


def test_who_has_left_is_known_for_what_it_said_before(session, stranger, ids, monkeypatch):
    monkeypatch.setattr(cyclone_ids, "_MAX_LEFT", 1)
    reader, node = Reader(session, ids), session.node("/guard")
    gids = []
    for _ in range(3):
        made = publisher(stranger, "/a")
        gids += [each.gid for each in await_publishers(node, TOPIC, 1)]
        made.publish(EMPTY)
        assert reader.senders(1) == gids[-1:]
        made.publish(EMPTY)
        wait_for(lambda made=made: made.get_subscription_count(), what="the reader")
        made.wait_for_all_acked()
        stranger.node("/a").destroy_publisher(made)
        wait_for(lambda: not publishers_of(node, TOPIC), what="the end of the publisher")
        ids.update()
        assert reader.senders(1) == gids[-1:]
    assert len(set(gids)) == 3


def test_a_request_is_its_client_s_and_is_answered(session, stranger, ids):
    calls, node = ServiceCalls(ids), session.node("/guard")
    service = node.create_service(Empty, "/ask", lambda _request, response: response)
    client = stranger.node("/a").create_client(Empty, "/ask")
    wait_for(client.service_is_ready, what="the service")
    number = calls.send_request(client.handle, Empty.Request())
    request_id, _ = wait_for(
        lambda: calls.take_request(service.handle, Empty.Request), what="the request"
    )
    (found,) = wait_for(lambda: clients_of(node, "/ask"), what="the client")
    writer, found_number = request_id_parts(request_id)
    assert (writer[:12], found_number) == (found.participant, number)
    assert len(request_id) == ids.request_id_size
    calls.respond(service.handle, request_id, Empty.Response())
    answered = wait_for(
        lambda: calls.take_response(client.handle, Empty.Response), what="the response"
    )
    assert answered[0] == number


def test_an_answer_to_a_client_that_is_gone_is_no_error(session, ids):
    service = session.node("/guard").create_service(Empty, "/ask", print)
    ServiceCalls(ids).respond(service.handle, bytes(ids.request_id_size), Empty.Response())


def test_a_message_waits_until_its_sender_is_known(ros2, session, monkeypatch):
    with OnRos2(ros2) as world:
        ids, real = world.transport._context.sender_ids, world.transport.rcl._gid_of
        monkeypatch.setattr(
            world.transport.rcl, "_gid_of", lambda told: UNKNOWN[:8] + real(told)[8:]
        )
        heard, asked = [], []
        world.transport.subscribe(
            "/guard", "/text", "std_msgs/String", lambda _peer: heard.append, DEFAULT_INPUT
        )
        world.publisher("/talker", "/text", latched=True).say(world.text("kept"))
        (gid,) = (each.gid for each in await_publishers(world.session.node("/talker"), "/text", 1))
        monkeypatch.setattr(ids, "gid", lambda told: asked.append(told) or told)
        world.until(lambda: len(asked) > 2)
        assert heard == []
        assert set(asked) == {UNKNOWN[:8] + gid[8:]}
        monkeypatch.setattr(ids, "gid", lambda _told: gid)
        world.until(lambda: heard)
        assert heard == [world.text("kept")]


def test_an_rmw_with_ids_that_nobody_knows_is_refused(session, monkeypatch):
    monkeypatch.setattr(sender_ids, "_message_id", lambda _publisher: bytes(range(16)))
    with pytest.raises(SourceError, match="cannot tell senders apart with rmw_") as refused:
        find_sender_ids(session.node("/guard"))
    assert "RMW_IMPLEMENTATION" in refused.value.help


def test_an_rmw_whose_gids_name_no_participant_is_refused(session, monkeypatch):
    def hashed(*arguments):
        """Give each endpoint a GID of its own from the first byte on, as rmw_zenoh does."""
        ends = await_publishers(*arguments)
        return [replace(end, gid=bytes([at]) * 16) for at, end in enumerate(ends)]

    monkeypatch.setattr(sender_ids, "await_publishers", hashed)
    with pytest.raises(SourceError, match="cannot tell senders apart"):
        find_sender_ids(session.node("/guard"))
