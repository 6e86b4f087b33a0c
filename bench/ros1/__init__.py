"""Benchmarks on ROS 1."""
