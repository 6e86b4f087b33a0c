"""The names that the processes of the audit's measurements share."""

from rtron.vocabulary import flow_topic, output_topic

TOPIC = "/cmd_vel"
OUT, FLOW = output_topic(TOPIC), flow_topic(TOPIC, "flow1")
DRIVER = "/bench_driver"
OPEN = "the app hears the guard"
"""Said once the way from the planned publisher to the successor is there."""
