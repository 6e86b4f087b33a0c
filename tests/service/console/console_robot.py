"""A robot for the console: AutoRace under a plan, and what its guard would tell about it."""

import json
import math
import time
from dataclasses import replace

from app_graphs import AUTORACE, HOME

from rtron.planning import propose_plan
from rtron.risks import discover_risks
from rtron.sources.graph_json import graph_to_json
from rtron.vocabulary import (
    Alarm,
    AlarmKind,
    Decision,
    EventKind,
    GuardEvent,
    GuardEventLevel,
    GuardState,
    MissionRule,
    Mode,
    PolicyName,
    RuleState,
    StreamState,
    VerdictCounts,
)

SECOND = 1_000_000_000
REPORT = discover_risks(AUTORACE)
RULES = (
    MissionRule(
        name="stop_at_red",
        when="eflow12",
        block=("/cmd_vel",),
        reason="the light is red",
        mandatory=True,
    ),
    MissionRule(
        name="no_goal_in_tunnel",
        when="eflow15 && !eflow6",
        block=("aflow6", "aflow7"),
        reason="goals while in the tunnel are the tunnel's own",
    ),
    MissionRule(
        name="wait_for_bar", when="eflow8", block=("aflow1", "aflow2"), reason="the bar is down"
    ),
)


def plan(app="autorace"):
    """Return AutoRace's plan with limits and rules of the mission."""
    found = propose_plan(AUTORACE, REPORT)
    rsrcn = replace(
        found.rsrcn, policy=PolicyName.SAFE_CONSTRAIN, threshold=0.012, max_vel_limit=0.22
    )
    msrcn = replace(found.msrcn, rules=RULES)
    return replace(found, app=app, rsrcn=rsrcn, msrcn=msrcn)


def large_graph():
    """Return two apps on one robot, 44 nodes that speak and 224 topics, as `rtron.graph/1`."""
    graph, other = graph_to_json(AUTORACE), graph_to_json(HOME)
    for node in other["nodes"]:
        node["name"] = f"/home{node['name']}"
    for topic in other["topics"]:
        topic["name"] = f"/home{topic['name']}"
    for end in other["endpoints"]:
        end["node"], end["topic"] = f"/home{end['node']}", f"/home{end['topic']}"
    parts = {name: [*graph[name], *other[name]] for name in ("nodes", "topics", "endpoints")}
    return json.dumps({**graph, **parts}).encode()


class GuardModel:
    """What a guard would tell: counters that go up, owners that change, an attack when asked."""

    def __init__(self, plan):
        self.plan, self.run = plan, "run1"
        self.number, self.revision = 0, 0
        self.intruder = "/rviz_intruder"
        self.limit = 0.22
        self.attack, self.stopped, self.overridden = False, False, ()
        self.counts, self.owners, self.began = {}, {}, time.monotonic()

    def event(self, kind, **more):
        """Return the guard's next event."""
        self.number += 1
        return GuardEvent(run=self.run, number=self.number, at=time.time_ns(), kind=kind, **more)

    def events_between(self, before, after):
        """Return what the guard tells of the time between two states: counts, and new owners."""
        old = {stream.topic: stream for stream in before.streams}
        for stream in after.streams:
            if stream.owner != old[stream.topic].owner:
                yield self._owner_event(stream)
        streams = {s.topic: _counts(old[s.topic], s) for s in after.streams}
        yield self.event(EventKind.COUNTS, values={"streams": streams, "fps": dict(after.fps)})

    def _owner_event(self, stream):
        return self.event(
            EventKind.OWNER,
            node=stream.nodes[0],
            topic=stream.topic,
            flow=stream.owner,
            publisher=stream.publisher,
            reason="" if stream.owner else "idle",
        )

    def attack_events(self):
        """Return what the guard tells when a stranger speaks on /cmd_vel."""
        self.attack = True
        return (
            self.event(
                EventKind.VERDICT,
                level=GuardEventLevel.WARNING,
                node="grcn_cmd_vel",
                topic="/cmd_vel",
                flow="unapproved",
                publisher="/rviz_intruder",
                policy=PolicyName.PREEMPTION,
                decision=Decision.DROP,
                reason="/rviz_intruder is not in the plan: what it says on /cmd_vel is dropped",
            ),
            self.event(
                EventKind.ALARM,
                level=GuardEventLevel.ERROR,
                topic="/cmd_vel",
                publisher="/rviz_intruder",
                reason="/rviz_intruder publishes /cmd_vel, which the plan does not know",
            ),
        )

    def state(self, seconds=None):
        """Return the state `seconds` after the beginning, and what changed owners by then."""
        at = time.monotonic() - self.began if seconds is None else seconds
        streams = tuple(self._stream(node, at) for node in self.plan.grcn)
        return GuardState(
            at=time.time_ns(),
            revision=self.revision,
            streams=streams,
            rules=self._rules(at),
            bits=self._bits(at),
            fps={m.id: 24 + 4 * math.sin(at / 5 + n) for n, m in enumerate(self.plan.fps_monitor)},
            alarms=self._alarms(),
            overridden=self.overridden,
            stopped=self.stopped,
        )

    def _stream(self, node, at):
        moving = node.topic in ("/cmd_vel", "/control/max_vel") and not self.stopped
        owner = self._owner(node, at) if node.mode is Mode.ENFORCE else None
        tallies = {f.name: self._tally(node, f, f is owner) for f in node.flows}
        speed = min(0.16 + 0.05 * math.sin(at / 3), self.limit) if moving and owner else None
        stopping = "emergency stop" if self.stopped and node.topic == "/cmd_vel" else ""
        return StreamState(
            topic=node.topic,
            nodes=(node.id, *_other_nodes(self.plan, node.topic)),
            mode=node.mode,
            owner="" if self.stopped or not owner else owner.name,
            publisher="" if self.stopped or not owner else owner.publisher,
            stopping=stopping,
            flows=tallies,
            strangers={self.intruder: 40} if self.attack and node.topic == "/cmd_vel" else {},
            speed=speed,
            limit=self.limit if node.topic in ("/cmd_vel", "/control/max_vel") else None,
            latency=(62 + 9 * math.sin(at), 180 + 60 * abs(math.sin(at / 2))),
        )

    def _owner(self, node, at):
        if not node.flows or "finished" in node.topic:
            return None
        return node.flows[int(at / 20) % min(len(node.flows), 2)]

    def _tally(self, node, flow, owns):
        key = (node.id, flow.name)
        passed, dropped = self.counts.get(key, (0, 0))
        step = 10 if node.mode is Mode.ENFORCE else 25
        passed, dropped = (
            (passed + step, dropped)
            if owns or node.mode is Mode.OBSERVE
            else (passed, dropped + step // 2)
        )
        self.counts[key] = passed, dropped
        return VerdictCounts(passed=passed, dropped=dropped, modified=passed // 9)

    def _rules(self, at):
        rules = self.plan.msrcn.rules if self.plan.msrcn else ()
        red = math.sin(at / 8) > 0.5
        states = {"stop_at_red": (red, "eflow12 is 1" if red else "")}
        return tuple(
            RuleState(
                name=r.name,
                blocks=states.get(r.name, (False, ""))[0],
                reason=states.get(r.name, (False, ""))[1],
            )
            for r in rules
        )

    def _bits(self, at):
        flows = self.plan.msrcn.eflows if self.plan.msrcn else ()
        bits = {f.name: math.sin(at / 4 + n) > 0 for n, f in enumerate(flows)}
        return bits | {f.name: None for f in flows[10:12]}

    def _alarms(self):
        if not self.attack:
            return ()
        return (
            Alarm(
                kind=AlarmKind.FOREIGN_PUBLISHER,
                reason=f"{self.intruder} publishes /cmd_vel, which the plan does not know",
                topic="/cmd_vel",
                node="/rtron",
                peer=self.intruder,
            ),
        )


def _counts(before, after):
    flows = {name: _differences(before.flows[name], tally) for name, tally in after.flows.items()}
    return {
        "flows": flows,
        "speed": after.speed,
        "limit": after.limit,
        "latency": list(after.latency),
    }


def _differences(before, after):
    names = ("passed", "held", "dropped", "modified")
    return [getattr(after, name) - getattr(before, name) for name in names]


def _other_nodes(plan, topic):
    """Return the MSRCN and the RSRCN, as far as they guard a topic too."""
    parts = [(plan.msrcn, plan.msrcn.aflows)] if plan.msrcn else []
    parts += [(plan.rsrcn, plan.rsrcn.vflows)] if plan.rsrcn else []
    return tuple(node.id for node, topics in parts if topic in [t.topic for t in topics])
