"""Publishers that say one thing at a rate, and listeners that keep what they hear: ROS's own."""

from harness import wait_for

TWIST = "{linear: {x: %s}}"
IMAGE = "{header: auto, height: 1, width: 1, encoding: mono8, step: 1, data: [0]}"


def say(ros1, name, topic, type, yaml, rate=10, *remaps):
    """Start a publisher that repeats a message; it is named `name`."""
    words = ("rostopic", "pub", "-s", "-r", str(rate), topic, type, yaml, f"__name:={name}")
    return ros1.spawn(*words, *remaps)


class TopicEcho:
    """What a subscriber of a topic hears, field by field as rostopic prints it."""

    def __init__(self, ros1, name, topic, *remaps):
        words = ("rostopic", "echo", "-p", "--nostr", topic, f"__name:={name}")
        self._process = ros1.spawn(*words, *remaps)
        self._ros1, self.name = ros1, name

    def rows(self):
        """Return the values of each message, without its time."""
        whole = self._process.log.rpartition("\n")[0].splitlines()
        lines = [line for line in whole if not line.startswith("%") and "," in line]
        return [[float(value) for value in line.split(",")[1:]] for line in lines]

    def wait_for(self, condition, what):
        """Wait until `condition` holds for the rows; return them."""
        wait_for(lambda: condition(self.rows()), what=what)
        return self.rows()
