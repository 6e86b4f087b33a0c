"""The guard's transport in a ROS 2 domain, and nodes of rclpy that stand outside."""

from harness import LIMIT_S
from rclpy.duration import Duration
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile
from transport_worlds import RosWorld

from rtron.guard.transport.ros2.middleware import Ros2Transport
from rtron.messages.common.encoding import Encoding
from rtron.wire.ros2.endpoints import publishers_of, subscribers_of
from rtron.wire.ros2.interfaces import find_interface
from rtron.wire.ros2.session import Ros2Session

DEPTH = 1000


class OnRos2(RosWorld):
    """A domain of the test's own; the outside nodes are one participant, the guard another."""

    encoding = Encoding.CDR
    most_waiting = 100

    def __init__(self, ros2):
        super().__init__()
        self.session = Ros2Session(domain=ros2.domain)
        self.transport = Ros2Transport(self.loop, Ros2Session(domain=ros2.domain))
        self._executor = SingleThreadedExecutor(context=self.session.context)
        self._nodes = {}

    def __exit__(self, *_):
        self._executor.shutdown()
        self.transport.close()
        self.session.close()
        self.end()

    def text(self, text):
        """Return a text as a network brings it: padded to words of 4 octets (RTPS)."""
        message = super().text(text)
        return message + bytes(-len(message) % 4)

    def let_arrive(self, publisher):
        assert publisher.is_acknowledged(LIMIT_S)

    def serve(self):
        self._executor.spin_once(timeout_sec=0)

    def publisher(self, node, topic, type="std_msgs/String", *, latched=False):
        made = self._node(node).create_publisher(find_interface(type).cls, topic, _profile(latched))
        return Ros2Publisher(self._node(node), made)

    def listener(self, node, topic, *, latched=False):
        heard = []
        cls = find_interface("std_msgs/String").cls
        self._node(node).create_subscription(cls, topic, heard.append, _profile(latched), raw=True)
        return heard

    def shows(self, publisher, subscriber, topic):
        node = self._node("/looks")
        told = {each.node for each in publishers_of(node, topic)}
        return publisher in told and subscriber in {e.node for e in subscribers_of(node, topic)}

    def _node(self, name):
        if name not in self._nodes:
            self._nodes[name] = self.session.node(name)
            self._executor.add_node(self._nodes[name])
        return self._nodes[name]


class Ros2Publisher:
    """Speaks raw bytes."""

    def __init__(self, node, publisher):
        self._node, self._publisher = node, publisher

    @property
    def readers(self):
        """How many readers DDS has matched."""
        return self._publisher.get_subscription_count()

    def say(self, message):
        self._publisher.publish(message)

    def is_acknowledged(self, limit_s):
        """Return whether every reader has all that was said, in that time."""
        return self._publisher.wait_for_all_acked(Duration(seconds=limit_s))

    def leave(self):
        self._node.destroy_publisher(self._publisher)


def _profile(latched):
    kept = DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE
    return QoSProfile(depth=DEPTH, durability=kept)
