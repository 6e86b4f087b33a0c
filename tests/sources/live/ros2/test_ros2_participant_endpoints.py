"""What participants say of their own nodes: read whole, compared with what the domain shows."""

from contextlib import closing

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2")

from harness import wait_for
from rclpy.serialization import serialize_message
from rmw_dds_common.msg import Gid, NodeEntitiesInfo, ParticipantEntitiesInfo
from ros2_harness import Ros2

from rtron.errors import WireError
from rtron.sources.live.ros2.domain import DomainReader
from rtron.wire.ros2.discovery_info import DiscoveryInfoReader, parse_discovery_info
from rtron.wire.ros2.endpoints import publishers_of, subscribers_of
from rtron.wire.ros2.session import Ros2Session

pytestmark = pytest.mark.ros2


def gid(number):
    made = Gid()
    made.data = [number] * len(made.data)
    return made


def word(*nodes):
    """Return a participant's word: of each node the numbers of its readers and writers."""
    told = [
        NodeEntitiesInfo(
            node_namespace="/",
            node_name="n",
            reader_gid_seq=[gid(each) for each in readers],
            writer_gid_seq=[gid(each) for each in writers],
        )
        for readers, writers in nodes
    ]
    return serialize_message(ParticipantEntitiesInfo(gid=gid(1), node_entities_info_seq=told))


def gids(*numbers):
    return frozenset(bytes([number]) * 16 for number in numbers)


@pytest.mark.parametrize(
    ("nodes", "expected"),
    [((), gids()), ((((), ()),), gids()), ((((2,), (3, 4)), ((5,), ())), gids(2, 3, 4, 5))],
)
def test_a_word_tells_whose_it_is_and_all_the_ends(nodes, expected):
    assert parse_discovery_info(word(*nodes)) == (bytes([1]) * 16, expected)


@pytest.mark.parametrize("cut", range(0, 78, 7))
def test_what_is_no_word_is_refused(cut):
    with pytest.raises(WireError):
        parse_discovery_info(word(((2,), (3,)))[:cut])


def test_a_word_that_claims_more_than_it_says_is_refused():
    message = bytearray(word())
    message[-4:] = b"\xff\xff\xff\x7f"
    with pytest.raises(WireError):
        parse_discovery_info(bytes(message))


@pytest.fixture(scope="module")
def app(tmp_path_factory):
    with Ros2(tmp_path_factory.mktemp("claims")) as ros2:
        ros2.node(
            "node_group.py", "/robot/nav", ">/cmd_vel:geometry_msgs/Twist", "</map:std_msgs/String"
        )
        yield ros2


@pytest.fixture
def session(app):
    with closing(Ros2Session(app.domain)) as session:
        yield session


def ends_of(session):
    node = session.node("/_asking")
    ends = (*publishers_of(node, "/cmd_vel"), *subscribers_of(node, "/map"))
    return {end.gid for end in ends}


def test_the_ends_of_an_app_are_claimed_by_it(session):
    with closing(DiscoveryInfoReader(session.node("/_asking"))) as claims:
        wait_for(lambda: len(ends_of(session)) == 2 and ends_of(session) <= claims.gids())


def test_when_all_is_shown_nothing_is_owed(session):
    with closing(DomainReader(session, "/_asking")) as domain:
        wait_for(lambda: len(ends_of(session)) == 2 and domain.snapshot(60.0).is_complete)


def test_what_is_claimed_and_not_shown_is_owed(session, monkeypatch):
    with closing(DomainReader(session, "/_asking")) as domain:
        wait_for(lambda: domain.snapshot(60.0).is_complete)
        monkeypatch.setattr(DiscoveryInfoReader, "gids", lambda _: gids(7))
        seen = domain.snapshot(60.0)
    assert (seen.missing_endpoints, seen.is_complete) == (1, False)
