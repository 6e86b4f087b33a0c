"""The tools that a model sees; what each returns is JSON, a refusal too."""

import time
from collections.abc import Awaitable, Callable, Iterable, Iterator
from dataclasses import asdict
from typing import Annotated, Any

from pydantic import Field

from rtron.bridge.agents.agent_commands import AgentCommands
from rtron.bridge.agents.app_client import AppClient
from rtron.bridge.agents.refusals import Answer, CallRefusals, CallRefusedError
from rtron.bridge.protocol.client_state import TokenBucket
from rtron.errors import RTronError
from rtron.reports.app.risks_json import risks_to_json
from rtron.vocabulary import (
    SECOND,
    Area,
    Flow,
    GuardedTopic,
    InteractionGraph,
    Plan,
    RiskReport,
    Stream,
    build_streams,
)

QUESTIONS_PER_SECOND = 10.0
_BURST = 20.0
Name = Annotated[str, Field(max_length=255)]
Words = Annotated[str, Field(max_length=500)]
Seconds = Annotated[float, Field(allow_inf_nan=False)]
Message = Annotated[dict[str, Any], Field(description="the message as JSON, by its fields")]

INSTRUCTIONS = """A robot behind RTron's guard. You are one of those who may command it, of the
lowest rank. Look with show_plan and who_is_in_command, ask with check_command whether something
would pass, take_command before you drive, give_back_command when you are done, and stop when
anything is not as you expect. What is refused comes with the rule, the value and the limit: stay
within the limit, do not try again as it was. Only a person may lift a limit, a stop or a rule."""


class AgentTools:
    """The tools of one agent."""

    def __init__(
        self, app: AppClient, graph: InteractionGraph | None, risks: RiskReport | None
    ) -> None:
        self._app = app
        self._graph = graph
        self._risks = risks
        self._commands = AgentCommands(app)
        self._refusals = CallRefusals()
        self._questions = TokenBucket(QUESTIONS_PER_SECOND, _BURST)

    async def show_plan(self) -> Answer:
        """List the guarded topics: who may publish them, under which policies, who is behind."""
        return await self._question("show_plan", lambda: show_plan(self._app.plan))

    async def show_graph(self, about: Name = "") -> Answer:
        """List the nodes of the app and their topics; `about` is one node or topic."""
        return await self._question("show_graph", lambda: self._show_graph(about))

    async def show_risks(self) -> Answer:
        """List what the nodes of the app can do to each other."""
        return await self._question("show_risks", self._show_risks)

    async def who_is_in_command(self) -> Answer:
        """Show who holds each lease, who controls each topic, and what has stopped the robot."""
        return await self._question("who_is_in_command", self._state)

    async def show_limits(self) -> Answer:
        """Show the limits and rules of the plan, and those that are in force now."""
        return await self._question("show_limits", self._limits)

    async def check_command(self, topic: Name, message: Message) -> Answer:
        """Ask whether the guard would let a velocity or goal pass now, and if you had the lease.

        Nothing is sent.
        """
        return await self._question("check_command", lambda: self._check(topic, message))

    async def why_refused(self, count: Annotated[int, Field(ge=1, le=50)] = 5) -> Answer:
        """List your last refused calls, and the guard's last verdict on each of your topics."""
        return await self._question("why_refused", lambda: self._reasons(count))

    async def take_command(self, lease: Name, why: Words, seconds: Seconds = 30.0) -> Answer:
        """Take a lease for some seconds (120 at most); you need it to drive."""
        return await self._command(
            "take_command", lambda: self._commands.take_command(lease, why, seconds)
        )

    async def give_back_command(self, lease: Name, why: Words = "") -> Answer:
        """Give a lease back; the robot stops."""
        return await self._command(
            "give_back_command", lambda: self._commands.give_back_command(lease, why)
        )

    async def drive(self, topic: Name, message: Message, seconds: Seconds) -> Answer:
        """Send a velocity for some seconds (10 at most), then stand still.

        Needs the lease. Refused, and nothing is sent, if the guard would not let it pass.
        """
        return await self._command("drive", lambda: self._commands.drive(topic, message, seconds))

    async def send_goal(self, topic: Name, message: Message, seconds: Seconds = 30.0) -> Answer:
        """Send a goal to a guarded action or goal topic; refused if the guard would refuse it.

        For an action of ROS 2 wait so many seconds for the result.
        """
        return await self._command(
            "send_goal", lambda: self._commands.send_goal(topic, message, seconds)
        )

    async def cancel_goal(self, topic: Name) -> Answer:
        """Cancel your goals at an action."""
        return await self._command("cancel_goal", lambda: self._commands.cancel_goal(topic))

    async def stop(self) -> Answer:
        """Stop driving at once and give all your leases back. Never refused."""
        return await self._command("stop", self._commands.stop)

    async def close(self) -> None:
        """Stop, and leave the bridge."""
        await self._commands.close()
        await self._app.close()

    @property
    def all(self) -> tuple[Callable[..., Awaitable[Answer]], ...]:
        """The tools."""
        questions = (self.show_plan, self.show_graph, self.show_risks, self.who_is_in_command)
        others = (self.show_limits, self.check_command, self.why_refused)
        commands = (self.take_command, self.give_back_command, self.drive, self.send_goal)
        return (*questions, *others, *commands, self.cancel_goal, self.stop)

    async def _question(self, tool: str, answer: Callable[[], Answer]) -> Answer:
        async def ask() -> Answer:
            if not self._questions.take(time.monotonic_ns()):
                reason = f"more than {QUESTIONS_PER_SECOND:g} questions a second"
                raise CallRefusedError("rate of calls", reason, None, QUESTIONS_PER_SECOND)
            return answer()

        return await self._command(tool, ask)

    async def _command(self, tool: str, act: Callable[[], Awaitable[Answer]]) -> Answer:
        """Return what a tool answers, a refusal as JSON."""
        try:
            await self._app.open()
            return await act()
        except CallRefusedError as refusal:
            answer = refusal.answer()
        except RTronError as error:
            answer = CallRefusedError("bridge", str(error), by="bridge").answer()
        self._refusals.note(tool, answer, time.time())
        return answer

    def _show_graph(self, about: str) -> Answer:
        if self._graph is None:
            raise CallRefusedError("graph", "no graph was given: --graph FILE")
        return show_graph(self._graph, about)

    def _show_risks(self) -> Answer:
        if self._risks is None:
            raise CallRefusedError("graph", "no graph was given: --graph FILE")
        return show_risks(self._risks)

    def _state(self) -> Answer:
        now, report = time.monotonic_ns(), self._app.report
        entries = report.entries(now)
        streams = {name: each.message for name, each in entries.items() if name.startswith("/")}
        stops = {n: e.message for n, e in entries.items() if n.startswith(("alarm", "emergency"))}
        return {
            "you": self._app.node,
            "guard_reports": report.is_known(now),
            "leases": {x.name: report.lease_status(x.name) for x in self._app.plan.leases},
            "topics": streams,
            "stops_and_alarms": stops,
        }

    def _limits(self) -> Answer:
        now, report = time.monotonic_ns(), self._app.report
        entries = report.entries(now)
        plan = self._app.plan
        rules = plan.msrcn.rules if plan.msrcn else ()
        return {
            **show_limits(plan),
            "now": {
                "guard_reports": report.is_known(now),
                "blocking_rules": [x.name for x in rules if report.rule_blocks(x.name, now)],
                "frames_a_second": {x.id: report.frame_rate(x.id, now) for x in plan.fps_monitor},
                "entries": {n: e.message for n, e in entries.items() if n.startswith("rule ")},
            },
        }

    def _check(self, topic: str, message: object) -> Answer:
        judgement = asdict(self._app.judge(topic, message))
        if not self._app.stream(topic).stages[0].settings.lease:
            return {"now": judgement}
        held = self._app.judge(topic, message, as_holder=True)
        return {"now": judgement, "if_you_had_the_lease": asdict(held)}

    def _reasons(self, count: int) -> Answer:
        topics = self._app.own_topics
        verdicts = {topic: self._app.last_verdict(topic) for topic in topics}
        return {"refused_calls": self._refusals.newest(count), "guard": verdicts}


Document = dict[str, Any]
MAX_LISTED = 200
"""So many nodes or risks are listed at once; ask for one to see it."""


def show_plan(plan: Plan) -> Document:
    """Return who may publish what, and which nodes are behind."""
    return {
        "app": plan.app,
        "ros": plan.ros,
        "guarded": [_stream(each) for each in build_streams(plan)],
        "leases": [{"name": each.name, "ttl_s": each.ttl / SECOND} for each in plan.leases],
    }


def show_limits(plan: Plan) -> Document:
    """Return what the plan limits and forbids, whatever the state of the moment is."""
    document: Document = {}
    if plan.rsrcn:
        names = ("threshold", "max_vel_limit", "max_turn_limit", "max_side_limit", "lowest")
        values = {name: getattr(plan.rsrcn, name) for name in (*names, "max_accel_limit")}
        known = {name: value for name, value in values.items() if value is not None}
        topics = _topics(plan.rsrcn.vflows)
        policy = str(plan.rsrcn.policy)
        document["velocity"] = {"id": plan.rsrcn.id, "policy": policy, "topics": topics, **known}
    if plan.msrcn:
        document["mission"] = {
            "id": plan.msrcn.id,
            "topics": _topics(plan.msrcn.aflows),
            "rules": [
                {
                    "name": each.name,
                    "blocks": list(each.block),
                    "when": each.when,
                    "only_messages": each.action or "all",
                    "reason": each.reason,
                }
                for each in plan.msrcn.rules
            ],
            "areas": [_area(each) for each in plan.msrcn.areas],
        }
    return document


def show_graph(graph: InteractionGraph, about: str) -> Document:
    """Return the nodes of an app with their topics; `about` names one node or topic, or none."""
    endpoints = [each for each in graph.endpoints if about in ("", each.node, each.topic)]
    nodes: dict[str, dict[str, list[str]]] = {}
    for each in endpoints:
        sides = nodes.setdefault(each.node, {})
        sides.setdefault(str(each.direction), []).append(f"{each.topic} ({each.type})")
    listed = dict(list(nodes.items())[:MAX_LISTED])
    return {"app": graph.app, "nodes": listed, "left_out": len(nodes) - len(listed)}


def show_risks(report: RiskReport) -> Document:
    """Return the risks of an app, without the places in its code."""
    risks = risks_to_json(report)["risks"]
    shown = [{key: each[key] for key in each if key != "evidence"} for each in risks[:MAX_LISTED]]
    return {"risks": shown, "left_out": len(risks) - len(shown)}


def _stream(stream: Stream) -> Document:
    return {
        "topic": stream.topic,
        "type": stream.type,
        "mode": str(stream.mode),
        "policies": [f"{each.settings.policy} ({each.id})" for each in stream.stages],
        "flows": [_flow(each) for each in stream.flows],
        "behind": list(stream.successors),
    }


def _flow(flow: Flow) -> Document:
    return {"publisher": flow.publisher, "priority": flow.priority, "rank": str(flow.rank)}


def _topics(guarded: Iterable[GuardedTopic]) -> list[str]:
    return [each.topic for each in guarded]


def _area(area: Area) -> Document:
    corners: Iterator[list[float]] = ([each.x, each.y] for each in area.polygon)
    return {"name": area.name, "frame": area.frame, "polygon": list(corners)}
