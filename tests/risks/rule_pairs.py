"""For each rule an app that has its risk, and one just beside it that has not."""

PAIRS = {
    "gr_st": (
        """
/move_base move_base third_party
    pub /cmd_vel geometry_msgs/Twist
/teleop teleop_twist_keyboard third_party
    pub /cmd_vel geometry_msgs/Twist
/base driver own
    sub /cmd_vel geometry_msgs/Twist
""",
        """
/move_base move_base third_party
    pub /cmd_vel geometry_msgs/Twist
/teleop teleop_twist_keyboard third_party
    pub /cmd_vel geometry_msgs/Twist
/rviz rviz third_party
    sub /cmd_vel geometry_msgs/Twist
""",
    ),
    "gr_mt": (
        """
/camera camera_driver third_party
    pub /{left,right}/image_raw sensor_msgs/Image
/stereo stereo_image_proc own
    sub /{left,right}/image_raw sensor_msgs/msg/Image
""",
        """
/camera camera_driver third_party
    pub /left/image_raw sensor_msgs/Image
    pub /right/image_raw sensor_msgs/CompressedImage
/stereo stereo_image_proc own
    sub /left/image_raw sensor_msgs/Image
    sub /right/image_raw sensor_msgs/CompressedImage
""",
    ),
    "rsr_image": (
        """
/camera camera_driver third_party
    pub /image_raw sensor_msgs/CompressedImage
/faces face_finder own
    sub /image_raw sensor_msgs/CompressedImage
    pub /faces std_msgs/UInt8
""",
        """
/camera camera_driver third_party
    pub /scan sensor_msgs/LaserScan
/faces face_finder own
    sub /scan sensor_msgs/LaserScan
    pub /faces std_msgs/UInt8
""",
    ),
    "rsr_max_vel": (
        """
/parking parking own
    pub /control/max_vel std_msgs/Float64
/lane lane own
    sub /control/max_vel std_msgs/Float64
""",
        """
/parking parking own
    pub /control/max_vel std_msgs/Float32
/lane lane own
    sub /control/max_vel std_msgs/Float32
""",
    ),
    "msr_event": (
        """
/battery driver own
    pub /power sensor_msgs/BatteryState
/planner planner own
    sub /power sensor_msgs/BatteryState
""",
        """
/battery driver own
    pub /power std_msgs/Float32
/planner planner own
    sub /power std_msgs/Float32
""",
    ),
    "msr_action": (
        """
/speech speech own
    pub /speaker audio_common_msgs/AudioData
/speaker audio_play own
    sub /speaker audio_common_msgs/AudioData
""",
        """
/speech speech own
    pub /speaker audio_common_msgs/AudioInfo
/speaker audio_play own
    sub /speaker audio_common_msgs/AudioInfo
""",
    ),
}
