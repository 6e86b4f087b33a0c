"""A plan with every kind of coordination node, and the world around a risk controller."""

from dataclasses import dataclass, field

from rtron.planning import parse_plan
from rtron.service.controller.risk_controller import RiskController
from rtron.service.domain.clock import SteadyClock
from rtron.service.domain.principal import Principal, UserRole
from rtron.service.store.database import Database
from rtron.vocabulary import Plan, Settings
from rtron.wire.common.link_protocol import Hello

PLAN = """\
schema: rtron.plan/1
app: small
grcn:
  - id: drive
    topic: /cmd_vel
    type: geometry_msgs/Twist
    mode: enforce
    policy: Preemption
    successors: [/base]
    flows:
      - {name: flow1, publisher: /teleop, priority: 2}
      - {name: flow2, publisher: /planner, priority: 1}
rsrcn:
  id: speed
  mode: enforce
  policy: Safe
  threshold: 0.02 m/frame
  max_vel_limit: 0.5 m/s
  vflows:
    - topic: /max_vel
      type: std_msgs/Float64
      successors: [/base]
      flows: [{name: vflow1, publisher: /lane}]
msrcn:
  id: mission
  mode: enforce
  aflows:
    - topic: /goal
      type: geometry_msgs/PoseStamped
      successors: [/planner]
      flows:
        - {name: aflow1, publisher: /user}
        - {name: aflow2, publisher: /voice}
  eflows:
    - {name: night, topic: /night, publisher: /clock, present: 2 s}
    - {name: alone, topic: /person, publisher: /people, silent: 5 s}
  rules:
    - {name: quiet, when: night, block: [/goal], mandatory: true}
    - {name: watched, when: alone, block: [aflow2]}
fps_monitor:
  - {id: eyes, node: /signs, topic: /signs/image}
"""


def plan(text: str = PLAN) -> Plan:
    return parse_plan(text)


def plan_with(old: str, new: str) -> Plan:
    assert old in PLAN
    return plan(PLAN.replace(old, new))


def hello(plan: Plan, *, revision: int = 0, app: str = "small", **keys) -> Hello:
    keys.setdefault("settings", Settings(revision=revision))
    return Hello(app=app, plan=plan, run="r1", began=1, version="0", **keys)


@dataclass
class RecordingChannel:
    """What a hub is told, in order."""

    pushed: list[tuple[str, Settings]] = field(default_factory=list)
    messages: list[dict] = field(default_factory=list)

    def push(self, robot: str, settings: Settings) -> bool:
        self.pushed.append((robot, settings))
        return True

    def is_connected(self, _robot: str) -> bool:
        return True

    def broadcast(self, live: dict) -> None:
        self.messages.append(live)


@dataclass
class FixedClock:
    now: int = 1_000

    def __call__(self) -> int:
        return self.now


def caller(*roles: UserRole, name: str = "ann") -> Principal:
    return Principal(name=name, roles=frozenset(roles), address="10.0.0.7")


DEVELOPER = caller(UserRole.DEVELOPER, name="dev")
END_USER = caller(UserRole.END_USER, name="eve")
ADMIN = caller(UserRole.ADMIN, name="root")
DEVELOPER_AND_END_USER = caller(UserRole.DEVELOPER, UserRole.END_USER, name="both")


@dataclass
class ControllerSetup:
    """A controller on a database of its own; `restarted` is the service after a restart."""

    database: Database
    guards: RecordingChannel = field(default_factory=RecordingChannel)
    clock: FixedClock = field(default_factory=FixedClock)
    monotonic: FixedClock | None = None

    def __post_init__(self) -> None:
        self.controller = RiskController(
            self.database,
            self.guards,
            self.clock,
            SteadyClock(self.clock, self.monotonic or self.clock),
        )

    def restarted(self) -> "ControllerSetup":
        return ControllerSetup(
            Database(self.database.url.render_as_string(hide_password=False)), clock=self.clock
        )
