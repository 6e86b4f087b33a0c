"""What people of one shift note for the others: which alarms they have seen, and handovers."""

from collections.abc import Collection, Mapping, Sequence

from sqlalchemy import ColumnElement, and_, or_, select, update
from sqlalchemy.orm import Session

from rtron.service.domain.alarms import Acknowledgement, AlarmKey, clean_key
from rtron.service.domain.shifts import Handover, Situation
from rtron.service.store.events import StoredEvent
from rtron.service.store.notices import AcknowledgedNotice, HandoverNotice, post_notice
from rtron.service.store.settings import ChangeAuthor
from rtron.service.store.tables import AcknowledgementRow, HandoverRow, RobotRow
from rtron.vocabulary import EventKind

_ENDING_KINDS = frozenset({EventKind.ALARM.value, EventKind.ALARM_CLEARED.value})


def acknowledge(
    session: Session, robot_id: int, keys: Collection[AlarmKey], author: ChangeAuthor
) -> None:
    """Note that somebody has seen alarms of a robot; who had seen them before, has no more."""
    _end(session, author.at, [(robot_id, key) for key in keys])
    for kind, topic, node, peer in keys:
        row = AcknowledgementRow(
            robot_id=robot_id, kind=kind, topic=topic, node=node, peer=peer,
            by=author.by, note=author.reason, at=author.at, ended=None,
        )  # fmt: skip
        session.add(row)
    session.flush()


def find_acknowledgements(
    session: Session, robot_names: Collection[str]
) -> dict[str, tuple[Acknowledgement, ...]]:
    """Return what is acknowledged now of each of these robots."""
    ids = session.scalars(select(RobotRow.id).where(RobotRow.name.in_(robot_names))).all()
    found = acknowledgements_in_force(session, ids)
    return {name: found.get(name, ()) for name in robot_names}


def end_acknowledgements(
    session: Session, now: int, added: Sequence[StoredEvent]
) -> Mapping[str, Sequence[Acknowledgement]]:
    """End what events tell of again; return what is left, of each robot where something ended."""
    endings = [each for each in added if each.row["kind"] in _ENDING_KINDS]
    if not endings:
        return {}
    ended = _end(session, now, [(each.row["robot_id"], _alarm_key(each)) for each in endings])
    robots = {each.row["robot_id"]: each.robot for each in endings if each.row["robot_id"] in ended}
    left = acknowledgements_in_force(session, robots)
    for name in robots.values():
        post_notice(session, AcknowledgedNotice(robot=name))
    return {name: left.get(name, ()) for name in robots.values()}


def acknowledgements_in_force(
    session: Session, robot_ids: Collection[int] | None = None
) -> dict[str, tuple[Acknowledgement, ...]]:
    """Return what is acknowledged now, by the names of robots: of all, or of these."""
    query = select(AcknowledgementRow, RobotRow.name).join_from(AcknowledgementRow, RobotRow)
    query = query.where(AcknowledgementRow.ended.is_(None))
    if robot_ids is not None:
        query = query.where(AcknowledgementRow.robot_id.in_(robot_ids))
    found: dict[str, tuple[Acknowledgement, ...]] = {}
    for row, name in session.execute(query.order_by(AcknowledgementRow.id)):
        found[name] = (*found.get(name, ()), _view(row, name))
    return found


def list_acknowledgements(
    session: Session, before: int | None, limit: int
) -> Sequence[tuple[int, Acknowledgement]]:
    """Return acknowledgements with their ids, newest first, those older than `before`."""
    query = select(AcknowledgementRow, RobotRow.name).join_from(AcknowledgementRow, RobotRow)
    query = query.order_by(AcknowledgementRow.id.desc()).limit(limit)
    if before is not None:
        query = query.where(AcknowledgementRow.id < before)
    return [(row.id, _view(row, name)) for row, name in session.execute(query)]


def _view(row: AcknowledgementRow, robot: str) -> Acknowledgement:
    return Acknowledgement(
        robot=robot, kind=row.kind, topic=row.topic, node=row.node, peer=row.peer,
        by=row.by, note=row.note, at=row.at, ended=row.ended,
    )  # fmt: skip


def _end(session: Session, now: int, alarms: Sequence[tuple[int, AlarmKey]]) -> set[int]:
    """End the acknowledgements of alarms; return the robots where there were some."""
    condition = and_(
        AcknowledgementRow.ended.is_(None), or_(*(_is_alarm(id, key) for id, key in alarms))
    )
    ended = set(session.scalars(select(AcknowledgementRow.robot_id).where(condition)))
    if ended:
        session.execute(update(AcknowledgementRow).where(condition).values(ended=now))
    return ended


def _is_alarm(robot_id: int, key: AlarmKey) -> ColumnElement[bool]:
    row, (kind, topic, node, peer) = AcknowledgementRow, key
    return and_(
        row.robot_id == robot_id,
        row.kind == kind,
        row.topic == topic,
        row.node == node,
        row.peer == peer,
    )


def _alarm_key(event: StoredEvent) -> AlarmKey:
    """Return the alarm that an event tells of; its values are a stranger's."""
    values = event.row["values"]
    return clean_key(*(str(values.get(name, "")) for name in ("kind", "topic", "node", "peer")))


def add_handover(session: Session, by: str, text: str, situation: Situation, now: int) -> Handover:
    """Write a note."""
    row = HandoverRow(at=now, by=by, text=text, situation=situation.model_dump())
    session.add(row)
    session.flush()
    post_notice(session, HandoverNotice())
    return _handover_view(row)


def list_handovers(session: Session, before: int | None, limit: int) -> Sequence[Handover]:
    """Return notes, newest first, those older than `before`."""
    query = select(HandoverRow).order_by(HandoverRow.id.desc()).limit(limit)
    if before is not None:
        query = query.where(HandoverRow.id < before)
    return [_handover_view(row) for row in session.scalars(query)]


def _handover_view(row: HandoverRow) -> Handover:
    return Handover.model_validate(row, from_attributes=True)
