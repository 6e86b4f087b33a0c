"""The quality of service of image_transport's and point_cloud_transport's endpoints."""

from dataclasses import replace

import pytest
from ros2_runs import cpp, explicit_declarations, settings

from rtron.vocabulary import Durability, QoS, Reliability

SENSOR = QoS(depth=5, reliability=Reliability.BEST_EFFORT)
FILTER = "image_transport::SubscriberFilter()"
CLOUDS = "point_cloud_transport::PointCloudTransport(*this)"
IT = "image_transport::ImageTransport(shared_from_this())"


GIVEN = """auto f = [](auto m) {}; auto node = shared_from_this();
  image_transport::TransportHints hints(this, "raw");"""
MADE = "image_transport::create_"
BY_HAND = "rclcpp::SensorDataQoS().get_rmw_qos_profile()"


@pytest.mark.parametrize(
    ("call", "expected"),
    [
        (f'{MADE}publisher(this, "i", rmw_qos_profile_sensor_data)', SENSOR),
        (f'{MADE}publisher(this, "i", rclcpp::QoS(3))', QoS(depth=3)),
        (f'{MADE}publisher(this, "i")', QoS(depth=10)),
        (f'{MADE}publisher(this, "i", who_knows())', None),
        (f'{MADE}camera_publisher(this, "i", rmw_qos_profile_sensor_data)', SENSOR),
        (f'{MADE}subscription(this, "i", f, "raw", rmw_qos_profile_sensor_data)', SENSOR),
        (f'{MADE}subscription(this, "i", f, "compressed", {BY_HAND})', SENSOR),
        (f'{MADE}camera_subscription(this, "i", f, "raw", {BY_HAND})', SENSOR),
        (f'{MADE}subscription(this, "i", f, "raw")', QoS(depth=10)),
        (f'{IT}.advertise("i", 4)', QoS(depth=4)),
        (f'{IT}.advertise("i", 4, true)', None),
        (f'{IT}.advertiseCamera("i", 4)', QoS(depth=4)),
        (f'{IT}.subscribe("i", 4, f)', QoS(depth=4)),
        (f'{FILTER}.subscribe(this, "i", "raw", rmw_qos_profile_sensor_data)', SENSOR),
        (f'{FILTER}.subscribe(this, "i", "raw")', QoS(depth=10)),
        (f'{IT}.subscribe("i", 4, f, nullptr, &hints)', QoS(depth=4)),
        (f'{MADE}subscription(this, "i", f, hints.getTransport())', QoS(depth=10)),
        (f'{CLOUDS}.advertise("i", 4)', replace(SENSOR, depth=4)),
        (f'{CLOUDS}.advertise("i", rclcpp::QoS(4))', QoS(depth=4)),
        (f'{CLOUDS}.subscribe("i", 4, f)', replace(SENSOR, depth=4)),
        (f'{CLOUDS}.subscribe("i", rmw_qos_profile_sensor_data, f)', SENSOR),
        ('point_cloud_transport::create_publisher(shared_from_this(), "i")', QoS(depth=10)),
        ('point_cloud_transport::create_subscription(node, "i", f, "raw", rclcpp::QoS(2))',
         QoS(depth=2)),
    ],
)  # fmt: skip
def test_what_is_made_with_a_literal_has_it(call, expected):
    found = [d for d in cpp(f"{GIVEN} {call};").declarations if d.name.startswith("/ns/")]
    ours = [d for d in found if d.name.startswith("/ns/i") or d.name == "/ns/camera_info"]
    assert ours
    assert {d.qos for d in ours} == {expected}


def test_members_of_a_profile_may_be_assigned():
    body = """rmw_qos_profile_t mine = rmw_qos_profile_default;
    mine.depth = 2;
    mine.reliability = RMW_QOS_POLICY_RELIABILITY_BEST_EFFORT;
    mine.durability = RMW_QOS_POLICY_DURABILITY_TRANSIENT_LOCAL;
    image_transport::create_subscription(this, "a", [](auto m) {}, "raw", mine);
    image_transport::create_subscription(this, "b", [](auto m) {}, "raw", rmw_qos_profile_default);
    """
    found = {d.name: d.qos for d in cpp(body).declarations}
    best, transient = Reliability.BEST_EFFORT, Durability.TRANSIENT_LOCAL
    assert found["/ns/a"] == QoS(depth=2, reliability=best, durability=transient)
    assert found["/ns/b"] == QoS(depth=10)


HINTS = "image_transport::TransportHints h(this);"
COMPRESSED = "subscribe /ns/i/compressed sensor_msgs/msg/CompressedImage"


@pytest.mark.parametrize(
    "call",
    [
        f'{HINTS} {MADE}subscription(this, "i", f, h.getTransport())',
        f'{HINTS} {IT}.subscribe("i", 1, f, nullptr, &h)',
        f'{IT}.subscribe("i", 1, f)',
    ],
)
def test_a_parameter_chooses_the_transport(call):
    body = f'declare_parameter("image_transport", "raw"); auto f = [](auto m) {{}}; {call};'
    assert explicit_declarations(cpp(body)) == ["subscribe /ns/i sensor_msgs/msg/Image"]
    given = cpp(body, settings=settings(image_transport="compressed"))
    assert explicit_declarations(given) == [COMPRESSED]


def test_clouds_have_transports_of_their_own():
    call = 'point_cloud_transport::create_subscription(this, "i", [](auto m) {}, "zstd");'
    expected = "subscribe /ns/i/zstd point_cloud_interfaces/msg/CompressedPointCloud2"
    assert explicit_declarations(cpp(call)) == [expected]
