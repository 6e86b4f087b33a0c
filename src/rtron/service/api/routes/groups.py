"""Groups of robots, and the labels that make them."""

from http import HTTPStatus

from fastapi import APIRouter, Response

from rtron.service.api.account_change_requests import change_account
from rtron.service.api.auth.authorization import AdminOnly, Reader
from rtron.service.api.context import ServiceDependency
from rtron.service.api.schemas import GroupMembers, GroupView, PendingChangeView, RobotLabels
from rtron.service.domain.account_changes import FormGroup, LabelRobot
from rtron.service.domain.schemas import Name
from rtron.service.store.fleet.labels import group_sizes
from rtron.service.store.robots import RobotFilter, list_robots

router = APIRouter()


@router.get("/groups")
def list_groups(_caller: Reader, service: ServiceDependency) -> list[GroupView]:
    """Return every group by name: the robots that have its name as a label."""
    with service.database.session() as session:
        return [GroupView(name=name, robots=robots) for name, robots in group_sizes(session)]


@router.get("/groups/{group}")
def get_group(group: Name, _caller: Reader, service: ServiceDependency) -> GroupMembers:
    """Return the robots of a group, by name."""
    with service.database.session() as session:
        robots = list_robots(session, RobotFilter(label=group))
    return GroupMembers(robots=[robot.name for robot, _ in robots])


@router.put("/groups/{group}")
def set_members(
    group: Name,
    given: GroupMembers,
    caller: AdminOnly,
    service: ServiceDependency,
    response: Response,
) -> GroupView | PendingChangeView:
    """Make these robots the group, instead of those that it has: they get its name as a label.

    202 if a second admin has to approve that robots are added.
    """
    change = FormGroup(name=group, robots=frozenset(given.robots))
    done = change_account(service, caller, change)
    if isinstance(done, PendingChangeView):
        response.status_code = HTTPStatus.ACCEPTED
        return done
    return GroupView(name=group, robots=len(change.robots))


@router.put("/robots/{robot}/labels")
def set_labels(
    robot: Name,
    given: RobotLabels,
    caller: AdminOnly,
    service: ServiceDependency,
    response: Response,
) -> RobotLabels | PendingChangeView:
    """Give a robot its labels, instead of those that it has: they say who may change it.

    202 if a second admin has to approve that labels are added.
    """
    change = LabelRobot(name=robot, labels=frozenset(given.labels))
    done = change_account(service, caller, change)
    if isinstance(done, PendingChangeView):
        response.status_code = HTTPStatus.ACCEPTED
        return done
    return RobotLabels(labels=sorted(change.labels))
