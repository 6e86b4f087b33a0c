"""Robots and events for tests of the store."""

from service_app import SIGNER

from rtron.service.store.chain_pruning import ChainCutter
from rtron.service.store.events import EventBatch, add_events
from rtron.service.store.partitions.event_partitions import begin_partition
from rtron.service.store.retention import prune_events
from rtron.service.store.robots import register_robot
from rtron.service.store.tables import AppRow, CoordinationNodeRow
from rtron.vocabulary import Decision, EventKind, GuardEvent

SECOND = 1_000_000_000


def prune(database, limits, now, refused=None, signer=SIGNER):
    """Let the retention delete; yield how many events it has deleted after each transaction.

    `refused` gets what is wrong with the chains that it leaves as they are.
    """
    cutter = ChainCutter(signer, lambda: now)
    yield from prune_events(database, limits, now, cutter)
    if refused is not None:
        refused.update(cutter.refused)


def age_partitions(database):
    """Let new events go into another partition on PostgreSQL, and those there may be dropped."""
    if not database.is_sqlite:
        with database.own_connection(60) as connection:
            begin_partition(connection)
            begin_partition(connection)


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
