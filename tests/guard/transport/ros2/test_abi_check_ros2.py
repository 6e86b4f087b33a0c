"""A ROS 2 whose structures are laid out in another way is refused before anything is guarded."""

import re
from contextlib import closing
from ctypes import Structure, c_uint64

import pytest
from harness import wait_for

pytest.importorskip("rclpy", reason="needs ROS 2")

from plans import plan_of
from rmw_marks import needs_fast_dds

from rtron.errors import SourceError
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.transport.factory import open_transport
from rtron.guard.transport.ros2.abi_check import check_abi, check_endpoint_info
from rtron.vocabulary import GUARD_NODE
from rtron.wire.ros2 import c_structures
from rtron.wire.ros2.domain_id import domain_address
from rtron.wire.ros2.session import Ros2Session

pytestmark = [
    pytest.mark.ros2,
    pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning"),
]
TRANSPORT = "rtron.guard.transport.ros2"


@pytest.fixture(autouse=True)
def local(monkeypatch):
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")


@pytest.fixture
def node(ros2):
    with closing(Ros2Session(domain=ros2.domain)) as session:
        yield session.node(GUARD_NODE)


def with_word_before(structure, field):
    """Return a structure that has 8 bytes more, before a field."""
    parts = list(structure._fields_)
    at = [name for name, _ in parts].index(field)
    return new_structure(structure, [*parts[:at], ("new", c_uint64), *parts[at:]])


def with_word_behind(structure):
    """Return a structure that has 8 bytes more, behind all fields: an array has another stride."""
    return new_structure(structure, [*structure._fields_, ("new", c_uint64)])


def swapped(structure, one, other):
    """Return a structure in which two fields of the same size have changed places."""
    names = {one: other, other: one}
    return new_structure(structure, [(names.get(n, n), kind) for n, kind in structure._fields_])


def new_structure(structure, parts):
    return type(structure.__name__, (Structure,), {"_fields_": tuple(parts)})


def break_endpoint_info(monkeypatch, info):
    """Let the guard read endpoints by another layout than rcl's."""
    monkeypatch.setattr(f"{TRANSPORT}.graph_query.endpoint_info", lambda version: info)


def endpoints_of(node):
    return (
        node.get_topic_names_and_types(),
        [*node.publishers, *node.subscriptions, *node.clients, *node.services],
    )


def test_what_is_installed_here_is_known_and_leaves_nothing_behind(node):
    wait_for(node.get_topic_names_and_types, what="the node's own topics")
    before = endpoints_of(node)
    check_abi(node)
    wait_for(lambda: endpoints_of(node) == before, what="the end of what was made")


def info_with_qos(qos):
    parts = dict(c_structures.EndpointInfo._fields_) | {"qos": qos}
    return new_structure(c_structures.EndpointInfo, parts.items())


INFO, QOS = c_structures.EndpointInfo, c_structures.QosProfile


@pytest.mark.parametrize(
    ("info", "field"),
    [
        (with_word_behind(INFO), "endpoint_gid, or the size of an entry"),
        (with_word_before(INFO, "gid"), "endpoint_gid, or the size of an entry"),
        (with_word_before(INFO, "hash"), "endpoint_gid, or the size of an entry"),
        (swapped(INFO, "node", "type"), "node"),
        (info_with_qos(swapped(QOS, "deadline", "lifespan")), "deadline"),
        (info_with_qos(swapped(QOS, "lifespan", "lease")), "lifespan"),
        (info_with_qos(swapped(QOS, "reliability", "durability")), "reliability"),
        (info_with_qos(swapped(QOS, "durability", "liveliness")), "liveliness"),
    ],
)
def test_another_endpoint_info_is_refused(node, monkeypatch, info, field):
    break_endpoint_info(monkeypatch, info)
    with pytest.raises(SourceError, match=f"rmw_topic_endpoint_info_t in another way: {field}"):
        check_endpoint_info(node)


MESSAGE, SERVICE = c_structures.MessageInfo, c_structures.ServiceInfo


@pytest.mark.parametrize(
    ("info", "field"),
    [
        (with_word_before(MESSAGE, "gid"), "publisher_gid"),
        (with_word_before(MESSAGE, "source_timestamp"), "publisher_gid"),
        (
            swapped(MESSAGE, "publication_sequence_number", "received_timestamp"),
            "publication_sequence_number",
        ),
        pytest.param(
            swapped(MESSAGE, "publication_sequence_number", "reception_sequence_number"),
            "publication_sequence_number",
            marks=needs_fast_dds("Cyclone DDS says of both numbers that it has none"),
        ),
        (swapped(MESSAGE, "source_timestamp", "reception_sequence_number"), "source_timestamp"),
    ],
)
def test_another_message_info_is_refused(node, monkeypatch, info, field):
    monkeypatch.setattr(f"{TRANSPORT}.rcl.MessageInfo", info)
    with pytest.raises(SourceError, match=f"rmw_message_info_t in another way: {field}"):
        check_abi(node)


def test_another_service_info_is_refused(node, monkeypatch):
    info = with_word_before(SERVICE, "request_id")
    monkeypatch.setattr(f"{TRANSPORT}.service_calls.ServiceInfo", info)
    with pytest.raises(SourceError, match="rmw_service_info_t in another way: request_id"):
        check_abi(node)


@pytest.mark.parametrize(
    ("constant", "value"), [("rcl._NO_MESSAGE", 402), ("service_calls._NO_MESSAGE", {402})]
)
def test_other_return_codes_are_refused(node, monkeypatch, constant, value):
    monkeypatch.setattr(f"{TRANSPORT}.{constant}", value)
    with pytest.raises(SourceError, match=r"rmw 7.*rcl cannot take .*: error [456]01"):
        check_abi(node)


def test_the_guard_does_not_start_and_says_what_to_do(ros2, monkeypatch):
    monkeypatch.setattr(f"{TRANSPORT}.rcl.MessageInfo", with_word_before(MESSAGE, "gid"))
    with closing(EventLoop()) as loop, pytest.raises(SourceError) as refused:
        open_transport(plan_of(ros=2), domain_address(ros2.domain), loop)
    assert str(refused.value).startswith("rmw 7.")
    assert "use Humble, Jazzy, Kilted or Lyrical" in refused.value.help


@pytest.fixture
def rmw(tmp_path, monkeypatch):
    """Return what lets another version of rmw be installed."""

    def install(version):
        folder = tmp_path / "share" / "rmw"
        folder.mkdir(parents=True)
        (folder / "package.xml").write_text(f"<package><version>{version}</version></package>")
        monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path))

    return install


def test_a_release_before_humble_is_refused_before_its_memory_is_read(node, rmw, monkeypatch):
    rmw("3.3.1")
    monkeypatch.setattr(f"{TRANSPORT}.abi_check.GraphQuery", None)
    with pytest.raises(SourceError, match=r"rmw 3\.3 is older than ROS 2 Humble"):
        check_endpoint_info(node)


def test_a_later_release_that_says_it_is_humble_is_refused(node, rmw):
    rmw("6.1.2")
    with pytest.raises(SourceError, match=r"rmw 6\.1 lays out rmw_topic_endpoint_info_t"):
        check_endpoint_info(node)


@pytest.mark.parametrize(
    ("version", "name"), [("7.11.0", "rmw 7.11"), ("8.0.1", "rmw 8.0"), ("?", "an unknown version")]
)
def test_a_release_that_is_not_known_is_checked_and_told(node, rmw, caplog, version, name):
    rmw(version)
    check_abi(node)
    assert (
        len(re.findall(f"{name}.* is not known: only its structures are checked", caplog.text)) == 1
    )


@pytest.mark.parametrize("version", ["7.1.0", "7.3.1", "7.8.2"])
def test_a_release_that_is_known_is_not_worth_a_word(node, rmw, caplog, version):
    rmw(version)
    check_abi(node)
    assert caplog.text == ""


@pytest.mark.parametrize(
    ("identifier", "count"), [("rmw_fastrtps_cpp", 1), ("rmw_cyclonedds_cpp", 0)]
)
def test_from_lyrical_on_fast_dds_sends_images_past_the_guard(
    node, rmw, caplog, monkeypatch, identifier, count
):
    rmw("7.10.1")
    monkeypatch.setattr(f"{TRANSPORT}.abi_check.rmw_identifier", lambda: identifier)
    check_endpoint_info(node)
    assert caplog.text.count("sends images and other types with uint8[]") == count
    assert "is not known" not in caplog.text
