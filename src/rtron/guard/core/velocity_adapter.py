"""A policy about velocities, asked about messages: decoded once, and encoded again if changed."""

from collections.abc import Sequence
from dataclasses import replace

from rtron.errors import WireError
from rtron.messages.common.velocity import VelocityCodec
from rtron.policies.policy import Immediate, Release
from rtron.policies.state_transfer import Asked, Carried
from rtron.policies.velocity_limit.limiter import Limiting
from rtron.vocabulary import Decision, Velocity, Verdict


class Decoding(Immediate):
    """Stands before a policy that limits velocities; what it cannot read is no velocity.

    Until `learn` has told the type of the messages, nothing can be read, and nothing passes.
    """

    __slots__ = ("_codec", "_last", "_policy")

    def __init__(self, policy: Limiting) -> None:
        self._policy = policy
        self._codec: VelocityCodec | None = None
        self._last = b""

    def learn(self, codec: VelocityCodec) -> None:
        """Take how the topic's messages are laid out."""
        self._codec = codec
        self._policy.reissues = codec.is_limit

    def limit(self, now: int) -> float:
        """Return the speed (m/s) that the policy allows now."""
        return self._policy.limit(now)

    def verdict(self, flow: str, message: object, now: int) -> Verdict:
        """Ask the policy about the velocity in `message`."""
        data: bytes = message  # type: ignore[assignment]
        verdict = self._policy.verdict(flow, self._read(data), now)
        if verdict.decision is Decision.DROP:
            return verdict
        self._last = data
        return verdict if verdict.decision is Decision.PASS else self._changed(verdict)

    def refusal(self, flow: str, now: int, message: object = None) -> Verdict | None:
        """Return the policy's refusal, which does not depend on the message."""
        return self._policy.refusal(flow, now, message)

    def tick(self, now: int) -> Sequence[Release]:
        """Return what goes out again, as messages."""
        made = ((self._changed(each.verdict), each.restores) for each in self._policy.tick(now))
        return [Release(verdict.message, verdict, restores) for verdict, restores in made]

    def again(self, now: int) -> None:
        """Let the policy look again at what was asked for last."""
        self._policy.again(now)

    def carry(self, now: int) -> Carried:
        """Return the policy's state, with the message that was asked for last."""
        carried = self._policy.carry(now)
        asked = replace(carried.asked, message=self._last) if carried.asked else None
        return replace(carried, asked=asked)

    def resume(self, carried: Carried, now: int) -> Sequence[Release]:
        """Let the policy go on; what no policy has limited before may be above the limit now."""
        asked = carried.asked or self._asked(carried.last)
        self._last = asked.message if asked else b""
        return self._policy.resume(replace(carried, asked=asked), now)

    def revise(self, revision: int) -> None:
        """Tell the policy."""
        self._policy.revise(revision)

    def deadline(self) -> int | None:
        """Return when the policy wants to be asked again."""
        return self._policy.deadline()

    @property
    def owner(self) -> str | None:
        """The policy's owner."""
        return self._policy.owner

    def _asked(self, last: tuple[str, bytes] | None) -> Asked | None:
        velocity = self._read(last[1]) if last else None
        if last is None or not isinstance(velocity, Velocity) or not velocity.finite:
            return None
        return Asked(last[0], velocity, velocity, last[1])

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

    def _changed(self, verdict: Verdict) -> Verdict:
        if self._codec is None or not isinstance(verdict.message, Velocity):
            raise AssertionError("only a velocity that was decoded is changed")
        made = self._codec.encode(self._last, verdict.message)
        return Verdict(
            verdict.decision, verdict.flow, verdict.policy, verdict.reason, verdict.revision, made
        )
