"""Alarms as people of a shift handle them: which there are, who has seen them, what is left."""

from collections import defaultdict
from collections.abc import Sequence

from sqlalchemy.orm import Session

from rtron.service.controller.robot_snapshot import list_robot_summaries
from rtron.service.domain.alarms import Acknowledgement, alarm_key
from rtron.service.domain.errors import NotFoundError
from rtron.service.domain.schemas import RobotSummary
from rtron.service.domain.shifts import AlarmReference, Situation
from rtron.service.live.live_robots import LiveRobots
from rtron.service.store.notices import AcknowledgedNotice, post_notice
from rtron.service.store.robots import RobotFilter, find_robot
from rtron.service.store.settings import ChangeAuthor
from rtron.service.store.shifts import acknowledge, acknowledgements_in_force


def present_alarms(
    session: Session, live: LiveRobots, alarms: Sequence[AlarmReference]
) -> tuple[dict[str, list[AlarmReference]], list[AlarmReference]]:
    """Return the alarms that there are now, by robot, and those that are none any more."""
    present, gone = defaultdict(list), []
    robots = live.find(session, {alarm.robot for alarm in alarms})
    for alarm in alarms:
        state = robots[alarm.robot].state
        if state and alarm.key in {alarm_key(each) for each in state.alarms}:
            present[alarm.robot].append(alarm)
        else:
            gone.append(alarm)
    return dict(present), gone


def acknowledge_present(
    session: Session, robot: str, alarms: Sequence[AlarmReference], author: ChangeAuthor
) -> Sequence[Acknowledgement]:
    """Note that somebody has seen alarms of a robot; return all that is acknowledged of it now."""
    match = find_robot(session, robot)
    if match is None:
        raise NotFoundError("there is no such robot", help="GET /api/v1/robots lists them")
    keys = {alarm.key for alarm in alarms}
    acknowledge(session, match[0].id, keys, author)
    post_notice(session, AcknowledgedNotice(robot=robot))
    return acknowledgements_in_force(session, [match[0].id]).get(robot, ())


def current_situation(session: Session, live: LiveRobots) -> Situation:
    """Return how many robots there are, and of how many something is the matter."""
    robots = list_robot_summaries(session, live, RobotFilter())
    return Situation(
        robots=len(robots),
        connected=sum(robot.connected for robot in robots),
        stopped=sum(robot.stop is not None for robot in robots),
        overridden=sum(bool(robot.overridden) for robot in robots),
        alarms=sum(len(robot.alarms) for robot in robots),
        acknowledged=sum(map(_acknowledged_count, robots)),
    )


def _acknowledged_count(robot: RobotSummary) -> int:
    known = {each.key for each in robot.acknowledged}
    return sum(alarm_key(alarm) in known for alarm in robot.alarms)
