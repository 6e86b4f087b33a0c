"""A plan with an agent, a second one that goes past `rtron mcp`, and a person; their rights."""

from rtron.bridge.rights.tokens import token_hash

AGENT, ROGUE, PERSON = "/bridge/agent", "/bridge/rogue", "/bridge/person"
SPEED, TURN = 0.22, 1.0
"""The limits, m/s and rad/s."""
KITCHEN = "[{x: 2, y: 2}, {x: 4, y: 2}, {x: 4, y: 4}, {x: 2, y: 4}]"
PLAN = f"""
schema: rtron.plan/1
app: agents
ros: 1
leases:
  - {{name: base, ttl: 2 s}}
grcn:
  - id: grcn_cmd_vel
    topic: /cmd_vel
    type: geometry_msgs/Twist
    domain: Control
    kind: command
    sharing: contend
    mode: enforce
    policy: Lease
    lease: base
    successors: [/robot]
    flows:
      - {{name: person, publisher: {PERSON}, rank: operator_on_site}}
      - {{name: agent, publisher: {AGENT}, rank: agent}}
      - {{name: rogue, publisher: {ROGUE}, rank: agent}}
rsrcn:
  id: rsrcn
  mode: enforce
  policy: Constrain
  max_vel_limit: {SPEED}
  max_turn_limit: {TURN}
  vflows:
    - topic: /cmd_vel
      type: geometry_msgs/Twist
      successors: [/robot]
      flows:
        - {{name: person, publisher: {PERSON}}}
        - {{name: agent, publisher: {AGENT}}}
        - {{name: rogue, publisher: {ROGUE}}}
msrcn:
  id: msrcn
  mode: enforce
  policy: Block
  aflows:
    - topic: /cmd_vel
      type: geometry_msgs/Twist
      successors: [/robot]
      flows:
        - {{name: person, publisher: {PERSON}}}
        - {{name: agent, publisher: {AGENT}}}
        - {{name: rogue, publisher: {ROGUE}}}
    - topic: /goal
      type: geometry_msgs/PoseStamped
      successors: [/robot]
      flows:
        - {{name: agent_goal, publisher: {AGENT}}}
        - {{name: rogue_goal, publisher: {ROGUE}}}
  eflows:
    - name: in_kitchen
      topic: /odom
      publisher: /robot
      type: nav_msgs/Odometry
      when: inside(event.pose.pose.position, kitchen)
      frame: map
  areas:
    - {{name: kitchen, frame: map, polygon: {KITCHEN}}}
  rules:
    - {{name: stay_put, block: [/cmd_vel], when: in_kitchen, reason: it is in the kitchen}}
    - name: no_kitchen
      block: [/goal]
      action: inside(action.pose.position, kitchen)
      frame: map
      reason: the kitchen is forbidden
"""
_COMMANDS = """
    publish:
      - {topic: /cmd_vel, type: geometry_msgs/Twist, rate: 20}
      - {topic: /goal, type: geometry_msgs/PoseStamped, rate: 10}
      - {topic: /chat, type: std_msgs/String, approval: true}
      - {topic: /rtron/leases/base/request, type: std_msgs/String, rate: 20}
    subscribe:
      - {topic: /diagnostics, type: diagnostic_msgs/DiagnosticArray, rate: 5}
      - {topic: /rtron/leases/base/status, type: std_msgs/String}
      - {topic: /rtron/leases/base/answer, type: std_msgs/String}
"""
_PERSON = _COMMANDS.replace(
    "{topic: /goal, type: geometry_msgs/PoseStamped, rate: 10}",
    "{topic: /place, type: geometry_msgs/Pose2D}",
)
RIGHTS = f"""
schema: rtron.bridge/1
clients:
  - name: agent
    tokens: ["{token_hash("agent")}"]{_COMMANDS}
  - name: rogue
    tokens: ["{token_hash("rogue")}"]{_COMMANDS}
  - name: person
    tokens: ["{token_hash("person")}"]{_PERSON}
"""
