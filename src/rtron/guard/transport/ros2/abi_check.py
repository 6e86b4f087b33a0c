"""Whether rcl and rmw lay out their structures as the guard reads them; checked as it starts.

The guard reads C structures at fixed offsets (`rtron.wire.ros2.c_structures`). In a release that
lays one out in another way it would take strangers for approved nodes, or old messages for new
ones. So it first reads endpoints, messages and requests of its own, of which it knows everything.
"""

from __future__ import annotations

import ctypes
import logging
import os
import select
import time
import uuid
from contextlib import ExitStack, closing, contextmanager
from ctypes import c_bool, c_int
from dataclasses import fields
from typing import TYPE_CHECKING, Any, TypeVar

from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy

from rtron.errors import SourceError, WireError
from rtron.guard.transport.ros2.graph_query import GraphQuery
from rtron.guard.transport.ros2.rcl import Rcl
from rtron.guard.transport.ros2.sender_ids import find_sender_ids
from rtron.guard.transport.ros2.service_calls import ServiceCalls, request_id_parts
from rtron.vocabulary import PRIVATE_ROOT, Direction
from rtron.wire.ros2.c_structures import typed_function
from rtron.wire.ros2.endpoints import PARTICIPANT_SIZE, Ros2Endpoint, await_publishers
from rtron.wire.ros2.interfaces import find_interface
from rtron.wire.ros2.rmw_version import HUMBLE, LYRICAL, release_name, rmw_version
from rtron.wire.ros2.session import rmw_identifier

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from rclpy.node import Node

    from rtron.guard.transport.ros2.sender_ids import SenderIds
    from rtron.wire.ros2.rmw_version import Version

log = logging.getLogger(__name__)

_Taken = TypeVar("_Taken")

_TIMEOUT_S = 5.0
_POLL_S = 0.005
_ENDPOINT_INFO = "rmw_topic_endpoint_info_t"
_MESSAGE_INFO = "rmw_message_info_t"
_SERVICE_INFO = "rmw_service_info_t"
_SEQUENCE_NUMBERS = 0
"""RMW_FEATURE_MESSAGE_INFO_PUBLICATION_SEQUENCE_NUMBER"""
_EMPTY_MESSAGE = b"\0\1\0\0\0"
_HELP = "use Humble, Jazzy, Kilted or Lyrical (rmw 6.1 to 7.10), or report which release this is"
_BUFFER_AWARE_RMW = "rmw_fastrtps_cpp"
_BUFFERS = (
    "%s: %s sends images and other types with uint8[] to topics of its own, which are not guarded "
    "and whose messages are dropped here: use Cyclone DDS, see docs/ros2.md"
)
_PROFILES = (
    QoSProfile(
        depth=7,
        deadline=Duration(seconds=2, nanoseconds=7),
        lifespan=Duration(seconds=3, nanoseconds=11),
        liveliness=LivelinessPolicy.MANUAL_BY_TOPIC,
        liveliness_lease_duration=Duration(seconds=4, nanoseconds=13),
    ),
    QoSProfile(
        depth=3,
        reliability=ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL,
    ),
)
"""Two profiles that differ in every value, and in which no value is that of the field beside it."""


def check_abi(node: Node) -> None:
    """Check all that the guard reads; SourceError, which names the structure, if one differs.

    What this makes at `node` is gone again when it returns.
    """
    check_endpoint_info(node)
    with closing(find_sender_ids(node)) as ids:
        try:
            participant = _check_message_info(node, ids)
            _check_service_info(node, participant, ids)
        except WireError as error:
            raise SourceError(f"{release_name(rmw_version())}: {error}", help=_HELP) from error


def check_endpoint_info(node: Node) -> None:
    """Check how the domain's endpoints are read; SourceError also if the release is too old."""
    version = rmw_version()
    if version and version < HUMBLE:
        raise SourceError(f"{release_name(version)} is older than ROS 2 Humble", help=_HELP)
    _warn_of_release(version)
    topic, cls = _unique_name(), find_interface("std_msgs/Empty").cls
    with ExitStack() as stack:
        for profile in _PROFILES:
            publisher = node.create_publisher(cls, topic, profile)
            stack.callback(node.destroy_publisher, publisher)
        expected = {each.gid: each for each in await_publishers(node, topic, len(_PROFILES))}
        _compare_endpoints(GraphQuery(node), topic, expected)


def _warn_of_release(version: Version | None) -> None:
    """Log what of a release was not tried, and what of it is known not to pass the guard."""
    if version is None or version > LYRICAL:
        log.warning("%s is not known: only its structures are checked", release_name(version))
    if (version is None or version >= LYRICAL) and rmw_identifier() == _BUFFER_AWARE_RMW:
        log.warning(_BUFFERS, release_name(version), _BUFFER_AWARE_RMW)


def _compare_endpoints(query: GraphQuery, topic: str, expected: dict[bytes, Ros2Endpoint]) -> None:
    """Compare with what rclpy says; no pointer is followed before every GID is where it belongs."""
    if sorted(query.gids(topic, Direction.PUBLISH)) != sorted(expected):
        raise _layout_error(_ENDPOINT_INFO, "endpoint_gid, or the size of an entry")
    for found in query.endpoints(topic, Direction.PUBLISH, ()):
        known = expected[found.gid]
        names = [*_differences(found.qos, known.qos), *_differences(found, known)]
        if names:
            raise _layout_error(_ENDPOINT_INFO, names[0])


def _differences(found: Any, expected: Any) -> Iterator[str]:  # noqa: ANN401 - a dataclass
    """Yield the names of the fields in which two objects differ."""
    names = (field.name for field in fields(found))
    return (name for name in names if getattr(found, name) != getattr(expected, name))


def _check_message_info(node: Node, ids: SenderIds) -> bytes:
    """Check what a message says of itself: who has sent it and when, and its number.

    Returns which participant `node` is in.
    """
    rcl, topic, cls = Rcl(ids), _unique_name(), find_interface("std_msgs/Empty").cls
    profile = QoSProfile(depth=2, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    with ExitStack() as stack:
        fd = stack.enter_context(_event_fd())
        publisher = node.create_publisher(cls, topic, profile)
        stack.callback(node.destroy_publisher, publisher)
        subscription = node.create_subscription(cls, topic, lambda _: None, profile, raw=True)
        stack.callback(node.destroy_subscription, subscription)
        (gid,) = (endpoint.gid for endpoint in await_publishers(node, topic, 1))
        source, target = publisher.handle.pointer, subscription.handle.pointer
        rcl.notify("subscription", subscription.handle, fd)
        _expect_nothing(rcl.take(target), _MESSAGE_INFO)
        for number in (1, 2):
            sent_at = time.time_ns()
            rcl.publish(source, _EMPTY_MESSAGE)
            _, found = _wait_for(lambda: rcl.take(target), fd, _MESSAGE_INFO)
            _compare_message_info(rcl, found == gid, number, sent_at)
    return gid[:PARTICIPANT_SIZE]


def _compare_message_info(rcl: Rcl, has_gid: bool, number: int, sent_at: int) -> None:  # noqa: FBT001
    """Compare what came with the message that was taken last with what is known of it."""
    if not has_gid:
        raise _layout_error(_MESSAGE_INFO, "publisher_gid")
    if rcl.sequence_number != (number if _has_sequence_numbers() else None):
        raise _layout_error(_MESSAGE_INFO, "publication_sequence_number")
    if not sent_at <= rcl.source_time <= time.time_ns():
        raise _layout_error(_MESSAGE_INFO, "source_timestamp")


def _has_sequence_numbers() -> bool:
    """Ask the RMW whether its messages have numbers (rmw/features.h, Humble and later)."""
    rmw = ctypes.CDLL(f"lib{rmw_identifier()}.so")
    return bool(typed_function(rmw.rmw_feature_supported, c_bool, c_int)(_SEQUENCE_NUMBERS))


def _check_service_info(node: Node, participant: bytes, ids: SenderIds) -> None:
    """Check whose a request is, and that its response finds the way back."""
    cls: Any = find_interface("rcl_interfaces/srv/GetParameters").cls
    rcl, calls, name = Rcl(ids), ServiceCalls(ids), _unique_name()
    with ExitStack() as stack:
        fd = stack.enter_context(_event_fd())
        service = node.create_service(cls, name, lambda _, response: response)
        stack.callback(node.destroy_service, service)
        client = node.create_client(cls, name)
        stack.callback(node.destroy_client, client)
        rcl.notify("service", service.handle, fd)
        rcl.notify("client", client.handle, fd)
        _wait_for(lambda: client.service_is_ready() or None, fd, _SERVICE_INFO)
        _expect_nothing(calls.take_request(service.handle, cls.Request), _SERVICE_INFO)
        _expect_nothing(calls.take_response(client.handle, cls.Response), _SERVICE_INFO)
        number = calls.send_request(client.handle, cls.Request())
        request_id, _ = _wait_for(
            lambda: calls.take_request(service.handle, cls.Request), fd, _SERVICE_INFO
        )
        guid, found = request_id_parts(request_id)
        if (guid[:PARTICIPANT_SIZE], found) != (participant, number):
            raise _layout_error(_SERVICE_INFO, "request_id of a request")
        calls.respond(service.handle, request_id, cls.Response())
        answered, _ = _wait_for(
            lambda: calls.take_response(client.handle, cls.Response), fd, _SERVICE_INFO
        )
        if answered != number:
            raise _layout_error(_SERVICE_INFO, "request_id of a response")


def _expect_nothing(taken: object, structure: str) -> None:
    """Check that rcl has a code for "there is nothing" which is the one that we know."""
    if taken is not None:
        raise _layout_error(structure, "something arrives that nobody has sent")


def _wait_for(take: Callable[[], _Taken | None], fd: int, structure: str) -> _Taken:
    """Return what `take` gives, once it gives something; the eventfd `fd` may say when."""
    until = time.monotonic() + _TIMEOUT_S
    while (taken := take()) is None:
        if time.monotonic() > until:
            raise _layout_error(structure, "nothing arrives")
        if select.select([fd], [], [], _POLL_S)[0]:
            os.eventfd_read(fd)
    return taken


@contextmanager
def _event_fd() -> Iterator[int]:
    fd = os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)
    try:
        yield fd
    finally:
        os.close(fd)


def _unique_name() -> str:
    """Return a name that nobody else can know."""
    return f"{PRIVATE_ROOT}/self_{uuid.uuid4().hex}"


def _layout_error(structure: str, what: str) -> SourceError:
    version = release_name(rmw_version())
    return SourceError(f"{version} lays out {structure} in another way: {what}", help=_HELP)
