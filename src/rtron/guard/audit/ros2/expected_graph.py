"""What a plan says about who speaks to whom in ROS 2: its topics, and its actions' services.

A service is two topics to the middleware, a request and a reply, whose names no ROS name begins
like (design.ros2.org: Topic and Service name mapping to DDS); they are kept by those names.
"""

from collections.abc import Iterator

from rtron.guard.audit.ros1.expected_graph import Entrance, is_open, meant
from rtron.vocabulary import (
    GUARD_NODE,
    PRIVATE_ROOT,
    SUPERVISOR_NODE,
    ActionEnd,
    Mode,
    Plan,
    PlannedService,
    PlannedTopic,
    Stream,
    end_name,
    flow_topic,
    normalise_type,
    output_topic,
    planned_services,
    planned_topics,
    stage_nodes,
    streams,
)
from rtron.vocabulary.topic_access import ANYBODY

_MOVING = (ActionEnd.SEND_GOAL, ActionEnd.CANCEL_GOAL)


class Wanted:
    """Who may speak on each topic that an enforced stream has closed.

    `guarding` are the guard's nodes on these streams, `own` all of them and the supervisor's.
    `outputs` are the private outputs by their public names, `types` the streams' types by theirs.
    """

    def __init__(self, plan: Plan) -> None:
        enforced = [stream for stream in streams(plan) if stream.mode is Mode.ENFORCE]
        actions = [stream for stream in enforced if stream.by_request]
        self.actions = frozenset(stream.topic for stream in actions)
        closed = frozenset(stream.topic for stream in actions if stream.block_unapproved)
        planned = (*planned_topics(plan), *_served(plan, closed))
        self.topics = {topic.topic: topic for topic in planned}
        self.entrances = tuple(way for stream in enforced for way in _entrances(stream))
        self.outputs = dict(pair for stream in enforced for pair in _outputs(stream))
        self.types = {each.topic: normalise_type(each.type) for each in enforced}
        self.guarding = frozenset(
            {GUARD_NODE, *(node for stream in enforced for node in stage_nodes(stream))}
        )
        self.own = self.guarding.union({SUPERVISOR_NODE}, *map(stage_nodes, streams(plan)))
        named = {name for t in self.topics.values() for name in (*t.publishers, *t.subscribers)}
        self._nodes = tuple(sorted(named - self.own - {ANYBODY}))

    def private(self) -> Iterator[PlannedTopic]:
        """Yield the topics that only the guard and those whom it stands between know."""
        return (t for t in self.topics.values() if spoken(t.topic).startswith(PRIVATE_ROOT + "/"))

    def plans(self, node: str) -> bool:
        """Tell whether a node is one that the guard stands before or behind."""
        return node not in self.own and meant(self._nodes, node)

    def succeeds(self, node: str) -> bool:
        """Tell whether a node is behind the guard: what it is told moves the robot."""
        outputs = (self.topics[private] for private in self.outputs.values())
        return node not in self.own and any(topic.may_subscribe(node) for topic in outputs)

    def type_on(self, topic: PlannedTopic) -> str:
        """Return the type that the plan wants on a topic, in ROS 1's spelling; "" if any."""
        return "" if topic.guarded in self.actions else self.types.get(topic.guarded, "")

    def leaves_guard(self, topic: PlannedTopic) -> bool:
        """Tell whether others than the guard rely on what is said on a topic."""
        return not is_open(topic) and any(name not in self.own for name in topic.subscribers)


def is_service(topic: str) -> bool:
    """Tell whether a topic is one of a service's two."""
    return not topic.startswith("/")


def spoken(topic: str) -> str:
    """Return the ROS name of a topic or of the service that it belongs to."""
    if not is_service(topic):
        return topic
    return topic[2:].removesuffix("Request").removesuffix("Reply")


def request_topic(service: str) -> str:
    """Return the middleware's name of a service's requests."""
    return f"rq{service}Request"


def _reply_topic(service: str) -> str:
    return f"rr{service}Reply"


def _outputs(stream: Stream) -> Iterator[tuple[str, str]]:
    if not stream.by_request:
        yield stream.topic, output_topic(stream.topic)
        return
    for end in _MOVING:
        public, private = stream.topic, output_topic(stream.topic)
        yield request_topic(end_name(public, end)), request_topic(end_name(private, end))


def _entrances(stream: Stream) -> Iterator[Entrance]:
    for flow in stream.flows:
        public, private = stream.topic, flow_topic(stream.topic, flow.name)
        names = [(public, private)]
        if stream.by_request:
            ends = [(end_name(public, each), end_name(private, each)) for each in _MOVING]
            names = [(request_topic(one), request_topic(other)) for one, other in ends]
        for outside, inside in names:
            yield Entrance(public=outside, private=inside, publishers=(flow.publisher,))


def _served(plan: Plan, closed: frozenset[str]) -> Iterator[PlannedTopic]:
    """Yield the requests and replies of the actions' services.

    Who only asks for a result moves nothing. `closed` are the actions that strangers may not use.
    """
    for each in planned_services(plan):
        public = each.service.startswith(f"{each.guarded}/")
        clients = each.servers if public and each.guarded in closed else each.clients
        if not each.service.endswith(ActionEnd.GET_RESULT):
            yield _planned(each, request_topic(each.service), clients, each.servers)
        yield _planned(each, _reply_topic(each.service), each.servers, clients)


def _planned(
    service: PlannedService, topic: str, publishers: tuple[str, ...], subscribers: tuple[str, ...]
) -> PlannedTopic:
    guarded = service.guarded
    return PlannedTopic(
        topic=topic, guarded=guarded, publishers=publishers, subscribers=subscribers
    )
