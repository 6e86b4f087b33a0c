"""RTron uses nothing that one of the releases it is for does not have, by the table of releases."""

import ast
import ctypes
from pathlib import Path

import pytest
import yaml
from ros_uses import SOURCE, structures, uses

from rtron.wire.ros2 import c_structures

TABLE = yaml.safe_load(Path(__file__).with_name("releases.yaml").read_text())
RELEASES = ("humble", "jazzy", "kilted", "lyrical")
READ = tuple(TABLE["versions"])
CONSTANTS = {
    "RCL_RET_SUBSCRIPTION_TAKE_FAILED": ("guard/transport/ros2/rcl.py", "_NO_MESSAGE"),
    "RMW_RET_TIMEOUT": ("guard/transport/ros2/service_calls.py", "_TIMED_OUT"),
    "RMW_QOS_POLICY_RELIABILITY_BEST_EFFORT": (
        "guard/transport/ros2/graph_query.py",
        "_BEST_EFFORT",
    ),
    "RMW_QOS_POLICY_DURABILITY_TRANSIENT_LOCAL": (
        "guard/transport/ros2/graph_query.py",
        "_TRANSIENT_LOCAL",
    ),
    "RMW_QOS_POLICY_LIVELINESS_MANUAL_BY_TOPIC": (
        "guard/transport/ros2/graph_query.py",
        "_MANUAL_BY_TOPIC",
    ),
    "RMW_QOS_POLICY_HISTORY_KEEP_LAST": ("wire/ros2/discovery_info.py", "_KEEP_LAST"),
    "RMW_QOS_POLICY_RELIABILITY_RELIABLE": ("wire/ros2/discovery_info.py", "_RELIABLE"),
}
"""Where the code has a constant of C."""


def lacking(release):
    """Return the uses that a release does not have, nor a replacement, each with its place."""
    return {
        " or ".join(sorted(names)): place
        for names, place in uses().items()
        if all(TABLE["uses"].get(name, {}).get(release) == "absent" for name in names)
    }


def test_the_table_names_all_that_is_used_and_nothing_else():
    used = {name: place for names, place in uses().items() for name in names}
    missing = {name: place for name, place in used.items() if name not in TABLE["uses"]}
    assert missing == {}, "look up in the sources of each release whether it has these"
    assert set(TABLE["uses"]) - set(used) == set()
    assert all(tuple(row) == RELEASES for row in TABLE["uses"].values())


@pytest.mark.parametrize("release", RELEASES)
def test_what_is_used_is_in_every_release(release):
    assert lacking(release) == {}
    unread = [name for name, row in TABLE["uses"].items() if row[release] == "unchecked"]
    if unread:
        pytest.skip(f"{len(unread)} uses were not looked up in {release}: no source of it was read")


def test_a_use_that_a_release_lacks_is_found(monkeypatch):
    """Without its replacement, Humble would lack `rclpy.event_handler`."""
    name = "rclpy.event_handler.SubscriptionEventCallbacks"
    monkeypatch.setitem(uses(), frozenset({name}), "somewhere.py:1")
    assert lacking("humble") == {name: "somewhere.py:1"}
    assert lacking("jazzy") == {}


def structure_of(name, release):
    """Return the structure that RTron reads by in a release."""
    if name == "EndpointInfo":
        return c_structures.endpoint_info(tuple(TABLE["versions"][release]))
    return getattr(c_structures, name)


@pytest.mark.parametrize("release", READ)
@pytest.mark.parametrize("name", TABLE["structures"])
def test_structures_are_laid_out_as_in_every_release(name, release):
    expected = TABLE["structures"][name][release]
    if expected == "absent":
        pytest.skip(f"{release} has no {name}")
    structure = structure_of(name, release)
    found = {field: getattr(structure, field).offset for field in expected if field != "sizeof"}
    assert found == {field: at for field, at in expected.items() if field != "sizeof"}
    has_room = name in ("MessageInfo", "SubscriptionOptions")
    size = ctypes.sizeof(structure)
    assert size == expected["sizeof"] or (has_room and size > expected["sizeof"])


def test_every_structure_is_in_the_table():
    assert set(structures()) == {*TABLE["structures"], "HumbleEndpointInfo"}


@pytest.mark.parametrize("release", READ)
def test_subscription_options_are_returned_in_memory(release):
    """What is no larger than two registers is not (System V and AArch64 ABI)."""
    assert TABLE["structures"]["SubscriptionOptions"][release]["sizeof"] > 16


def constants(file):
    """Return the numbers that a file gives names to."""
    found = {}
    for node in ast.parse((SOURCE / file).read_text()).body:
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Constant | ast.Tuple):
            (target,) = node.targets
            names = [target] if isinstance(target, ast.Name) else getattr(target, "elts", [])
            values = [node.value] if isinstance(target, ast.Name) else node.value.elts
            found |= {
                name.id: getattr(value, "value", None)
                for name, value in zip(names, values, strict=False)
            }
    return found


@pytest.mark.parametrize("release", READ)
@pytest.mark.parametrize("name", CONSTANTS)
def test_constants_have_the_value_of_every_release(name, release):
    file, ours = CONSTANTS[name]
    assert constants(file)[ours] == TABLE["constants"][name][release]


@pytest.mark.parametrize("release", READ)
def test_a_gid_begins_with_what_the_guard_compares(release):
    """Before Iron it was padded to 24 bytes."""
    assert TABLE["constants"]["RMW_GID_STORAGE_SIZE"][release] >= c_structures.GID_SIZE
