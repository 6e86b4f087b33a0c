"""The two systems whose running graph ROSDiscover's authors wrote down.

Repositories, launch files and environment are those of recovery/<system>/experiment.yml of
cmu-rss-lab/rosdiscover-evaluation at 4648ad9, their paths those of the checkouts. AutoRally's
variables are what its autorally_util/setupEnvLocal.sh exports on a machine without cameras,
chassis or joystick. The dependencies are of the releases that pkgs.rosinstall pins or of
ones with the same names; joystick_drivers is not among AutoRally's, because the release at hand
(1.11.0) is older than the robot's (1.14.0) and lacks the feedback topic.
"""

from collections.abc import Mapping

from evaluation.ros1.app import App

AUTORALLY = App(
    name="autorally",
    repositories=(
        "AutoRally/autorally@c2692f2",
        "AutoRally/imu_3dm_gx4@c9652c8",
        "ros-drivers/pointgrey_camera_driver@6c3e4cb",
    ),
    dependencies=(
        "tu-darmstadt-ros-pkg/hector_gazebo@fdc01f6",
        "ros-simulation/gazebo_ros_pkgs@f9e1a46",
        "ros-controls/ros_control@5faa68d",
        "ros-controls/ros_controllers@ffe44f3",
        "ros/robot_state_publisher@9afecc8",
        "ros/nodelet_core@54db9fc",
        "ros/dynamic_reconfigure@7df9855",
        "ros/diagnostics@e59ca2b",
        "ros-perception/image_common@21aac6a",
    ),
    launches=(
        ("autorally/autorally_gazebo/launch/autoRallyTrackGazeboSim.launch", {}),
        ("autorally/autorally_control/launch/waypointFollower.launch", {}),
        ("autorally/autorally_control/launch/constantSpeedController.launch", {}),
    ),
    environ={
        "AR_CONFIG_PATH": "{autorally}/autorally_util/config",
        "AR_MPPI_PARAMS_PATH": "{autorally}/autorally_control/src/path_integral/params/",
        "AR_LEFTCAM": "none",
        "AR_RIGHTCAM": "none",
        "AR_LEFTCAM_CONNECTED": "false",
        "AR_RIGHTCAM_CONNECTED": "false",
        "AR_JOYSTICK": "",
        "HOSTNAME": "localhost",
        "MASTER_HOSTNAME": "localhost",
        "ROS_DISTRO": "melodic",
        "ROS_MASTER_URI": "http://localhost:11311",
        "ROSLAUNCH_SSH_UNKNOWN": "0",
    },
)

_GAZEBO = "{turtlebot_simulator}/turtlebot_gazebo"

TURTLEBOT = App(
    name="turtlebot",
    repositories=(
        "turtlebot/turtlebot_simulator@f0fce83",
        "turtlebot/turtlebot_apps@0690ace",
        "turtlebot/turtlebot@fe98e72",
    ),
    dependencies=(
        "yujinrobot/kobuki@b899a20",
        "yujinrobot/kobuki_desktop@c0d2cdc",
        "yujinrobot/yujin_ocs@340fbd5",
        "ros-planning/navigation@50dd13e",
        "ros-perception/depthimage_to_laserscan@f135fbd",
        "ros-perception/image_pipeline@69488e6",
        "ros-simulation/gazebo_ros_pkgs@f9e1a46",
        "ros/robot_state_publisher@9afecc8",
        "ros/nodelet_core@54db9fc",
        "ros/dynamic_reconfigure@7df9855",
        "ros-perception/image_common@21aac6a",
    ),
    launches=(
        ("turtlebot_simulator/turtlebot_gazebo/launch/turtlebot_world.launch", {}),
        ("turtlebot_simulator/turtlebot_gazebo/launch/amcl_demo.launch", {}),
    ),
    environ={
        "TURTLEBOT_GAZEBO_WORLD_FILE": f"{_GAZEBO}/worlds/playground.world",
        "TURTLEBOT_GAZEBO_MAP_FILE": f"{_GAZEBO}/maps/playground.yaml",
        "TURTLEBOT_3D_SENSOR": "kinect",
        "ROS_DISTRO": "kinetic",
    },
)

EXPERIMENTERS: Mapping[str, frozenset[str]] = {
    "turtlebot": frozenset({"/rostopic_2964_1633637419016"}),
}
"""Nodes that the experimenter started by hand: the `run_script` of experiment.yml."""

SHORT_LIVED = frozenset({("gazebo_ros", "spawn_model"), ("gazebo_ros", "spawn_urdf")})
"""Programs that end after they did their work, so that the observer came too late for them."""
