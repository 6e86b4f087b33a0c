"""Applies a velocity policy to messages: decodes each once, encodes it again if changed."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from rtron.errors import WireError
from rtron.messages.common.velocity import VelocityCodec
from rtron.policies.policy import ImmediatePolicy, Release
from rtron.policies.state_transfer import PolicyState, VelocityRequest
from rtron.policies.velocity_limit.limiter import VelocityLimiter
from rtron.vocabulary import Decision, Velocity, Verdict


class VelocityAdapter(ImmediatePolicy):
    """Wraps a policy that limits velocities.

    Before `learn` gives the codec, no message can be read, and none passes.
    """

    __slots__ = ("_codec", "_last_message", "_policy")

    def __init__(self, policy: VelocityLimiter) -> None:
        self._policy = policy
        self._codec: VelocityCodec | None = None
        self._last_message = b""

    def learn(self, codec: VelocityCodec) -> None:
        """Take the codec of the topic's messages."""
        self._codec = codec
        self._policy.reissues = codec.is_limit

    def limit(self, now: int) -> float:
        """Return the speed (m/s) that the policy allows now."""
        return self._policy.limit(now)

    def bounded(self, velocity: Velocity, now: int) -> Velocity:
        """Return what of a velocity in force the policy allows now."""
        return self._policy.bounded(velocity, now)

    def note_sent(self, velocity: Velocity, now: int) -> None:
        """Tell the policy what the guard itself has sent."""
        self._policy.note_sent(velocity, now)

    def verdict(self, flow: str, message: object, now: int) -> Verdict:
        """Ask the policy about the velocity in `message`."""
        data: bytes = message  # type: ignore[assignment]
        verdict = self._policy.verdict(flow, self._read(data), now)
        if verdict.decision is Decision.DROP:
            return verdict
        self._last_message = data
        return verdict if verdict.decision is Decision.PASS else self._with_velocity(verdict)

    def refusal(self, flow: str, now: int, message: object = None) -> Verdict | None:
        """Return the policy's refusal, which does not depend on the message."""
        return self._policy.refusal(flow, now, message)

    def forget_flow(self, flow: str, now: int) -> None:
        """Tell the policy."""
        self._policy.forget_flow(flow, now)

    def tick(self, now: int) -> Sequence[Release]:
        """Return the messages that go out again."""
        encoded = (
            (self._with_velocity(each.verdict), each.restores) for each in self._policy.tick(now)
        )
        return [Release(verdict.message, verdict, restores) for verdict, restores in encoded]

    def reevaluate(self, now: int) -> None:
        """Let the policy evaluate the last request again."""
        self._policy.reevaluate(now)

    def last_message_times(self, now: int) -> Mapping[str, int]:
        """Return the policy's."""
        return self._policy.last_message_times(now)

    def export_state(self, now: int) -> PolicyState:
        """Return the policy's state, with the message that was asked for last."""
        carried = self._policy.export_state(now)
        request = (
            replace(carried.velocity_request, message=self._last_message)
            if carried.velocity_request
            else None
        )
        return replace(carried, velocity_request=request)

    def restore_state(self, state: PolicyState, now: int) -> Sequence[Release]:
        """Let the policy go on; what no policy has limited before may be above the limit now."""
        request = state.velocity_request or self._request_from(state.last_output)
        self._last_message = request.message if request else b""
        return self._policy.restore_state(replace(state, velocity_request=request), now)

    def revise(self, revision: int) -> None:
        """Tell the policy."""
        self._policy.revise(revision)

    def deadline(self) -> int | None:
        """Return when (ns) the policy must tick again."""
        return self._policy.deadline()

    @property
    def owner(self) -> str | None:
        """The policy's owner."""
        return self._policy.owner

    def _request_from(self, last: tuple[str, bytes] | None) -> VelocityRequest | None:
        velocity = self._read(last[1]) if last else None
        if last is None or not isinstance(velocity, Velocity) or not velocity.is_finite:
            return None
        return VelocityRequest(last[0], velocity, velocity, last[1])

    def _read(self, message: bytes) -> Velocity | str:
        codec = self._codec
        if codec is None:
            return "messages of this type hold no velocity that is known"
        try:
            velocity = codec.decode(message)
        except WireError as error:
            return f"no velocity: {error}"
        if codec.is_limit and velocity.linear[0] < 0:
            return "a maximal velocity is not negative"
        return velocity

    def _with_velocity(self, verdict: Verdict) -> Verdict:
        if self._codec is None or not isinstance(verdict.message, Velocity):
            raise AssertionError("only a velocity that was decoded is changed")
        message = self._codec.encode(self._last_message, verdict.message)
        return Verdict(
            verdict.decision,
            verdict.flow,
            verdict.policy,
            verdict.reason,
            verdict.revision,
            message,
        )
