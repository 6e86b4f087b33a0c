"""Topics, speeds and rates of the soaked app; rospy's own Python reads them, too."""

COMMANDS, IMAGES, PERSON, DOCK = "/cmd_vel", "/camera/image", "/person", "/dock"
FLOW, LOWER_FLOW, OUT = (f"/rtron{COMMANDS}/{each}" for each in ("flow1", "flow2", "out"))
IMAGE_FLOW, IMAGE_OUT = f"/rtron{IMAGES}/flow1", f"/rtron{IMAGES}/out"
SPEED, FORBIDDEN, INTRUDING = 0.5, 9.0, -0.25
"""What the navigation, who is not in the plan, and who goes past the guard demand, m/s."""
SIDE, TURN = 0.5, 1.0
"""What marks the speeds of others, since the guard scales all components alike.

The joystick adds `SIDE` (m/s), who is not in the plan `TURN` and who goes past the guard `-TURN`
(rad/s).
"""
RATE, INTRUDER_RATE, EVENT_RATE = 20, 50, 10
IMAGE_RATES = (10, 4)
"""The frame rates that the camera has in turn, pictures a second."""
IMAGE_BYTES = 10_000_000
FORBIDDEN_GOAL = 9999
"""The goal of who is not in the plan; those of the planner are hundredths of a second of work."""
