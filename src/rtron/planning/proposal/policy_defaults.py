"""From risks to a plan: which coordination nodes stand where, in which mode, with which policy.

The defaults (paper sections 5.3 and 7.2):

| topic                               | mode    | policy                                    |
|-------------------------------------|---------|-------------------------------------------|
| Control, contending                 | enforce | Preemption                                |
| Planning, contending                | enforce | Priority_Queue, `done` where it is known  |
| an action                           | as its goals | as above: it is one unit             |
| the last command before the hardware | enforce | Preemption, whoever publishes it        |
| the same, where it may carry frames of several | enforce | Block, no bit set             |
| merging, Perception, Drivers, Others | observe | Block, no bit set                        |
| else nobody is known to publish or listen | observe | as above                            |

Two kinds of topics have Block wherever they belong: cancels, because they never wait, and a state
with at most one publisher, because there is nothing to arrange, only strangers to keep out.
"""

from collections.abc import Collection, Mapping
from dataclasses import replace
from types import MappingProxyType

from rtron.planning.plan_file.defaults import app_name, node_id, with_distinct_ids
from rtron.planning.plan_file.fields import NODE_NAME, TOPIC_NAME
from rtron.planning.problem import PlanProblem, ProblemLevel
from rtron.planning.proposal.app_model import AppModel
from rtron.planning.proposal.app_nodes import fps_monitors, propose_msrcn, propose_rsrcn
from rtron.planning.queue_sizes import fitting_queue_size
from rtron.vocabulary import (
    GRCN,
    ROS1_CLIENT_TOPICS,
    SECOND,
    Domain,
    Flow,
    InteractionGraph,
    Mode,
    Plan,
    PolicyName,
    RiskKind,
    RiskReport,
    Sharing,
    StreamKind,
    ros1_topic_name,
)

# A goal that waited longer than this is no longer what its sender wants.
MAX_GOAL_AGE = 60 * SECOND
# Nothing tells when such a goal, or such a state, is done: it then counts as done after this time.
GOAL_TIMEOUT = 10 * SECOND
STATE_TIMEOUT = SECOND // 2
# Topics of poses that a server of ROS 2 makes a goal of its own of (rviz and Nav2 name them so).
_POSES = ("goal_pose", "goal")
_NOT_GUARDABLE = "cannot be guarded"
_UNTYPED = "the type of the action is not known"
_CANCELS = ("actionlib_msgs/GoalID", "actionlib_msgs/msg/GoalID")
_ORDER = (Domain.CONTROL, Domain.PLANNING, Domain.PERCEPTION, Domain.DRIVERS, Domain.OTHERS)


def propose_plan(
    graph: InteractionGraph,
    report: RiskReport,
    last_commands: Mapping[str, tuple[str, ...]] = MappingProxyType({}),
    *,
    measured: Collection[str] = (),
    only_motion: bool = False,
) -> Plan:
    """Return a plan with a GRCN for each topic of a general risk, and the others as risks ask.

    With `only_motion` the GRCNs are only those of what moves the robot: none that observes a topic
    of Perception, Drivers or Others, and none of what goes round in one process or one stack
    (Nav2's servers, MoveIt Servo): the command that leaves it has one.

    `last_commands` are topics that nodes next to the hardware obey, or that leave the app, each
    with the nodes that may obey it and were not read. Each has a GRCN though only one node, or
    none, is known to publish or to obey it, which keeps others out. `measured` are topics that
    look like commands of motion and command nothing: no plan guards them.
    """
    app = AppModel.from_graph(graph, report, last_commands, measured)
    guardable = filter(app.can_guard, _risky_topics(app))
    topics = filter(app.moves, guardable) if only_motion else guardable
    found = (_grcn(app, name) for name in topics)
    grcn = with_distinct_ids(_with_fitting_queue(app, each) for each in found)
    enforced = {node.topic for node in grcn if node.mode is Mode.ENFORCE}
    monitors = fps_monitors(app)
    return Plan(
        app=app_name(graph.app),
        ros=graph.ros,
        grcn=grcn,
        rsrcn=propose_rsrcn(app, monitors, enforced),
        msrcn=propose_msrcn(app, enforced),
        fps_monitor=monitors,
    )


def unguardable_topics(
    graph: InteractionGraph, report: RiskReport, *, only_motion: bool = False
) -> tuple[PlanProblem, ...]:
    """Return a warning for each risky topic, and each publisher of one, that no plan can guard."""
    app = AppModel.from_graph(graph, report, {})
    risky = sorted({topic for risk in report.risks for topic in risk.topics})
    risky = list(filter(app.moves, risky)) if only_motion else risky
    nodes = sorted({e.node for topic in risky for e in app.graph.publishers(topic)})
    unnamed = [topic for topic in risky if not TOPIC_NAME.matches(topic)]
    unnamed += [node for node in nodes if not NODE_NAME.matches(node)]
    actions = [topic for topic in risky if TOPIC_NAME.matches(topic) and not app.can_guard(topic)]
    return (
        *(
            PlanProblem(ProblemLevel.WARNING, name, f"{_NOT_GUARDABLE}: its name is not known")
            for name in unnamed
        ),
        *(
            PlanProblem(ProblemLevel.WARNING, name, f"{_NOT_GUARDABLE}: {_UNTYPED}")
            for name in actions
        ),
    )


def _risky_topics(app: AppModel) -> list[str]:
    general = (RiskKind.GR_ST, RiskKind.GR_MT)
    risky = {topic for r in app.report.risks if r.kind in general for topic in r.topics}
    risky.update(app.last_commands)
    topics = {_guarded_unit(app, topic, risky) for topic in risky}
    return sorted(topics, key=lambda topic: (_ORDER.index(app.classify(topic).domain), topic))


def _guarded_unit(app: AppModel, topic: str, risky: Collection[str]) -> str:
    """Return what stands for a topic: of an action the goals, if goals or cancels are risky."""
    goal = app.goal_topic_of(topic)
    action = goal.rpartition("/")[0]
    has_risky_client_topic = goal and any(
        ros1_topic_name(action, part) in risky for part in ROS1_CLIENT_TOPICS
    )
    return goal if has_risky_client_topic else topic


def _grcn(app: AppModel, topic: str) -> GRCN:
    topic_class = app.classify(topic)
    policy = _policy(app, topic)
    is_queued = policy is PolicyName.PRIORITY_QUEUE
    done = _done_topic(app, topic) if is_queued else None
    has_end_signal = done or topic in app.ros2_actions
    timeout = _timeout(topic_class.kind) if is_queued and not has_end_signal else None
    return GRCN(
        id=node_id("grcn", topic),
        topic=topic,
        type=app.type_of(topic),
        domain=topic_class.domain,
        kind=topic_class.kind,
        sharing=topic_class.sharing,
        mode=Mode.ENFORCE if app.can_enforce(topic) else Mode.OBSERVE,
        policy=policy,
        flows=_flows(app.publishers(topic), timeout),
        successors=app.successors(topic),
        max_age=MAX_GOAL_AGE
        if is_queued and topic_class.kind is StreamKind.ACTION
        else SECOND // 2,
        done=done,
    )


def _with_fitting_queue(app: AppModel, grcn: GRCN) -> GRCN:
    """Return a GRCN whose queue has room for what it is to hold, if it forwards anything."""
    if grcn.mode is not Mode.ENFORCE:
        return grcn
    fitting = fitting_queue_size(grcn.type, app.definitions)
    return replace(grcn, queue_size=min(grcn.queue_size, fitting or grcn.queue_size))


def _policy(app: AppModel, topic: str) -> PolicyName:
    topic_class = app.classify(topic)
    is_single_publisher_state = (
        topic_class.kind is StreamKind.STATE and len(app.publishers(topic)) <= 1
    )
    is_cancel = app.type_of(topic).startswith(_CANCELS)
    is_shared = topic_class.sharing is Sharing.MERGE or app.is_shared_channel(topic)
    if is_shared or is_cancel or is_single_publisher_state:
        return PolicyName.BLOCK
    if topic_class.domain is Domain.PLANNING or topic_class.kind is StreamKind.ACTION:
        return PolicyName.PRIORITY_QUEUE
    return PolicyName.PREEMPTION if topic_class.domain is Domain.CONTROL else PolicyName.BLOCK


def _flows(publishers: list[str], timeout: int | None) -> tuple[Flow, ...]:
    return tuple(
        Flow(
            name=f"flow{rank + 1}", publisher=node, priority=len(publishers) - rank, timeout=timeout
        )
        for rank, node in enumerate(publishers)
    )


def _done_topic(app: AppModel, topic: str) -> str | None:
    """Return the topic, or action of ROS 2, that tells the end of what a goal started."""
    if app.graph.ros != 1:
        return _pose_action(app, topic)
    namespace = topic.removesuffix("/goal").removesuffix("_simple")
    served = (name for node in app.successors(topic) for name in app.servers.get(node, ()))
    names = [namespace, *served] if topic.endswith("/goal") else []
    return next((f"{name}/result" for name in names if f"{name}/result" in app.topics), None)


def _pose_action(app: AppModel, topic: str) -> str | None:
    """Return the action of ROS 2 that poses on a topic become: Nav2's, or its server's only one."""
    namespace, _, last = topic.rpartition("/")
    if last not in _POSES:
        return None
    served = {name for node in app.successors(topic) for name in app.servers.get(node, ())}
    nav2 = f"{namespace}/navigate_to_pose"
    return nav2 if nav2 in served else served.pop() if len(served) == 1 else None


def _timeout(kind: StreamKind) -> int | None:
    return {StreamKind.ACTION: GOAL_TIMEOUT, StreamKind.STATE: STATE_TIMEOUT}.get(kind)
