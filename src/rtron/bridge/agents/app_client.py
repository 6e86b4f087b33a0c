"""The running app as an agent's server knows it: plan, reports of the guard, and the bridge."""

import asyncio
import re
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from rtron.bridge.agents.bridge_link import BridgeLink, Frame
from rtron.bridge.agents.guard_report import GuardReport, read_lease_message
from rtron.bridge.agents.preview import GuardPreview, Judgement
from rtron.bridge.agents.refusals import CallRefusedError
from rtron.bridge.common.message_types import MessageTypes
from rtron.errors import SourceError, WireError
from rtron.messages import VELOCITY_TYPES
from rtron.vocabulary import (
    Mode,
    Plan,
    Ros1ActionTopic,
    Stream,
    build_streams,
    lease_topic,
    matches_node,
    normalise_type,
    ros1_topic_name,
)

DIAGNOSTICS = "/diagnostics"
_STRING = "std_msgs/String"
_COUNT = re.compile(r"(passed|held|dropped|modified) (\d+)")
_PAUSE_S = 0.02
_FIRST_REPORT_S = 2.5
_HUSHED_S = 1.1
"""So long after a refusal the bridge may refuse for the same reason without a word."""


class AppClient:
    """What one agent may see of an app and send to it."""

    def __init__(
        self, plan: Plan, node: str, types: MessageTypes, address: str, token: str
    ) -> None:
        self.plan = plan
        self.node = node
        self.report = GuardReport()
        self.readable: dict[str, str] = {}
        """The topics that the bridge lets this client use, with their types."""
        self._preview = GuardPreview(plan, node, types)
        self._streams = {
            each.topic: each for each in build_streams(plan) if each.mode is Mode.ENFORCE
        }
        self._link = BridgeLink(node, address, token, self._take)
        self._answers: dict[tuple[str, str], asyncio.Queue[Mapping[str, Any]]] = {}
        self._lease_topics = {lease_topic(each.name, "status"): each.name for each in plan.leases}
        self._answer_topics = {lease_topic(each.name, "answer"): each.name for each in plan.leases}
        self._neutral_grants: dict[str, float] = {}
        self._opening = asyncio.Lock()
        self._last_refusal = "", -_HUSHED_S

    async def open(self) -> None:
        """Sign in at the bridge, if that has not been done or the connection has ended."""
        async with self._opening:
            if self._link.is_open:
                return
            await self._link.open()
            found = await self._link.call("/rosapi/topics", {})
            self.readable = dict(zip(found["topics"], found["types"], strict=True))
            for topic in (DIAGNOSTICS, *self._lease_topics, *self._answer_topics):
                if topic in self.readable:
                    await self._link.subscribe(topic, self.readable[topic])
            for topic in self._published():
                await self._link.advertise(topic, self.readable[topic])
            await self._link.settle()
            await self.wait_for_report(_FIRST_REPORT_S)

    async def close(self) -> None:
        """Leave the bridge."""
        await self._link.close()

    def stream(self, topic: str) -> Stream:
        """Return a guarded topic with a flow of this agent; CallRefusedError if it has none."""
        stream = self._streams.get(topic)
        if stream is None:
            known = sorted(self._streams)
            raise CallRefusedError("plan", f"the plan does not guard {topic[:80]}", None, known)
        if not any(matches_node(flow.publisher, self.node) for flow in stream.flows):
            reason = f"the plan guards {topic} and has no flow of {self.node}"
            raise CallRefusedError("plan", reason, self.node, [f.publisher for f in stream.flows])
        return stream

    @property
    def own_topics(self) -> list[str]:
        """The guarded topics on which this agent has a flow."""
        named = ((each, flow.publisher) for each in self._streams.values() for flow in each.flows)
        return [each.topic for each, publisher in named if matches_node(publisher, self.node)]

    def is_velocity(self, stream: Stream) -> bool:
        """Tell whether a stream is one of velocities."""
        return normalise_type(stream.type) in VELOCITY_TYPES

    def judge(self, topic: str, message: object, *, as_holder: bool = False) -> Judgement:
        """Return what the guard would do with a message; CallRefusedError if it is none."""
        now = time.monotonic_ns()
        if not self.report.is_known(now):
            reason = "the guard has not reported for 3 s: nothing is known of its state"
            raise CallRefusedError("guard", reason)
        self.stream(topic)
        try:
            return self._preview.judge(topic, message, self.report, now, as_holder=as_holder)
        except CallRefusedError:
            raise
        except WireError as error:
            raise CallRefusedError("message", str(error)) from None

    def needs_neutral(self, lease: str) -> bool:
        """Tell whether nothing neutral was sent under this grant of a lease; it is from now on."""
        since = self.report.grant_began(lease)
        was_sent = self._neutral_grants.get(lease) == since
        self._neutral_grants[lease] = since
        return not was_sent

    def counts(self, topic: str) -> dict[str, int]:
        """Return how many messages of this agent the guard has passed, held, dropped, modified."""
        entry = self.report.stream(topic, time.monotonic_ns())
        flow = self._flow(topic)
        text = entry.values.get(flow, "") if entry else ""
        return {what: int(number) for what, number in _COUNT.findall(text)}

    def last_verdict(self, topic: str) -> str:
        """Return the guard's last verdict on this agent's messages, as it reports it."""
        entry = self.report.stream(topic, time.monotonic_ns())
        return entry.values.get(self._flow(topic), "") if entry else ""

    async def publish(self, stream: Stream, message: object) -> None:
        """Publish a message of a guarded topic."""
        await self._link.publish(stream.topic, stream.type, message)

    async def send(self, stream: Stream, goal: object, seconds: float) -> Frame:
        """Send a goal; of an action of ROS 2, wait some seconds for its result."""
        self.check_hushed()
        if not stream.is_ros2_action:
            await self.publish(stream, goal)
            await self.settle()
            return {}
        try:
            answer = await self._link.send_goal(stream.topic, stream.type, goal, seconds)
        except SourceError:
            return {"result": None, "reason": f"not done after {seconds:g} s"}
        if answer.get("result") is not True:
            raise CallRefusedError("action", str(answer.get("values")), by="guard or server")
        return {"result": answer.get("values")}

    async def cancel(self, stream: Stream) -> None:
        """Cancel the goals of this agent."""
        if not stream.action:
            raise CallRefusedError("tool", f"{stream.topic} is no action")
        if stream.is_ros2_action:
            await self._link.cancel_goals(stream.topic)
        else:
            topic = ros1_topic_name(stream.action, Ros1ActionTopic.CANCEL)
            await self._link.publish(topic, "actionlib_msgs/GoalID", {})
        await self.settle()

    def check_hushed(self) -> None:
        """Refuse to send while the bridge says only once a second why it refuses."""
        reason, at = self._last_refusal
        if time.monotonic() - at < _HUSHED_S:
            why = f"a moment ago the bridge has refused: {reason}"
            raise CallRefusedError("rights", why, by="bridge")

    async def settle(self) -> None:
        """Wait until the bridge has seen all that was sent; CallRefusedError if it refuses any."""
        try:
            await self._link.settle()
        except WireError as error:
            self._last_refusal = str(error), time.monotonic()
            raise CallRefusedError("rights", str(error), by="bridge") from None

    async def request_lease(self, lease: str, request: Mapping[str, str]) -> None:
        """Ask the guard for something about a lease."""
        await self._link.publish(lease_topic(lease, "request"), _STRING, request)
        await self.settle()

    @contextmanager
    def lease_answers(self, lease: str, word: str) -> "Iterator[asyncio.Queue[Mapping[str, Any]]]":
        """Collect the guard's answers to this agent's requests of a word."""
        queue = self._answers[lease, word] = asyncio.Queue()
        try:
            yield queue
        finally:
            del self._answers[lease, word]

    async def wait_for_report(self, patience_s: float, topic: str = "") -> bool:
        """Wait until the guard has reported once more, of a topic; False if it has not."""
        began, deadline = time.monotonic_ns(), time.monotonic() + patience_s
        while self.report.reported_at(topic) <= began:
            if time.monotonic() > deadline:
                return False
            await asyncio.sleep(_PAUSE_S)
        return True

    def _flow(self, topic: str) -> str:
        flows = self.stream(topic).flows
        return next(each.name for each in flows if matches_node(each.publisher, self.node))

    def _published(self) -> Iterator[str]:
        """Yield what this agent publishes: so that the guard knows it before it speaks."""
        own = (each for each in self._streams.values() if not each.is_ros2_action)
        topics = [each.topic for each in own]
        requests = [lease_topic(each.name, "request") for each in self.plan.leases]
        yield from (each for each in (*topics, *requests) if each in self.readable)

    def _take(self, topic: str, message: Frame) -> None:
        if topic == DIAGNOSTICS:
            self.report.take_diagnostics(message, time.monotonic_ns())
        elif topic in self._lease_topics:
            self.report.take_lease(self._lease_topics[topic], read_lease_message(message))
        elif topic in self._answer_topics:
            answer = read_lease_message(message)
            queue = self._answers.get((self._answer_topics[topic], str(answer.get("request"))))
            if queue and answer.get("to") == self.node:
                queue.put_nowait(answer)
