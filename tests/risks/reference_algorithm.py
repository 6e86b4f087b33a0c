"""Algorithm 1 of the paper once more, as literally as the design narrows it and with no index.

Written apart from the rules, over plain tuples, so that both can only agree by being right.
"""

from rtron.vocabulary import Direction, InteractionGraph

EVENTS = {
    "sensor_msgs/BatteryState",
    "sensor_msgs/Temperature",
    "sensor_msgs/RelativeHumidity",
    "sensor_msgs/MagneticField",
    "sensor_msgs/FluidPressure",
    "sensor_msgs/NavSatFix",
    "sensor_msgs/Illuminance",
    "nav_msgs/Odometry",
}
ACTIONS = {
    "geometry_msgs/Twist",
    "geometry_msgs/TwistStamped",
    "geometry_msg/Twist",
    "audio_common_msgs/AudioData",
    "audio_common_msg/AudioData",
    "control_msgs/FollowJointTrajectoryAction",
    "control_msgs/FollowJointTrajectoryActionGoal",
}
RECOG = [
    "detect",
    "people",
    "person",
    "pedestrian",
    "human",
    "face",
    "object",
    "recogni",
    "gesture",
]
IMAGES = ("sensor_msgs/Image", "sensor_msgs/CompressedImage")
VIEWERS = ("rviz", "rosbag", "rqt_graph")


def naive_risks(graph: InteractionGraph) -> set[str]:
    """Return the ids of the risks in a graph whose endpoints all have a type."""
    ends = [(e.node, e.topic, e.type.replace("/msg/", "/"), e.direction) for e in graph.endpoints]
    viewers = {node.name for node in graph.nodes if node.package in VIEWERS}
    pubs = [(n, t, k) for n, t, k, d in ends if d is Direction.PUBLISH]
    subs = [(n, t, k) for n, t, k, d in ends if d is Direction.SUBSCRIBE]
    found = set()
    for topic in {t for _, t, _ in pubs}:
        found |= topic_risks(topic, pubs, subs, viewers)
    for node in {n for n, _, _ in subs}:
        found |= node_risks(node, pubs, subs, looks=node in viewers)
    return found


def topic_risks(topic, pubs, subs, viewers) -> set[str]:
    types = {k for _, t, k in pubs + subs if t == topic}
    found = set()
    several = len({n for n, t, _ in pubs if t == topic}) > 1
    obeyed = any(t == topic and n not in viewers for n, t, _ in subs)
    if several and obeyed and not ignored(topic, types):
        found.add(f"GR-ST:{topic}")
    if "max_vel" in topic and "std_msgs/Float64" in types:
        found.add(f"RSR-max_vel:{topic}")
    if types & EVENTS or "detect" in topic:
        found.add(f"MSR-event:{topic}")
    answers = topic.endswith(("/result", "/feedback"))
    answers |= any(k.endswith(("Feedback", "Result", "FeedbackMessage")) for k in types)
    if (types & ACTIONS or "goal" in topic) and not answers:
        found.add(f"MSR-action:{topic}")
    return found


def node_risks(node, pubs, subs, *, looks: bool) -> set[str]:
    found = set()
    heard = {(t, k.replace("TwistStamped", "Twist")) for n, t, k in subs if n == node}
    heard_twice = {k for t, k in heard for u, j in heard if k == j and t < u}
    for kind in heard_twice if not looks else ():
        if len({t for t, k in heard if k == kind and not ignored(t, {k})}) > 1:
            found.add(f"GR-MT:{node}:{kind}")
    images = any(n == node and k in IMAGES for n, _, k in subs)
    if images and any(n == node and word in t for n, t, _ in pubs for word in RECOG):
        found.add(f"RSR-image:{node}")
    return found


def ignored(topic, types) -> bool:
    shows = any(k.startswith("visualization_msgs/") or k == "rosgraph_msgs/Log" for k in types)
    return topic in ("/rosout", "/rosout_agg") or shows
