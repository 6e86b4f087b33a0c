"""Bags that the real `rosbag record` wrote of real nodes."""

import pytest
from bag_files import SECOND
from harness import wait_for

from rtron.sources.bag.formats import open_bag
from rtron.sources.bag.graph import BagSource
from rtron.vocabulary import Durability

pytestmark = pytest.mark.ros1

RATE = ("-r", "50")


def record(ros1, *arguments):
    """Record two publishers of one topic and a latched one; return the bag."""
    bag = ros1.folder / "run.bag"
    recorder = ros1.spawn("rosbag", "record", "-a", "-O", bag, *arguments, "__name:=recorder")
    ros1.wait_for_nodes("/recorder")
    for name in ("one", "two"):
        command = ("rostopic", "pub", *RATE, "/chatter", "std_msgs/String")
        ros1.spawn(*command, f"data: {name}", f"__name:={name}")
    ros1.spawn("rostopic", "pub", "-l", "/latched", "std_msgs/String", "data: x", "__name:=latched")
    ros1.wait_for_nodes("/one", "/two", "/latched")
    for node, topic in (("/one", "/chatter"), ("/two", "/chatter"), ("/latched", "/latched")):
        wait_for(lambda node=node, topic=topic: ros1.connected(node, "/recorder", topic))
    wait_for(lambda: ros1.sent("/one", "/chatter") > 50, what="messages")
    recorder.stop()
    wait_for(bag.exists, what="the bag, which the recorder's child closes")
    return bag


@pytest.mark.parametrize("packed", [[], ["--bz2"], ["--lz4"]])
def test_publishers_are_named(ros1, packed):
    bag = record(ros1, *packed)
    graph = BagSource(bag).read()
    assert {each.node for each in graph.publishers("/chatter")} == {"/one", "/two"}
    (latched,) = graph.publishers("/latched")
    assert (latched.node, latched.type) == ("/latched", "std_msgs/String")
    assert latched.qos.durability is Durability.TRANSIENT_LOCAL
    assert all(each.implicit for each in graph.endpoints if each.topic.startswith("/rosout"))

    reading = open_bag(bag)
    messages = list(reading)
    said = {(each.callerid, data[4:]) for _, each, data in messages if each.topic == "/chatter"}
    assert said == {("/one", b"one"), ("/two", b"two")}
    times = [time for time, *_ in messages]
    assert times == sorted(times)
    assert times[0] > 10**9 * SECOND
    assert "string data" in next(e for e in reading.connections if e.topic == "/chatter").definition
