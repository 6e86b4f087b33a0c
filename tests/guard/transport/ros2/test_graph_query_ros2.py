"""Who is on a topic, as rcl tells it: the same as rclpy tells, whatever QoS there is."""

import sys
from contextlib import closing

import pytest
from harness import wait_for

pytest.importorskip("rclpy", reason="needs ROS 2")
from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy
from rmw_marks import needs_fast_dds
from ros2_harness import NODES2

from rtron.guard.transport.ros2.graph_query import GraphQuery
from rtron.guard.transport.ros2.participants import MAX_ENDPOINTS
from rtron.vocabulary import Direction
from rtron.wire.ros2.endpoints import await_publishers, publishers_of, subscribers_of
from rtron.wire.ros2.interfaces import find_interface
from rtron.wire.ros2.session import Ros2Session

pytestmark = [
    pytest.mark.ros2,
    pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning"),
]
PROFILES = [
    QoSProfile(depth=7),
    QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT),
    QoSProfile(depth=3, durability=DurabilityPolicy.TRANSIENT_LOCAL),
    QoSProfile(
        depth=2,
        deadline=Duration(seconds=2, nanoseconds=7),
        lifespan=Duration(seconds=3),
        liveliness=LivelinessPolicy.MANUAL_BY_TOPIC,
        liveliness_lease_duration=Duration(seconds=4),
    ),
]


@pytest.fixture
def session(ros2, monkeypatch):
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    with closing(Ros2Session(domain=ros2.domain)) as session:
        yield session


def by_gid(ends):
    return tuple(sorted(ends, key=lambda end: end.gid))


def test_it_tells_what_rclpy_tells(session):
    nodes = [session.node(f"/space/node{n}") for n in range(3)]
    kind = find_interface("geometry_msgs/Twist").cls
    for profile in PROFILES:
        nodes[0].create_publisher(kind, "/topic", profile)
        nodes[1].create_subscription(kind, "/topic", lambda _message: None, profile)
    listing = GraphQuery(nodes[2])
    await_publishers(nodes[2], "/topic", len(PROFILES))
    wait_for(
        lambda: len(subscribers_of(nodes[2], "/topic")) == len(PROFILES), what="who subscribes"
    )
    told = {side: listing.endpoints("/topic", side, ()) for side in Direction}
    assert told[Direction.PUBLISH] == by_gid(publishers_of(nodes[2], "/topic"))
    assert told[Direction.SUBSCRIBE] == by_gid(subscribers_of(nodes[2], "/topic"))
    assert [len(each) for each in told.values()] == [4, 4]
    assert len({end.qos for end in told[Direction.PUBLISH]}) == 4
    assert listing.endpoints("/nothing", Direction.PUBLISH, ()) == ()
    own = session.participant("/space/node2")
    assert listing.endpoints("/topic", Direction.PUBLISH, (), own) == ()


def test_the_ends_of_services_are_told_by_their_middlewares_names(session):
    services = pytest.importorskip("std_srvs.srv", reason="needs std_srvs of ROS 2")
    node, trigger = session.node("/server"), services.Trigger
    node.create_service(trigger, "/go", lambda _request, response: response)
    listing = GraphQuery(node, raw=True)
    (end,) = wait_for(
        lambda: listing.endpoints("rq/goRequest", Direction.SUBSCRIBE, ()), what="the server"
    )
    assert (end.node, end.type) == ("/server", "std_srvs::srv::dds_::Trigger_Request_")
    assert GraphQuery(node).endpoints("rq/goRequest", Direction.SUBSCRIBE, ()) == ()


def test_of_a_crowd_it_tells_of_some_and_of_those_that_are_known(session):
    node, kind = session.node("/crowd"), find_interface("std_msgs/String").cls
    listing, crowd = (
        GraphQuery(node),
        [node.create_publisher(kind, "/t", 1) for _ in range(MAX_ENDPOINTS)],
    )
    await_publishers(node, "/t", len(crowd))
    first = listing.endpoints("/t", Direction.PUBLISH, ())
    crowd += [node.create_publisher(kind, "/t", 1) for _ in range(MAX_ENDPOINTS)]
    last = by_gid(await_publishers(node, "/t", len(crowd)))[-9:]
    found = listing.endpoints("/t", Direction.PUBLISH, last)
    assert len(first) == len(found) == MAX_ENDPOINTS
    assert set(last) <= set(found)


PROFILE = """<dds xmlns="http://www.eprosima.com"><profiles>
<participant profile_name="own" is_default_profile="true">
<rtps><prefix>ff.01.02.03.04.05.06.07.08.09.0a.0b</prefix></rtps>
</participant></profiles></dds>"""


@needs_fast_dds("a profile of Fast DDS chooses the id")
def test_who_chooses_an_odd_id_is_told_like_anybody(ros2, session, tmp_path):
    profile = tmp_path / "profile.xml"
    profile.write_text(PROFILE)
    files = dict.fromkeys(("FASTDDS", "FASTRTPS"), str(profile))
    environ = {f"{name}_DEFAULT_PROFILES_FILE": file for name, file in files.items()}
    ros2.spawn(sys.executable, NODES2 / "node_group.py", "/odd", ">/t:std_msgs/String", **environ)
    listing = GraphQuery(session.node("/node"))

    def told():
        return [end.gid[:1] for end in listing.endpoints("/t", Direction.PUBLISH, ())]

    wait_for(told, what="the publisher")
    assert told() == [b"\xff"]
