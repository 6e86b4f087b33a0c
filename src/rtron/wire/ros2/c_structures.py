"""C structures of rcutils and rmw that several of our calls share, and C functions with types."""

from __future__ import annotations

import ctypes
from ctypes import Structure, c_bool, c_char_p, c_int, c_size_t, c_uint64, c_void_p, py_object
from typing import Any


class Allocator(Structure):
    """rcutils_allocator_t: five pointers."""

    _fields_ = (("calls", c_void_p * 5),)


class RmwTime(Structure):
    """rmw_time_t."""

    _fields_ = (("sec", c_uint64), ("nsec", c_uint64))


class QosProfile(Structure):
    """rmw_qos_profile_t; `raw_name` is avoid_ros_namespace_conventions."""

    _fields_ = (
        ("history", c_int),
        ("depth", c_size_t),
        ("reliability", c_int),
        ("durability", c_int),
        ("deadline", RmwTime),
        ("lifespan", RmwTime),
        ("liveliness", c_int),
        ("lease", RmwTime),
        ("raw_name", c_bool),
    )


def typed_function(function: Any, result: Any, *arguments: Any) -> Any:  # noqa: ANN401 - ctypes
    """Return a C function that knows its types."""
    function.restype, function.argtypes = result, arguments
    return function


def capsule_pointer(capsule: object) -> int:
    """Return the pointer in a capsule of Python, as rosidl's generated classes keep theirs."""
    name = typed_function(ctypes.pythonapi.PyCapsule_GetName, c_char_p, py_object)
    pointer = typed_function(ctypes.pythonapi.PyCapsule_GetPointer, c_void_p, py_object, c_char_p)
    found: int = pointer(capsule, name(capsule))
    return found


def default_allocator() -> Allocator:
    """Return what rcl and rmw get their memory from."""
    utils = ctypes.CDLL("librcutils.so")
    found: Allocator = typed_function(utils.rcutils_get_default_allocator, Allocator)()
    return found
