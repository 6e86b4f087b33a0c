"""What a stranger can say in a ROS 2 domain that rclpy would not let it say.

Names that are no UTF-8 and no names (rmw checks only what follows ROS's conventions), and types
whose hash is another than that of the type installed here (rosidl_runtime_c, rmw/types.h).
"""

import ctypes
import struct
from contextlib import contextmanager
from ctypes import (
    CFUNCTYPE,
    POINTER,
    Structure,
    c_bool,
    c_char_p,
    c_int,
    c_size_t,
    c_uint8,
    c_uint64,
    c_void_p,
    py_object,
)
from functools import partial

from harness import wait_for
from rmw_dds_common.msg import ParticipantEntitiesInfo

from rtron.wire.ros2.endpoints import PARTICIPANT_SIZE, publishers_of
from rtron.wire.ros2.session import rmw_identifier

_FRONT = b"\0\1\0\0"
_OF_PARTICIPANT = b"\0\0\1\xc1"
"""The entity id of a participant itself (DDSI-RTPS 2.5, 9.3.1.3)."""
_KEEP_LAST, _RELIABLE, _TRANSIENT_LOCAL, _AUTOMATIC = 1, 1, 1, 1
_HASH = CFUNCTYPE(c_void_p, c_void_p)
_FIND = CFUNCTYPE(c_void_p, c_void_p, c_char_p)
_alive = []
"""What C code holds pointers to."""


class _Time(Structure):
    _fields_ = (("sec", c_uint64), ("nsec", c_uint64))


class _Qos(Structure):
    _fields_ = (
        ("history", c_int),
        ("depth", c_size_t),
        ("reliability", c_int),
        ("durability", c_int),
        ("deadline", _Time),
        ("lifespan", _Time),
        ("liveliness", c_int),
        ("lease", _Time),
        ("avoid_ros_namespace_conventions", c_bool),
    )


class _Options(Structure):
    _fields_ = (("payload", c_void_p), ("unique_flow", c_int))


class _Serialized(Structure):
    _fields_ = (
        ("buffer", c_char_p),
        ("length", c_size_t),
        ("capacity", c_size_t),
        ("allocator", c_void_p * 5),
    )


class _TypeHash(Structure):
    _fields_ = (("version", c_uint8), ("value", c_uint8 * 32))


class _TypeSupport(Structure):
    _fields_ = (
        ("identifier", c_char_p),
        ("data", c_void_p),
        ("find", c_void_p),
        ("hash", c_void_p),
        ("description", c_void_p),
        ("sources", c_void_p),
    )


class Forger:
    """Speaks past rcl as one of a session's nodes; close it before the session."""

    def __init__(self, node):
        rcl, self._rmw = ctypes.CDLL("librcl.so"), ctypes.CDLL(f"lib{rmw_identifier()}.so")
        rcl.rcl_node_get_rmw_handle.restype = c_void_p
        rcl.rcl_node_get_rmw_handle.argtypes = (c_void_p,)
        self._node = node
        self._place = rcl.rcl_node_get_rmw_handle(node.handle.pointer)
        self._options = ctypes.CDLL("librmw.so").rmw_get_default_publisher_options
        self._options.restype = _Options
        self._publishers = []

    def close(self):
        """End all publishers."""
        destroy = self._rmw.rmw_destroy_publisher
        destroy.argtypes = (c_void_p, c_void_p)
        for publisher in self._publishers:
            assert destroy(self._place, publisher) == 0

    def publisher(self, cls, topic):
        """Publish a topic of these very bytes, as DDS has it: ROS's begin with `rt/`."""
        qos = _Qos(
            history=_KEEP_LAST,
            depth=1,
            reliability=_RELIABLE,
            durability=_TRANSIENT_LOCAL,
            liveliness=_AUTOMATIC,
            avoid_ros_namespace_conventions=True,
        )
        options = self._options()
        create = self._rmw.rmw_create_publisher
        create.restype = c_void_p
        create.argtypes = (c_void_p, c_void_p, c_char_p, POINTER(_Qos), POINTER(_Options))
        made = create(self._place, _support(cls), topic, ctypes.byref(qos), ctypes.byref(options))
        assert made, topic
        self._publishers.append(made)
        return made

    def calls(self, node, name, topic, *others):
        """Return what tells the domain that a node's publisher of `topic` is of node `name`.

        ROS tells the truth now and then: it has to be said again. `others` are nodes of the same
        participant; without them it has none but this.
        """
        end = wait_for(partial(self._publisher_of, node, topic), what=f"the publisher of {node}")
        gid = end.gid[:PARTICIPANT_SIZE] + _OF_PARTICIPANT
        nodes = _string(b"/") + _string(name) + struct.pack("<II", 0, 1) + end.gid
        for other in others:
            nodes += _string(b"/") + _string(other) + struct.pack("<II", 0, 0)
        message = _FRONT + gid + struct.pack("<I", 1 + len(others)) + nodes
        publisher = self.publisher(ParticipantEntitiesInfo, b"ros_discovery_info")
        return partial(self._publish, publisher, message)

    def _publisher_of(self, node, topic):
        """Return a node's publisher, None while the domain has not told it."""
        found = publishers_of(self._node, topic)
        return next((each for each in found if each.node == node), None)

    def _publish(self, publisher, message):
        out = _Serialized(buffer=message, length=len(message), capacity=len(message))
        publish = self._rmw.rmw_publish_serialized_message
        publish.argtypes = (c_void_p, c_void_p, c_void_p)
        assert publish(publisher, ctypes.byref(out), None) == 0


@contextmanager
def another_version(cls):
    """Let whoever is made with a message class meanwhile tell another hash of its type.

    An RMW asks the type support that it is given (Fast DDS), or the one of its own that this finds.
    """
    meta = type(cls)
    real = meta._TYPE_SUPPORT
    other = _TypeHash(version=1, value=(c_uint8 * 32)(*range(32)))
    tell = _HASH(lambda _support: ctypes.addressof(other))
    support = _with_hash(_support(cls), tell)
    real_find = _FIND(support.find)

    def find_other(place, identifier):
        found = real_find(place, identifier)
        return found and ctypes.addressof(_with_hash(found, tell))

    find = _FIND(find_other)
    support.find = ctypes.cast(find, c_void_p).value
    _alive.extend((other, tell, find))
    new = ctypes.pythonapi.PyCapsule_New
    new.restype, new.argtypes = py_object, (c_void_p, c_char_p, c_void_p)
    meta._TYPE_SUPPORT = new(ctypes.addressof(support), _name(real), None)
    try:
        yield
    finally:
        meta._TYPE_SUPPORT = real


def _with_hash(address, tell):
    """Return a copy of a type support that tells another hash."""
    support = _TypeSupport.from_buffer_copy(_TypeSupport.from_address(address))
    support.hash = ctypes.cast(tell, c_void_p).value
    _alive.append(support)
    return support


def _support(cls):
    meta = type(cls)
    if meta._TYPE_SUPPORT is None:
        meta.__import_type_support__()
    point = ctypes.pythonapi.PyCapsule_GetPointer
    point.restype, point.argtypes = c_void_p, (py_object, c_char_p)
    return point(meta._TYPE_SUPPORT, _name(meta._TYPE_SUPPORT))


def _name(capsule):
    name = ctypes.pythonapi.PyCapsule_GetName
    name.restype, name.argtypes = c_char_p, (py_object,)
    return name(capsule)


def _string(text):
    """Return a string of CDR, filled to 4 bytes."""
    data = text + b"\0"
    return struct.pack("<I", len(data)) + data + bytes(-len(data) % 4)
