"""Evaluations without ROS, and what all evaluations share."""
