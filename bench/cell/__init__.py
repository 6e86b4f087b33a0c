"""What a cell costs, and how soon it stops the robot."""
