"""What a slow subscriber of ROS 1 does not take is counted, also once it has left."""

import pytest
from raw_ros1 import RawSubscriber

from rtron.guard.transport.common.protocol import OutputOptions

pytestmark = [pytest.mark.ros1, pytest.mark.parametrize("world", ["ros1"], indirect=True)]
TOPIC = "/burst"
LARGE = "x" * (1 << 16)


def test_what_a_subscriber_does_not_take_is_counted(world):
    output = world.transport.advertise(
        "/rtron/a", TOPIC, "std_msgs/String", OutputOptions(queue_size=3)
    )
    info = world.info()
    output.learn_type(info)
    message = world.text(LARGE)
    with RawSubscriber(world.transport.port) as slow:
        slow.ask(TOPIC, callerid="/slow", type=info.type, md5sum=info.md5sum)
        world.until(lambda: output.is_subscribed_by("/slow"))
        assert output.lost == 0
        world.until(lambda: output.publish(message) or output.lost >= 5)
        lost = output.lost
    world.until(lambda: not output.is_subscribed_by("/slow"))
    assert lost <= output.lost <= lost + 3
