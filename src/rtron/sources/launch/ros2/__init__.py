"""ROS 2's launch files in XML, YAML and Python: what they start. Nothing of them is run."""
