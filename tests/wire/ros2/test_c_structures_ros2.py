"""The structures are as the C headers of the ROS 2 that is installed here lay them out."""

import ctypes
import subprocess

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2")

from rtron.guard.transport.ros2 import rcl, service_calls
from rtron.messages.ros2.installed_types import install_prefixes
from rtron.wire.ros2 import c_structures

pytestmark = pytest.mark.ros2

HEADERS = (
    "rcl/types.h",
    "rmw/ret_types.h",
    "rmw/types.h",
    "rmw/topic_endpoint_info_array.h",
    "rcutils/types/uint8_array.h",
)
NAMES = {
    "TypeHash": ("rosidl_type_hash_t", {}),
    "QosProfile": (
        "rmw_qos_profile_t",
        {"lease": "liveliness_lease_duration", "raw_name": "avoid_ros_namespace_conventions"},
    ),
    "EndpointInfo": (
        "rmw_topic_endpoint_info_t",
        {
            "node": "node_name",
            "space": "node_namespace",
            "type": "topic_type",
            "hash": "topic_type_hash",
            "kind": "endpoint_type",
            "gid": "endpoint_gid",
            "qos": "qos_profile",
        },
    ),
    "EndpointInfoArray": ("rmw_topic_endpoint_info_array_t", {"infos": "info_array"}),
    "MessageInfo": (
        "rmw_message_info_t",
        {
            "implementation": "publisher_gid.implementation_identifier",
            "gid": "publisher_gid.data",
            "reserve": "",
        },
    ),
    "RequestId": ("rmw_request_id_t", {"guid": "writer_guid", "number": "sequence_number"}),
    "ServiceInfo": ("rmw_service_info_t", {}),
    "SerializedMessage": (
        "rcutils_uint8_array_t",
        {"length": "buffer_length", "capacity": "buffer_capacity"},
    ),
    "RmwTime": ("rmw_time_t", {}),
    "Allocator": ("rcutils_allocator_t", {"calls": "allocate"}),
}
"""Each structure's name in C, and those of its fields that have another name there."""
CODES = (
    "RCL_RET_SUBSCRIPTION_TAKE_FAILED",
    "RCL_RET_CLIENT_TAKE_FAILED",
    "RCL_RET_SERVICE_TAKE_FAILED",
    "RMW_RET_TIMEOUT",
    "RMW_GID_STORAGE_SIZE",
)


def fields_of(name):
    """Yield the fields of a structure that C has too, each with its name in C."""
    for field, _ in getattr(c_structures, name)._fields_:
        if in_c := NAMES[name][1].get(field, field):
            yield field, in_c


def program():
    """Return C that prints the size and the offsets of each structure, then the codes."""
    lines = [f"#include <{header}>" for header in HEADERS]
    lines += ["#include <stddef.h>", "#include <stdio.h>", "int main(void) {"]
    for name, (in_c, _) in NAMES.items():
        lines.append(f'printf("{name} %zu\\n", sizeof({in_c}));')
        lines += [
            f'printf("{name}.{field} %zu\\n", offsetof({in_c}, {c_field}));'
            for field, c_field in fields_of(name)
        ]
    lines += [f'printf("{code} %d\\n", (int){code});' for code in CODES]
    return "\n".join([*lines, "return 0; }"])


@pytest.fixture(scope="module")
def in_c(tmp_path_factory):
    """Return what C says, by name."""
    folder = tmp_path_factory.mktemp("structures")
    source, binary = folder / "structures.c", folder / "structures"
    source.write_text(program())
    packages = (path for prefix in install_prefixes() for path in (prefix / "include").glob("*"))
    subprocess.run(["gcc", *(f"-I{path}" for path in packages), source, "-o", binary], check=True)
    printed = subprocess.run([binary], check=True, capture_output=True, text=True).stdout
    return {name: int(number) for name, number in map(str.split, printed.splitlines())}


@pytest.mark.parametrize("name", NAMES)
def test_sizes_and_offsets_are_those_of_the_headers(in_c, name):
    structure = getattr(c_structures, name)
    offsets = {field: getattr(structure, field).offset for field, _ in fields_of(name)}
    assert offsets == {field: in_c[f"{name}.{field}"] for field in offsets}
    if name == "MessageInfo":
        assert ctypes.sizeof(structure) > in_c[name]
    else:
        assert ctypes.sizeof(structure) == in_c[name]


def test_codes_are_those_of_the_headers(in_c):
    *take_failed, timeout, gid_size = (in_c[code] for code in CODES)
    assert take_failed[0] == rcl._NO_MESSAGE
    assert frozenset(take_failed) == service_calls._NO_MESSAGE
    assert timeout == service_calls._TIMED_OUT
    assert gid_size == c_structures.GID_SIZE
