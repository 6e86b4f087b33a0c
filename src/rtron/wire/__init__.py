"""Protocols on the wire: of ROS 1, of ROS 2, and of the link between guard and service."""
