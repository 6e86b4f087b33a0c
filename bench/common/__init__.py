"""What benchmarks of both ROS generations share."""
