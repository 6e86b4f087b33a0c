"""The plan of the soaked app, with every kind of coordination node."""

from string import Template

from bench.soak.names import COMMANDS, DOCK, IMAGES, PERSON

THRESHOLD, MAX_SPEED, LOWEST = 0.04, 0.35, 0.04
"""The RSRCN's limits: metres a frame, m/s, and m/s where the camera is silent."""
DECEL = 2.5
"""How the robot is stopped, m/s2."""
_GOALS = {1: (f"{DOCK}/goal", "actionlib/TestActionGoal"), 2: (DOCK, "test_msgs/action/Fibonacci")}
_FLOWS = "[{name: flow1, publisher: /nav, priority: 2}, {name: flow2, publisher: /joystick}]"
_COMMANDS = f"topic: {COMMANDS}, type: geometry_msgs/Twist, successors: [/base], flows: {_FLOWS}"
_PLAN = Template("""\
schema: rtron.plan/1
app: soak
ros: $ros
grcn:
  - {id: drive, mode: enforce, policy: Preemption, $commands}
  - id: look
    topic: $images
    type: sensor_msgs/Image
    kind: state
    mode: enforce
    policy: Preemption
    flows: [{name: flow1, publisher: /camera}]
    successors: [/viewer]
  - id: goals
    topic: $goals
    type: $goal_type
    mode: enforce
    policy: FIFO_Queue
    max_age: 60 s
    flows: [{name: flow1, publisher: /planner}]
    successors: [/dock]
fps_monitor:
  - {id: eyes, node: /camera, topic: $images}
rsrcn:
  id: speed
  mode: enforce
  policy: Safe+Constrain
  threshold: $threshold m/frame
  max_vel_limit: $max_speed m/s
  lowest: $lowest m/s
  vflows: [{$commands}]
msrcn:
  id: mission
  mode: enforce
  policy: Block
  eflows:
    - {name: person, topic: $person, publisher: /detector, type: std_msgs/Bool, when: event.data}
  aflows: [{$commands}]
  rules:
    - {name: keep_off, when: person, block: [$topic], reason: somebody is in the way}
stop: {decel: $decel m/s2}
audit: {on_foreign: stop}
""")


def soak_plan(ros: int, stall_after: str = "") -> str:
    """Return the text of the plan for one ROS, with a `stall_after` of its own if one is given."""
    goals, goal_type = _GOALS[ros]
    supervision = f"supervision: {{stall_after: {stall_after}}}\n" if stall_after else ""
    return supervision + _PLAN.substitute(
        ros=ros,
        goals=goals,
        goal_type=goal_type,
        commands=_COMMANDS,
        images=IMAGES,
        person=PERSON,
        topic=COMMANDS,
        threshold=THRESHOLD,
        max_speed=MAX_SPEED,
        lowest=LOWEST,
        decel=DECEL,
    )
