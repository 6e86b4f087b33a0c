"""What the demo app's nodes decide, without ROS: standard library only, Python 3.10 or later."""
