"""Evaluations on ROS 2 apps."""
