"""What a subscriber of ROS 1 has taken, as the kernels tell it: to the byte, on this machine."""

from contextlib import suppress

import pytest
from raw_ros1 import RawSubscriber

from rtron.guard.transport.ros1 import subscriber_link
from rtron.wire.ros1 import network

pytestmark = [pytest.mark.ros1, pytest.mark.parametrize("world", ["ros1"], indirect=True)]
TOPIC, COUNT = "/commands", 5


def advertised(world):
    output = world.transport.advertise("/rtron/a", TOPIC, "std_msgs/String")
    output.learn_type(world.info())
    return output


def progress(world):
    (found,) = world.transport.subscriber_progress(TOPIC)
    return found


def drain(sock):
    with suppress(BlockingIOError):
        while sock.recv(1 << 20):
            pass


def test_a_few_small_messages_that_nobody_reads_are_seen_until_they_are_read(world):
    output, message = advertised(world), world.text("go")
    with RawSubscriber(world.transport.port) as base:
        base.ask(TOPIC, callerid="/base", type="std_msgs/String", md5sum=world.info().md5sum)
        world.until(lambda: output.is_subscribed_by("/base"))
        base.frame()
        world.until(lambda: not progress(world).is_awaited)
        before = progress(world).taken
        for _ in range(COUNT):
            output.publish(message)
            world.loop.step(0)
        world.until(lambda: progress(world).taken == before)
        assert progress(world).is_awaited
        for _ in range(COUNT):
            assert base.frame() == message
        world.until(lambda: not progress(world).is_awaited)
        assert progress(world).taken == before + COUNT * len(message)
        assert progress(world).node == "/base"
    world.until(lambda: not world.transport.subscriber_progress(TOPIC))


def test_where_the_kernel_does_not_tell_what_waits_elsewhere_its_own_queue_counts(
    world, monkeypatch
):
    monkeypatch.setattr(network, "NETLINK_SOCK_DIAG", 255)
    queues = subscriber_link.KernelQueues()
    output, large = advertised(world), world.text("x" * (1 << 24))
    with RawSubscriber(world.transport.port) as base:
        base.ask(TOPIC, callerid="/base", type="std_msgs/String", md5sum=world.info().md5sum)
        world.until(lambda: output.is_subscribed_by("/base"))
        base.frame()
        output.publish(large)
        (link,) = world.transport._publications[TOPIC].links
        assert link.progress(queues).is_awaited
        base.socket.settimeout(0)
        world.until(lambda: drain(base.socket) or not link.progress(queues).is_awaited)
    queues.close()


def test_how_far_a_subscriber_is_may_not_be_known(world):
    output = advertised(world)
    with RawSubscriber(world.transport.port) as base:
        base.ask(TOPIC, callerid="/base", type="std_msgs/String", md5sum=world.info().md5sum)
        world.until(lambda: output.is_subscribed_by("/base"))
        base.frame()
        world.until(lambda: not progress(world).is_awaited)
        output.publish(world.text("go"))
        (link,) = world.transport._publications[TOPIC].links
        queues = subscriber_link.KernelQueues()
        queues._diag.close()
        assert link.progress(queues).taken is None
        base.frame()
        world.until(lambda: not progress(world).is_awaited)


def test_of_a_topic_that_is_not_ours_nothing_is_told(world):
    assert list(world.transport.subscriber_progress("/other")) == []
