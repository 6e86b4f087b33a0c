"""Which names tell of a measurement, and which of what moves something all the same."""

import pytest

from rtron.findings.measurement_names import (
    is_called_sensor,
    is_measured,
    may_be_measured,
    moves_nothing,
)
from rtron.vocabulary import Node


@pytest.mark.parametrize(
    "topic",
    [
        "/gps/vel",
        "/base/odom/twist",
        "/measured_twist",
        "/current_velocity",
        "/depth/points",
        "/vel_actual",
        "/measuredTwist",
        "/ActVel",
    ],
)
def test_a_topic_is_measured_whoever_subscribes_it(topic):
    assert is_measured(topic)


@pytest.mark.parametrize(
    "topic",
    [
        *("/cmd_vel", "/imu/cmd_vel", "/odom/set_command", "/motor/current", "/vel_raw", "/goal"),
        *("/gps_cmd_vel", "/current_setpoint", "/path_points", "/act_cmd"),
    ],
)
def test_a_topic_that_a_driver_may_obey(topic):
    assert not is_measured(topic)


@pytest.mark.parametrize(
    "topic",
    [
        *("/motor_odom", "/wheels/velocity_estimated", "/x/ground_truth/twist", "/vel_raw"),
        *("/wheel_vel", "/encoder_speed", "/imu/vel", "/vel_meas", "/fix_velocity", "/realTwist"),
    ],
)
def test_a_topic_that_may_be_measured_unless_a_driver_obeys_it(topic):
    assert may_be_measured(topic)


@pytest.mark.parametrize(
    "topic", ["/cmd_vel_raw", "/estimated_cmd", "/setpoint_raw/vel", "/raw_vel", "/simulated_vel"]
)
def test_a_topic_that_says_that_it_commands_is_no_measurement(topic):
    assert not may_be_measured(topic)


@pytest.mark.parametrize(
    ("name", "package", "is_sensor"),
    [
        ("/velodyne", "velodyne_driver", True),
        ("/robot1/driver", "acme_lidar_driver", True),
        ("/ekf", "robot_localization", True),
        ("/nmea_serial_driver", "nmea_navsat_driver", True),
        ("/message_info", "rosserial_python", True),
        ("/camera2", "own", False),
        ("/driver", "acme", False),
        ("/camera", "camera_rover_driver", False),
        ("/lidar_base", "driver", False),
        ("/gps_waypoint_driver", "own", False),
        ("/lidar_drivers_motor1", "own", False),
        ("/mapper", "own", False),
    ],
)
def test_a_node_that_is_called_like_a_sensor(name, package, is_sensor):
    assert is_called_sensor(Node(name=name, package=package)) is is_sensor


def test_a_file_moves_nothing_by_one_of_its_parts():
    assert moves_nothing("include $(find rover_bringup)/launch/camera.launch")
    assert not moves_nothing("include $(find rover_bringup)/launch/all.launch")
    assert not moves_nothing("include $(find acme)/launch/robot_with_camera.launch")
