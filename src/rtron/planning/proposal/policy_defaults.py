"""From risks to a plan: which coordination nodes stand where, in which mode, with which policy.

The defaults (paper sections 5.3 and 7.2):

| topic                               | mode    | policy                                    |
|-------------------------------------|---------|-------------------------------------------|
| Control, contending                 | enforce | Preemption                                |
| Planning, contending                | enforce | Priority_Queue, `done` where it is known  |
| an action                           | as its goals | as above: it is one unit             |
| merging, Perception, Drivers, Others | observe | Block, no bit set                        |
| nobody is known to publish or listen | observe | as above                                 |

Two kinds of topics have Block wherever they belong: cancels, because they never wait, and a state
with at most one publisher, because there is nothing to arrange, only strangers to keep out.
"""

from collections.abc import Collection

from rtron.planning.plan_file.defaults import node_id, with_distinct_ids
from rtron.planning.plan_file.fields import ANY, NODE, TOPIC
from rtron.planning.problem import Level, Problem
from rtron.planning.proposal.app_model import Site
from rtron.planning.proposal.app_nodes import fps_monitors, propose_msrcn, propose_rsrcn
from rtron.vocabulary import (
    ASKED,
    GRCN,
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
    part_topic,
)

# A goal that waited longer than this is no longer what its sender wants.
GOAL_AGE = 60 * SECOND
# Nothing tells when such a goal, or such a state, is done: it then counts as done after this time.
UNSEEN_GOAL = 10 * SECOND
UNSEEN_STATE = SECOND // 2
# Topics of poses that a server of ROS 2 makes a goal of its own of (rviz and Nav2 name them so).
_POSES = ("goal_pose", "goal")
_CANNOT = "cannot be guarded"
_UNTYPED = "the type of the action is not known"
_CANCELS = ("actionlib_msgs/GoalID", "actionlib_msgs/msg/GoalID")
_ORDER = (Domain.CONTROL, Domain.PLANNING, Domain.PERCEPTION, Domain.DRIVERS, Domain.OTHERS)


def propose_plan(graph: InteractionGraph, report: RiskReport) -> Plan:
    """Return a plan with a GRCN for each topic of a general risk, and the others as risks ask."""
    site = Site.of(graph, report)
    grcn = with_distinct_ids(_grcn(site, name) for name in _risky(site) if site.can_guard(name))
    enforced = {node.topic for node in grcn if node.mode is Mode.ENFORCE}
    monitors = fps_monitors(site)
    return Plan(
        app=graph.app[: ANY.longest],
        ros=graph.ros,
        grcn=grcn,
        rsrcn=propose_rsrcn(site, monitors, enforced),
        msrcn=propose_msrcn(site, enforced),
        fps_monitor=monitors,
    )


def left_out(graph: InteractionGraph, report: RiskReport) -> tuple[Problem, ...]:
    """Return a warning for each risky topic, and each publisher of one, that no plan can guard."""
    site = Site.of(graph, report)
    risky = sorted({topic for risk in report.risks for topic in risk.topics})
    nodes = sorted({e.node for topic in risky for e in site.graph.publishers(topic)})
    unnamed = [topic for topic in risky if not TOPIC.fits(topic)]
    unnamed += [node for node in nodes if not NODE.fits(node)]
    actions = [topic for topic in risky if TOPIC.fits(topic) and not site.can_guard(topic)]
    return (
        *(Problem(Level.WARNING, name, f"{_CANNOT}: its name is not known") for name in unnamed),
        *(Problem(Level.WARNING, name, f"{_CANNOT}: {_UNTYPED}") for name in actions),
    )


def _risky(site: Site) -> list[str]:
    general = (RiskKind.GR_ST, RiskKind.GR_MT)
    risky = {topic for r in site.report.risks if r.kind in general for topic in r.topics}
    topics = {_unit(site, topic, risky) for topic in risky}
    return sorted(topics, key=lambda topic: (_ORDER.index(site.classify(topic).domain), topic))


def _unit(site: Site, topic: str, risky: Collection[str]) -> str:
    """Return what stands for a topic: of an action the goals, if goals or cancels are risky."""
    goal = site.goal_of(topic)
    action = goal.rpartition("/")[0]
    asked = goal and any(part_topic(action, part) in risky for part in ASKED)
    return goal if asked else topic


def _grcn(site: Site, topic: str) -> GRCN:
    topic_class = site.classify(topic)
    policy = _policy(site, topic)
    queued = policy is PolicyName.PRIORITY_QUEUE
    done = _done(site, topic) if queued else None
    seen = done or topic in site.requested
    timeout = _timeout(topic_class.kind) if queued and not seen else None
    return GRCN(
        id=node_id("grcn", topic),
        topic=topic,
        type=site.type_of(topic),
        domain=topic_class.domain,
        kind=topic_class.kind,
        sharing=topic_class.sharing,
        mode=Mode.ENFORCE if site.can_enforce(topic) else Mode.OBSERVE,
        policy=policy,
        flows=_flows(site.publishers(topic), timeout),
        successors=site.successors(topic),
        max_age=GOAL_AGE if queued and topic_class.kind is StreamKind.ACTION else SECOND // 2,
        done=done,
    )


def _policy(site: Site, topic: str) -> PolicyName:
    found = site.classify(topic)
    alone = found.kind is StreamKind.STATE and len(site.publishers(topic)) <= 1
    cancels = site.type_of(topic).startswith(_CANCELS)
    if found.sharing is Sharing.MERGE or cancels or alone:
        return PolicyName.BLOCK
    if found.domain is Domain.PLANNING or found.kind is StreamKind.ACTION:
        return PolicyName.PRIORITY_QUEUE
    return PolicyName.PREEMPTION if found.domain is Domain.CONTROL else PolicyName.BLOCK


def _flows(publishers: list[str], timeout: int | None) -> tuple[Flow, ...]:
    return tuple(
        Flow(
            name=f"flow{rank + 1}", publisher=node, priority=len(publishers) - rank, timeout=timeout
        )
        for rank, node in enumerate(publishers)
    )


def _done(site: Site, topic: str) -> str | None:
    """Return the topic, or action of ROS 2, that tells the end of what a goal started."""
    if site.graph.ros != 1:
        return _requested(site, topic)
    space = topic.removesuffix("/goal").removesuffix("_simple")
    served = (name for node in site.successors(topic) for name in site.servers.get(node, ()))
    names = [space, *served] if topic.endswith("/goal") else []
    return next((f"{name}/result" for name in names if f"{name}/result" in site.topics), None)


def _requested(site: Site, topic: str) -> str | None:
    """Return the action of ROS 2 that poses on a topic become: Nav2's, or its server's only one."""
    space, _, last = topic.rpartition("/")
    if last not in _POSES:
        return None
    served = {name for node in site.successors(topic) for name in site.servers.get(node, ())}
    nav2 = f"{space}/navigate_to_pose"
    return nav2 if nav2 in served else served.pop() if len(served) == 1 else None


def _timeout(kind: StreamKind) -> int | None:
    return {StreamKind.ACTION: UNSEEN_GOAL, StreamKind.STATE: UNSEEN_STATE}.get(kind)
