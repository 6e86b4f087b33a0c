"""ROS 2's launch files in XML, YAML and Python: what they start.

`executed/` alone runs a launch file; everything else only reads it.
"""
