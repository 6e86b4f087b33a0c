"""ROS 2's launch files in XML and YAML: what they start, without running anything."""
