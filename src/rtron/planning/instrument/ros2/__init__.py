"""The guarded launch of ROS 2: XML and YAML rewritten, Python wrapped."""

from rtron.planning.instrument.ros2.instrumentation import instrument_ros2

__all__ = ["instrument_ros2"]
