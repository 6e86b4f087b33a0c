"""Whether the RSRCN has what its policy needs, and agrees with the fps_monitors."""

from collections.abc import Iterator

from rtron.coherence.flows import (
    CoherenceProblem,
    guarded_topic_problems,
    policy_problems,
    priority_problems,
)
from rtron.vocabulary import (
    RSRCN,
    SECOND,
    FpsMonitor,
    GuardedTopic,
    Plan,
    PolicyName,
    normalise_type,
)

POLICIES = (PolicyName.BLOCK, PolicyName.SAFE, PolicyName.CONSTRAIN, PolicyName.SAFE_CONSTRAIN)
FRAME_RATE_POLICIES = (PolicyName.SAFE, PolicyName.SAFE_CONSTRAIN)
VELOCITY_LIMIT_POLICIES = (PolicyName.CONSTRAIN, PolicyName.SAFE_CONSTRAIN)
VELOCITY_TYPES = (
    "std_msgs/Float64",
    "std_msgs/Float32",
    "geometry_msgs/Twist",
    "geometry_msgs/TwistStamped",
    "ackermann_msgs/AckermannDrive",
    "ackermann_msgs/AckermannDriveStamped",
)


def included_policies(policy: PolicyName) -> tuple[PolicyName, ...]:
    """Return what a policy of the RSRCN includes: itself, and the parts of Safe+Constrain."""
    parts = (PolicyName.SAFE, PolicyName.CONSTRAIN)
    return (policy, *parts) if policy is PolicyName.SAFE_CONSTRAIN else (policy,)


def rsrcn_problems(plan: Plan) -> Iterator[CoherenceProblem]:
    """Yield everything in which the RSRCN and the fps_monitors contradict themselves."""
    for monitor in plan.fps_monitor:
        yield from _monitor(monitor)
    if plan.rsrcn:
        yield from rsrcn_policy_problems(plan.rsrcn, plan)
        yield from guarded_topic_problems(plan.rsrcn.vflows, plan.rsrcn.iflows)
        yield from _monitored(plan.rsrcn, plan)


def rsrcn_policy_problems(rsrcn: RSRCN, plan: Plan) -> Iterator[CoherenceProblem]:
    """Yield what is wrong with the policy of an RSRCN and its parameters."""
    yield from policy_problems(rsrcn, "the RSRCN", rsrcn.policy, POLICIES)
    yield from _mandatory(rsrcn)
    yield from _parameters(rsrcn, plan)
    if rsrcn.policy in FRAME_RATE_POLICIES + VELOCITY_LIMIT_POLICIES:
        yield from (problem for topic in rsrcn.vflows for problem in _limited(topic, rsrcn.policy))


def _monitor(monitor: FpsMonitor) -> Iterator[CoherenceProblem]:
    camera = monitor.camera
    if camera and monitor.topic == camera.topic:
        yield camera, "topic", f"{camera.topic} is what {monitor.node} publishes, not what it sees"
    elif camera and monitor.node == camera.publisher:
        yield camera, "publisher", f"{monitor.node} cannot be its own camera"
    if monitor.silent_after > monitor.window:
        why = "frames are counted no longer than the window"
        yield monitor, "silent_after", f"silent_after is longer than the window: {why}"


def _parameters(rsrcn: RSRCN, plan: Plan) -> Iterator[CoherenceProblem]:
    policy = rsrcn.policy
    slowest = max((each.silent_after for each in plan.fps_monitor), default=SECOND)
    if rsrcn.threshold is not None and rsrcn.lowest > rsrcn.threshold * SECOND / slowest:
        why = "a silent image node would let the robot go faster than a slow one"
        yield rsrcn, "lowest", f"{rsrcn.lowest:g} m/s is too fast: {why}"
    if policy in FRAME_RATE_POLICIES and rsrcn.threshold is None:
        yield rsrcn, "policy", f"{policy} needs a threshold: how far may it go in one frame?"
    if policy in FRAME_RATE_POLICIES and not plan.fps_monitor:
        yield rsrcn, "policy", f"{policy} needs an fps_monitor: whose frames count?"
    if policy in VELOCITY_LIMIT_POLICIES and rsrcn.max_vel_limit is None:
        yield rsrcn, "policy", f"{policy} needs a max_vel_limit, like 0.22 m/s"


def _mandatory(rsrcn: RSRCN) -> Iterator[CoherenceProblem]:
    policy = rsrcn.mandatory
    if policy is None:
        return
    if policy not in POLICIES:
        known = ", ".join(POLICIES)
        yield rsrcn, "mandatory", f"{policy} is not for the RSRCN: choose from {known}"
    elif policy not in included_policies(rsrcn.policy):
        why = f"the policy is {rsrcn.policy}, which does not include it"
        yield rsrcn, "mandatory", f"{policy} cannot be mandatory: {why}"


def _monitored(rsrcn: RSRCN, plan: Plan) -> Iterator[CoherenceProblem]:
    """Compare the iflows with the fps_monitors; without iflows, all monitors count."""
    monitors = {(monitor.topic, monitor.node) for monitor in plan.fps_monitor}
    watched = {(flow.topic, flow.publisher) for flow in rsrcn.iflows}
    for flow in rsrcn.iflows:
        if (flow.topic, flow.publisher) not in monitors:
            yield flow, "", f"no fps_monitor measures {flow.publisher} on {flow.topic}"
    for monitor in plan.fps_monitor if watched else ():
        if (monitor.topic, monitor.node) not in watched:
            yield monitor, "", f"no iflow of the RSRCN names {monitor.node} on {monitor.topic}"


def _limited(topic: GuardedTopic, policy: PolicyName) -> Iterator[CoherenceProblem]:
    if topic.type and normalise_type(topic.type) not in VELOCITY_TYPES:
        known = ", ".join(VELOCITY_TYPES)
        yield topic, "type", f"{policy} cannot limit a {topic.type}: it knows {known}"
    if policy in FRAME_RATE_POLICIES and len({flow.priority for flow in topic.flows}) > 1:
        yield from priority_problems(topic.flows, policy)
