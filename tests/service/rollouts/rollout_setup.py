"""Roll-outs on a real database, with guards that answer at once and show what a test says."""

from controller_setup import ControllerSetup, caller, hello, plan

from rtron.service.domain.principal import UserRole
from rtron.service.domain.rollouts.schemas import NewRollout, RobotSelection, RolloutCancellation
from rtron.service.live.live_robots import LiveRobot
from rtron.service.rollouts.changes import RobotChanges
from rtron.service.rollouts.control import (
    cancel_rollout,
    pause_rollout,
    resume_rollout,
    rollout_robot_page,
    rollout_view,
)
from rtron.service.rollouts.runner import RolloutRunner
from rtron.service.rollouts.start import start_rollout
from rtron.service.store.accounts.users import add_user
from rtron.service.store.database import Database
from rtron.service.store.events import EventBatch, add_events
from rtron.service.store.robots import find_robot
from rtron.vocabulary import SECOND, GuardEvent, GuardState
from rtron.wire.common.link_protocol import Applied

NODES = {"drive": {"policy": "Block"}}
ANN = caller(UserRole.DEVELOPER, name="ann")


class FakeFleet:
    """What robots are at now; those of `off` are not connected."""

    def __init__(self):
        self.states, self.off = {}, set()

    def find(self, _session, robots):
        return {
            robot: LiveRobot()
            if robot in self.off
            else LiveRobot(
                connected=True, state=self.states.get(robot, GuardState(at=0, revision=0))
            )
            for robot in robots
        }


class RolloutSetup:
    """A service with `size` robots; guards answer what they are sent, `refusing` ones with no.

    Those of `planless` robots know of no plans.
    """

    def __init__(self, database, size=10, fleet=None):
        self.world = ControllerSetup(database)
        self.world.clock.now = 1_000_000 * SECOND
        self.fleet = fleet or FakeFleet()
        self.robots = [f"car{index}" for index in range(size)]
        self.refusing, self.planless, self.opened, self._answered = set(), set(), [], 0
        self.live_messages = []
        self._runner()

    def _runner(self):
        world = self.world
        changes = RobotChanges(world.database, world.controller, world.clock)
        broadcast = self.live_messages.append
        self.runner = RolloutRunner(world.database, changes, self.fleet, world.clock, broadcast)

    def meet(self):
        """Let every guard say hello, and ann be a developer."""
        with self.world.database.session() as session:
            add_user(session, 0, "ann", "no hash", [UserRole.DEVELOPER])
        for robot in self.robots:
            self.world.controller.handle_hello(robot, hello(plan()))
            self.world.controller.handle_applied(robot, Applied(revision=0))
        return self

    def restarted(self):
        """Return the same after a kill of the service."""
        database = Database(self.world.database.url.render_as_string(hide_password=False))
        self.opened.append(database)
        again = RolloutSetup(database, len(self.robots), self.fleet)
        again.opened = self.opened
        again.world.clock.now = self.world.clock.now
        return again

    def close(self):
        """Close the databases of restarted services."""
        for database in self.opened:
            database.close()

    @staticmethod
    def new_rollout(nodes=None, **values):
        selection = values.pop("robots", RobotSelection(app="small"))
        change = {} if "plan" in values else {"nodes": nodes or NODES}
        given = {**change, "reason": "visitors", "wait": 60, **values}
        return NewRollout(robots=selection, **given)

    def start(self, who=ANN, nodes=None, **values):
        new = self.new_rollout(nodes, **values)
        with self.world.database.session() as session:
            return start_rollout(session, who, new, self.world.clock()).id

    def run(self, seconds=0, steps=1):
        """Let time pass, then take roll-outs further; guards answer after each step."""
        for _ in range(steps):
            self.world.clock.now += seconds * SECOND
            while self.runner.run_once():
                self.answer()

    def answer(self):
        pushed = self.world.guards.pushed
        for robot, settings in pushed[self._answered :]:
            if robot not in self.fleet.off:
                error = "no" if robot in self.refusing else ""
                plan = "" if robot in self.planless else settings.plan
                answer = Applied(revision=settings.revision, error=error, plan=plan)
                self.world.controller.handle_applied(robot, answer)
        self._answered = len(pushed)

    def tell(self, robot, kind, run="r1", number=1):
        """Store an event of a robot's guard."""
        with self.world.database.session() as session:
            row, _ = find_robot(session, robot)
            event = GuardEvent(run=run, number=number, at=1, kind=kind)
            add_events(session, self.world.clock(), [EventBatch(row.id, robot, [event])])

    def view(self, id):
        with self.world.database.session() as session:
            return rollout_view(session, id)

    def members(self, id):
        with self.world.database.session() as session:
            return rollout_robot_page(session, id, -1, 1000).robots

    def reached(self, id):
        return [each.robot for each in self.members(id) if each.phase in {"sent", "sending"}]

    def control(self, action, id, who=ANN, **values):
        with self.world.database.session() as session:
            if action == "cancel":
                request = RolloutCancellation(reason="enough", **values)
                return cancel_rollout(session, who, id, request, self.world.clock())
            change = {"pause": pause_rollout, "resume": resume_rollout}[action]
            return change(session, who, id, "lunch", self.world.clock())
