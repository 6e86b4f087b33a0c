"""Robots and events for tests of the store."""

from rtron.service.store.events import EventBatch, add_events
from rtron.service.store.robots import register_robot
from rtron.service.store.tables import AppRow, CoordinationNodeRow
from rtron.vocabulary import Decision, EventKind, GuardEvent

SECOND = 1_000_000_000


def new_robot(database, name="robot", nodes=()):
    """Make a robot with an app that has coordination nodes; return its id."""
    with database.session() as session:
        robot = register_robot(session, name, 1)
        app = AppRow(robot_id=robot.id, name="app", plan={}, digest="", ros=1, created=1, changed=1)
        session.add(app)
        session.flush()
        robot.app_id = app.id
        for position, node in enumerate(nodes):
            session.add(_node(app.id, position, node))
        return robot.id


def _node(app_id, position, node):
    return CoordinationNodeRow(
        app_id=app_id,
        node=node,
        position=position,
        type="GRCN",
        description="",
        risk_information={},
        policy_settings={},
        triggered=None,
        violation=None,
    )


def make_event(number=1, **values):
    """Make an event."""
    made = {"run": "run", "at": number * SECOND, "kind": EventKind.OWNER, **values}
    return GuardEvent(number=number, **made)


def make_verdict(number, decision=Decision.DROP, node="grcn", **values):
    """Make the event of a verdict."""
    return make_event(number, kind=EventKind.VERDICT, decision=decision, node=node, **values)


def store_events(database, robot_id, events, now=1, robot="robot"):
    """Store events; return the rows that are new."""
    with database.session() as session:
        batch = EventBatch(robot_id, robot, events)
        return [each.row for each in add_events(session, now, [batch])]
