"""What a topic of the guard on ROS 2 says before its successors are there."""

import pytest

from rtron.guard.transport.common.protocol import OutputOptions
from rtron.vocabulary import SECOND, QoS, Reliability

pytest.importorskip("rclpy", reason="needs ROS 2")
from rtron.guard.transport.ros2 import publication

pytestmark = [
    pytest.mark.ros2,
    pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning"),
    pytest.mark.filterwarnings("ignore:Deprecated in favor of:DeprecationWarning"),
    pytest.mark.parametrize("world", ["ros2"], indirect=True),
]
TOPIC, DRIVER, TOOL = "/rtron/cmd/out", "/driver", "/tool"


@pytest.fixture
def output(world):
    output = world.transport.advertise(
        "/rtron/a", TOPIC, "std_msgs/String", OutputOptions(successors=(DRIVER,))
    )
    output.learn_type(world.info())
    output.offer("one", QoS())
    return output


def listening(world, output, node):
    """Return what a node hears, once the guard knows that it listens."""
    heard = world.listener(node, TOPIC)
    world.until(lambda: output.is_subscribed_by(node))
    return heard


def test_a_tool_that_listens_does_not_end_the_waiting_for_the_successor(world, output, monkeypatch):
    monkeypatch.setattr(publication, "_EARLY_TIMEOUT", 100 * SECOND)
    tool = listening(world, output, TOOL)
    words = [world.text(number) for number in range(3)]
    for word in words:
        output.publish(word)
    driver = world.listener(DRIVER, TOPIC)
    world.until(lambda: len(driver) == len(tool) == len(words))
    assert driver == tool == words


def test_what_has_waited_too_long_for_the_successor_is_told_to_nobody(world, output):
    tool = listening(world, output, TOOL)
    output.publish(world.text("stale"))
    began = world.transport.now()
    world.until(lambda: world.transport.now() - began > SECOND)
    output.publish(world.text("live"))
    driver = listening(world, output, DRIVER)
    world.until(lambda: output.publish(world.text("last")) or driver)
    assert tool[0] == world.text("live")
    assert set(driver) == {world.text("last")}


def test_a_publisher_that_changes_its_qos_again_and_again_does_not_cut_off_the_successors(
    world, output, caplog
):
    output.offer("one", QoS(deadline=SECOND))
    strong = output._writer
    output.offer("one", QoS())
    output.offer("two", QoS(reliability=Reliability.BEST_EFFORT))
    assert output._writer is strong
    for sooner in range(100):
        output.offer("one", QoS(deadline=SECOND - sooner))
        last, count = output._writer, sooner
        if "changes its QoS again and again" in caplog.text:
            break
    assert count < 20
    output.offer("one", QoS(deadline=1))
    assert output._writer is last
    output.offer("three", QoS(lease=SECOND))
    assert output._writer is not last
    driver = listening(world, output, DRIVER)
    world.until(lambda: output.publish(world.text("on")) or driver)


def test_a_stop_is_offered_as_a_successor_asks_for_it_and_not_as_a_tool_does(world):
    output = world.transport.advertise("/rtron/a", TOPIC, "std_msgs/String")
    output.learn_type(world.info())
    output.offer("one", QoS())
    output.match_subscribers((DRIVER,))
    writer = output._writer
    world.listener(TOOL, TOPIC, latched=True)
    world.until(lambda: output.is_subscribed_by(TOOL))
    assert output._writer is writer
    heard = world.listener(DRIVER, TOPIC, latched=True)
    world.until(lambda: output.publish(world.text("stop")) or heard)
