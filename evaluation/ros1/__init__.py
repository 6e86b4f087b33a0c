"""Evaluations on ROS 1 apps."""
