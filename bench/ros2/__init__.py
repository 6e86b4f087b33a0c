"""Benchmarks on ROS 2."""
