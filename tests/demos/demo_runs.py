"""Runs that never were, for tests of what is made of runs."""

from math import cos, pi, sin

from rtron.demos.metrics.case_run import SECOND, CaseRun, Variant
from rtron.demos.metrics.message_journal import Attack, measure_deviation
from rtron.demos.world.ground_truth import GroundTruth
from rtron.demos.world.scenes.scene import (
    Crossing,
    PolygonObstacle,
    RoundObstacle,
    Scene,
    room_walls,
)

BEGAN = 1_000.0
SPEED = 2.0
PROPOSED = """
schema: rtron.plan/1
app: demo
grcn:
  - id: grcn_cmd_vel
    topic: /cmd_vel
    type: geometry_msgs/Twist
    domain: Control
    kind: command
    sharing: contend
    mode: observe
    policy: Block
    flows:
      - {name: flow1, publisher: /move_base, priority: 1}
      - {name: flow2, publisher: /stranger, priority: 2}
    successors: [/base]
  - id: grcn_goal
    topic: /goal
    type: geometry_msgs/PoseStamped
    domain: Planning
    kind: action
    sharing: contend
    mode: enforce
    policy: Priority_Queue
    flows: [{name: flow1, publisher: /mission, priority: 1, timeout: 10 s}]
    successors: [/move_base]
rsrcn:
  id: rsrcn
  mode: enforce
  policy: Block
  vflows:
    - topic: /max_vel
      type: std_msgs/Float64
      flows: [{name: vflow1, publisher: /max_velocity}]
      successors: [/move_base]
msrcn:
  id: msrcn
  mode: enforce
  policy: Block
  aflows:
    - topic: /goal
      type: geometry_msgs/PoseStamped
      flows: [{name: aflow2, publisher: /mission}]
      successors: [/move_base]
    - topic: /teleop
      type: geometry_msgs/Twist
      flows: [{name: aflow1, publisher: /stick}]
      successors: [/base]
fps_monitor:
  - id: fps_eyes
    node: /eyes
    topic: /seen
    camera: {name: camera, topic: /image, publisher: /camera}
"""
CORRIDOR = Scene(
    case="gr",
    seed=1,
    size=(5.0, 1.2),
    walls=((0, 0, 5, 0), (0, 1.2, 5, 1.2)),
    obstacles=(),
    start=(0.4, 0.6, 0.0),
    goal=(4.5, 0.6),
    route=((0.4, 0.6), (4.5, 0.6)),
)
WALKS = (((2.8, 1.3), (2.8, 3.0)), ((4.0, 1.2), (4.0, 2.8)))
ROOM = Scene(
    case="msr",
    seed=1,
    size=(5.0, 4.0),
    walls=room_walls(5.0, 4.0),
    obstacles=(
        RoundObstacle((2.0, 2.4), 0.25),
        PolygonObstacle(((3.2, 1.9), (3.7, 1.9), (3.7, 2.3), (3.2, 2.3))),
    ),
    area=((1.8, 0.2), (3.6, 0.2), (3.6, 1.1), (1.8, 1.1)),
    light=(4.2, 3.4),
    crossings=tuple(
        Crossing(start=start, stand=stand, trigger_distance=1.3, pause=4.0, pace=1.6)
        for start, stand in WALKS
    ),
    start=(0.5, 0.6, 0.8),
    goal=(4.5, 2.2),
    bad_goal=(2.7, 0.7),
    route=((0.5, 0.6), (4.5, 2.2)),
)


def corridor_drive(turn_at=None):
    """Return samples of a drive along the corridor; it bends to the right from `turn_at` (s) on."""
    x, y, heading, found, step = 0.4, 0.6, 0.0, [], 0.05
    for number in range(int(20.0 / step)):
        t = number * step
        turn = -0.2 if turn_at is not None and t > turn_at else 0.0
        heading += turn * step
        speed = min(0.22, 0.3 * t) if x < 4.5 else 0.0
        x, y = x + speed * cos(heading) * step, y + speed * sin(heading) * step
        collided = y < 0.105
        found.append(
            GroundTruth(
                t=t,
                run=1,
                pose=(x, y, heading),
                velocity=(speed, turn),
                commanded=(speed, turn),
                clearance=max(0.0, y - 0.105),
                collided=collided,
                in_area=False,
                light="none",
                pedestrians=(),
                distance_to_goal=abs(4.5 - x),
            )
        )
        if collided:
            break
    return tuple(found)


def places(samples):
    return [each.position for each in samples]


def guard_event(at, kind="verdict", **values):
    """Return an event at `at` wall s."""
    words = dict.fromkeys(("topic", "flow", "publisher", "decision"), "")
    return {"at": round(at * SECOND), "kind": kind, **words, "values": {}} | values


def counted(at, **flows):
    """Return an event that counts what /cmd_vel's flows met in the wall second before `at`."""
    streams = {"/cmd_vel": {"flows": {name: list(counts) for name, counts in flows.items()}}}
    return guard_event(at, "counts", values={"streams": streams, "fps": {}})


def guard_events():
    """Return the events of a guarded run of the corridor."""
    named = [
        guard_event(BEGAN, topic="/cmd_vel", flow="flow1", publisher="/move_base", decision="pass"),
        guard_event(
            BEGAN + 2.5004,
            topic="/cmd_vel",
            flow="flow2",
            publisher="/tb3_safe_control",
            decision="drop",
        ),
    ]
    for second in range(1, 11):
        flood = 100 if second > 3 else 30 if second == 3 else 0
        others = 80 if second > 5 else 0
        flows = {"flow1": (20, 0, 0, 0), "flow2": (0, 0, flood, 0), "unapproved": (0, 0, others, 0)}
        named.append(counted(BEGAN + second, **flows))
    return tuple(named)


def attack_of(ended, delivered):
    """Return an attack of 700 messages from 5 simulated s on, of which some were delivered."""
    times = [BEGAN + (5.0 + (ended - 5.0) * n / 699) / SPEED for n in range(700)]
    return Attack(tuple(times), tuple(times[:delivered]))


def make_run(variant, **values):
    """Return a run of the corridor."""
    turn_at = 5.0 if variant is Variant.ATTACKED else None
    samples = corridor_drive(turn_at=turn_at)
    attacked = variant is not Variant.UNATTACKED
    harm = "collision" if variant is Variant.ATTACKED else ""
    defaults = {
        "case": "gr",
        "ros": 1,
        "seed": 1,
        "speed": SPEED,
        "variant": variant,
        "completed": not harm,
        "harm": harm,
        "collided": bool(harm),
        "ended": samples[-1].t,
        "time_to_goal": None if harm else 19.1,
        "harmed_at": samples[-1].t if harm else None,
        "attack": attack_of(samples[-1].t, 180 if harm else 0) if attacked else Attack(),
        "mitigated_after": 0.0004 if variant is Variant.GUARDED else None,
        "deviation": measure_deviation(places(samples), places(corridor_drive())),
        "start_wall": BEGAN,
        "samples": samples,
        "events": guard_events() if variant is Variant.GUARDED else (),
    }
    defaults["publishers"] = {
        ("/cmd_vel", "flow1"): "/move_base",
        ("/cmd_vel", "flow2"): "/tb3_safe_control",
    }
    return CaseRun(**defaults | values)


def runs_by_variant(**values):
    """Return the three runs of a case by variant."""
    return {variant: make_run(variant, **values) for variant in Variant}


CIRCLE = tuple((cos(2 * pi * n / 200), sin(2 * pi * n / 200)) for n in range(201))
