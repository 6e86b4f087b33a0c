"""Who can move the robot, and what keeps it from moving when it must not."""
