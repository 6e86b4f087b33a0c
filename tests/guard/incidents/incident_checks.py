"""What an incident of a real guard must be, whichever ROS it is of."""

from collections import Counter

from guarded_drive import ALLOWED, FAST
from harness import wait_for
from mcap.reader import make_reader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from rtron.guard.system.state_folder import INCIDENTS, state_folder
from rtron.sources.bag.incident import IncidentFile
from rtron.vocabulary import SECOND
from rtron.workflows.incidents import read_account

CMD = "/cmd_vel"


def incidents_of(app):
    """Return the incidents that the guard of an app has saved."""
    return sorted((state_folder(app) / INCIDENTS).glob("*.mcap"))


def wait_for_incident(app, kind="intervention", topic=CMD):
    """Return the first incident with a third of a second of what a cause did, or more.

    A busy machine has others, too: they may end just then, or be alarms about the guard itself,
    such as of a process that got no processor.
    """

    def found():
        headers = ((path, IncidentFile(path).header) for path in incidents_of(app))
        return [path for path, header in headers if _shows(header, kind, topic)]

    return wait_for(found, what=f"an incident with an {kind} on {topic}")[0]


def _shows(header, kind, topic):
    return any(
        (each.kind, each.topic) == (kind, topic) and each.at <= header.end - SECOND // 3
        for each in header.causes
    )


def kinds_of(path):
    return {cause.kind for cause in IncidentFile(path).header.causes}


def check_limited_drive(path, ros, publisher):
    """Check an incident of a base that was told to drive at 1 m/s and did at 0.25 m/s."""
    account = read_account(IncidentFile(path))
    assert account.header.ros == ros
    assert (CMD, "intervention") in {(each.topic, each.kind) for each in account.header.causes}
    topic = account.topics[CMD]
    (flow,) = topic.commands
    assert topic.publishers[flow] == publisher
    assert {each.speed for _, each in topic.commands[flow]} == {FAST}
    assert max(each.speed for _, each in topic.output) == ALLOWED
    assert ALLOWED in [limit for _, limit in topic.limits]
    assert (flow, publisher) in [(owner, node) for _, owner, node, _ in topic.owners]
    assert topic.verdicts[flow, "modify"] > 5
    assert sum(topic.verdicts.values()) == len(topic.commands[flow])


def check_messages_are_their_schemas(path, ros):
    """Let a library that is not ours read each message by the schema that the file has of it."""
    with path.open("rb") as stream:
        reader = make_reader(stream)
        assert reader.get_header().profile == f"ros{ros}"
        found = Counter(_speed(ros, *each) for each in reader.iter_messages())
    assert found["/cmd_vel/out", ALLOWED] > 0
    assert found["in", FAST] > 0


def _speed(ros, schema, channel, message):
    """Return a channel's name and the speed in a message, as rosbags reads it."""
    if channel.message_encoding == "json":
        return channel.topic, None
    assert schema.encoding == f"ros{ros}msg"
    name = schema.name if "/msg/" in schema.name else schema.name.replace("/", "/msg/")
    store = get_typestore(Stores.EMPTY)
    store.register(get_types_from_msg(schema.data.decode(), name))
    read = store.deserialize_ros1 if ros == 1 else store.deserialize_cdr
    place = channel.topic.removeprefix("/rtron")
    return place if place.endswith("/out") else "in", read(message.data, name).linear.x
