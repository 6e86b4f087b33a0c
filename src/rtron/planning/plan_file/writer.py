"""A plan as YAML that a person likes to read and edit; reading it gives the same plan."""

import re
from collections.abc import Iterator
from dataclasses import MISSING
from enum import Enum
from typing import Any

import yaml

from rtron.planning.plan_file.fields import PLAN_TYPES, PlanField, plan_fields
from rtron.planning.plan_file.json_schema import PLAN_SCHEMA_URL
from rtron.planning.plan_file.quantities import write_duration
from rtron.vocabulary import (
    PLAN_SCHEMA,
    EventFlow,
    Flow,
    LeaseGroup,
    MissionRule,
    Plan,
    Point,
    StopButton,
    Transform,
    UnguardedPath,
    WatchedFlow,
)

_HEADER = f"""\
# yaml-language-server: $schema={PLAN_SCHEMA_URL}
# What stands between the nodes of this app, and under which policies. Edit it freely, then run
# `rtron check`. Durations take a unit: 200 ms, 0.5 s, 2 min; so do velocities and all that is
# measured: 0.22 m/s, 0.8 km/h. What is left out has its default.
"""
_SECTIONS = {
    "grcn": """
# GRCN: one for each topic that several nodes share. `enforce` stands in the flow and decides,
# `observe` only watches. Preemption: the highest priority that speaks has the output.
# Priority_Queue and FIFO_Queue: one at a time, the others wait. Block: each flow has a bit.
# A flow that moved the robot and is silent for `silent_after` stops it (`on_silence: release`
# does not); so does a message that cannot be judged (`on_error: drop` only drops it).
# `uses: [linear.x, angular.z]`: all that the base obeys of a Twist. The rest is set to 0.
# The goals of an action (type pkg/NameActionGoal) stand for all five of its topics.
""",
    "rsrcn": """
# RSRCN: the one before everybody who obeys a velocity. It knows the rates of the image nodes
# (iflows) and decides about the velocities (vflows).
# Safe: at most `threshold` (0.02 m/frame) times the least rate, `lowest` where one is silent.
# Constrain: at most `max_vel_limit` (0.22 m/s). Safe+Constrain: the lower of the two.
# Beside them: `max_turn_limit` (1.5 rad/s), `max_side_limit` (0.1 m/s), `max_accel_limit` (1 m/s2).
# `mandatory: Constrain`: the end user can then select what includes it only, and lower the limit.
""",
    "msrcn": """
# MSRCN: the one before the actuators. It knows the events (eflows) and blocks the actions
# (aflows) that the rules of the mission forbid. What sets the bit of an eflow:
#   when: event.percentage < 0.2   the newest message says so (it needs `type`); NaN: unknown
#   present: 2 s                   a message came, with `when` one that says so
#   silent: 1 s                    none came
# A rule, with any combination of eflows (&&, ||, !), here with a goal inside a named area:
#   rules:
#     - name: keep_out
#       when: eflow1 && !eflow2
#       action: "inside(action.pose.position, kitchen)"
#       block: [/move_base_simple/goal]
#   areas:
#     - {name: kitchen, frame: map, polygon: [{x: 0 m, y: 0 m}, {x: 3 m, y: 0 m}, {x: 3 m, y: 2 m}]}
# `require: /alert` in a rule: what it blocks stays blocked until /alert has spoken.
# `mandatory: true` in a rule: the end user can neither deselect nor weaken it.
""",
    "fps_monitor": """
# fps_monitor: one for each image node, on the topic that it publishes for every frame, and no
# faster than its `camera`. `source: detections` where it only publishes what it detects: an empty
# scene then looks like a slow node.
""",
    "leases": """
# Who is in command of the GRCNs that say `policy: Lease` and `lease: NAME`. One publisher at a time
# holds a lease, and only it moves anything, once it has sent a neutral command. It asks for the
# lease, and renews it within `ttl` (5 s). The `rank` of a flow says who may take it from whom:
# emergency, operator_on_site, remote_operator, autonomy, agent. With `service: remote_operator`
# persons at the security service have that rank: they give the lease to a commander, or end it.
""",
    "stop_sources": """
# What stops the robot until a person releases it (`rtron release`), over restarts too: buttons that
# say true while they are pressed. With `second_person: 60 s` a second person must release it, too.
""",
    "stop": """
# How the guard stops the robot: a ramp of at most `decel` and `angular_decel`, but at rest `within`
# (1 s) in any case, a message every `period`, zeros for `repeat`, then nothing.
""",
    "audit": """
# How often the guard asks each guarded node who speaks to it, and whether it only raises an alarm
# when that is somebody else (`on_foreign: alarm`) or stops the robot too (`stop`).
""",
    "supervision": """
# When the supervisor acts: it stops the robot when the guard gives no sign of life for
# `stall_after` (30 ms; on a busy machine up to 100 ms), and kills it after `kill_after` (1 s). It
# stops the robot, too, while its own pings do not come back through the guard `deliver_within`
# (0.5 s). The guard stops a stream if the audit has not looked who speaks past it for
# `audit_within` (10 s). A start may take `start_within` (20 s).
""",
    "incidents": """
# What the guard keeps on disk: the last `keep` (60 s; 0 s: nothing). An intervention, a stop and an
# alarm save it as an incident, with the `after` (5 s) behind them. All of it takes `megabytes`
# (256) at most: the oldest incidents are removed. See `rtron incident`.
""",
    "messages": """
# Message types that RTron does not know, as `rosmsg show -r TYPE` prints them, or as their files in
# ROS 2 say.
""",
    "cell": """
# Nodes that run in a cell: a network of their own, into which only the guard leads.
""",
    "unguarded": """
# What moves the robot, too, and no coordination node guards.
""",
    "accept_unenforceable": """
# What cannot be guarded and was accepted.
""",
}
_ON_ONE_LINE = (Flow, LeaseGroup, StopButton, UnguardedPath, WatchedFlow, Point)
_ON_ONE_LINE_IF_SHORT = (EventFlow, MissionRule, Transform)
_SHORT = 100
_SAFE = re.compile(r"[A-Za-z/][A-Za-z0-9_/.-]*")
# What a block scalar gives back as it was: printable lines that begin and end with a mark.
_BLOCK = re.compile(r"[!-~](?:[\t\n -~]*[!-~])?\n?")


def write_plan(plan: Plan) -> str:
    """Return the plan as YAML with a comment for each section; what has its default is left out."""
    app = [f"app: {_scalar(plan.app)}"] if plan.app else []
    lines = [_HEADER.rstrip("\n"), f"schema: {PLAN_SCHEMA}", *app]
    return "\n".join([*lines, *_sections(plan)]) + "\n"


def _sections(plan: Plan) -> Iterator[str]:
    for key in _changed_fields(plan):
        if key.name in _SECTIONS:
            yield _SECTIONS[key.name].rstrip("\n")
        if key.name != "app":
            yield from _entry(key, getattr(plan, key.name), 0)


def _changed_fields(part: object) -> Iterator[PlanField]:
    """Yield the keys of a noun that differ from their defaults."""
    for key in plan_fields(type(part)).values():
        if key.name != "schema" and (
            key.default is MISSING or getattr(part, key.name) != key.default
        ):
            yield key


def _entry(key: PlanField, value: Any, indent: int) -> Iterator[str]:  # noqa: ANN401 - as the key says
    space = " " * indent
    if not value and key.is_list:
        yield f"{space}{key.name}: []"
    elif key.is_list and key.item_type in PLAN_TYPES:
        yield f"{space}{key.name}:"
        for part in value:
            yield from _item(part, indent + 2)
    elif key.item_type in PLAN_TYPES and not isinstance(value, _ON_ONE_LINE):
        yield f"{space}{key.name}:"
        yield from _mapping(value, indent + 2)
    elif _is_block(value):
        yield f"{space}{key.name}: |{_chomping(value)}"
        yield from (f"{space}  {line}" if line else "" for line in _lines(value))
    else:
        yield f"{space}{key.name}: {_value(key, value)}"


def _is_block(value: object) -> bool:
    return isinstance(value, str) and "\n" in value and _BLOCK.fullmatch(value) is not None


def _chomping(text: str) -> str:
    return "" if text.endswith("\n") else "-"


def _lines(text: str) -> list[str]:
    return text.removesuffix("\n").split("\n")


def _item(part: object, indent: int) -> Iterator[str]:
    space = " " * indent
    if isinstance(part, _ON_ONE_LINE) or _is_short(part, indent):
        yield f"{space}- {_inline(part)}"
        return
    first, *others = _mapping(part, indent + 2)
    yield f"{space}- {first.lstrip()}"
    yield from others


def _is_short(part: object, indent: int) -> bool:
    return isinstance(part, _ON_ONE_LINE_IF_SHORT) and len(_inline(part)) + indent + 2 <= _SHORT


def _inline(part: object) -> str:
    pairs = (f"{key.name}: {_value(key, getattr(part, key.name))}" for key in _changed_fields(part))
    return f"{{{', '.join(pairs)}}}"


def _mapping(part: object, indent: int) -> Iterator[str]:
    for key in _changed_fields(part):
        yield from _entry(key, getattr(part, key.name), indent)


def _value(key: PlanField, value: Any) -> str:  # noqa: ANN401 - as the key says
    if key.is_list:
        return f"[{', '.join(map(_scalar, value))}]"
    if isinstance(value, _ON_ONE_LINE):
        return _inline(value)
    if key.is_duration:
        return write_duration(value)
    if key.quantity:
        return key.quantity.write(value)
    return _scalar(value)


def _scalar(value: object) -> str:
    text = str(value.value) if isinstance(value, Enum) else value
    if isinstance(text, bool):
        return "true" if text else "false"
    if isinstance(text, int) or (_SAFE.fullmatch(str(text)) and _stays_text(str(text))):
        return str(text)
    return str(
        yaml.safe_dump(text, default_style='"', width=float("inf"), allow_unicode=True)
    ).strip()


def _stays_text(text: str) -> bool:
    return isinstance(yaml.safe_load(text), str)
