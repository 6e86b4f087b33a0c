"""How large messages are taken to be: fixed parts to the byte, arrays of bytes by their bound."""

import pytest

from rtron.messages.common.definition_parser import parse_definition
from rtron.messages.common.definition_registry import DefinitionRegistry
from rtron.planning.queue_sizes import BYTE_ARRAY_SIZE, usual_size


@pytest.mark.parametrize(
    ("text", "size"),
    [
        ("float64 x\nint8 y", 9),
        ("string text\nfloat64[] values", 0),
        ("float64[36] covariance", 288),
        ("uint8[] data", BYTE_ARRAY_SIZE),
        ("int8[<=1000] data", 1000),
        ("uint8[65536] data", 1 << 16),
        ("pkg/Part[3] parts\n===\nMSG: pkg/Part\nuint16 a\nuint16 b", 12),
        ("pkg/Part[] parts\n===\nMSG: pkg/Part\nuint16 a", 0),
    ],
)
def test_a_message_has_at_least_its_fixed_parts(text, size):
    assert usual_size(parse_definition("pkg/Type", text)) == size


@pytest.mark.parametrize("ros", [1, 2])
@pytest.mark.parametrize(
    "type", ["sensor_msgs/Image", "sensor_msgs/PointCloud2", "nav_msgs/OccupancyGrid"]
)
def test_pictures_clouds_and_maps_are_large(type, ros):
    assert usual_size(DefinitionRegistry(ros=ros).find(type)) >= BYTE_ARRAY_SIZE


@pytest.mark.parametrize("type", ["geometry_msgs/Twist", "sensor_msgs/LaserScan", "nav_msgs/Path"])
def test_commands_scans_and_paths_are_small(type):
    assert usual_size(DefinitionRegistry(ros=2).find(type)) < 1000
