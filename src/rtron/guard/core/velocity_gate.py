"""What every velocity must be before a policy sees it, whatever the policies of the stream are."""

from collections.abc import Callable

from rtron.errors import WireError
from rtron.messages.common.velocity import VelocityCodec
from rtron.vocabulary import (
    TWIST_COMPONENTS,
    UNAPPROVED,
    Decision,
    Stream,
    StreamKind,
    Velocity,
    Verdict,
)


class VelocityGate:
    """Refuses commands that are no numbers, and sets to 0 what the base does not obey.

    Messages of other types pass, and so do those of strangers, whom the policies refuse.
    """

    def __init__(self, stream: Stream) -> None:
        first = stream.stages[0].settings
        self._has_commands = first.kind is StreamKind.COMMAND
        self._blocks_unapproved = stream.block_unapproved
        self._policy = first.policy
        self._revision = first.revision
        self._is_used = tuple(name in stream.uses for name in TWIST_COMPONENTS)
        self._has_unused = bool(stream.uses) and not all(self._is_used)
        self._unused = ", ".join(name for name in TWIST_COMPONENTS if name not in stream.uses)
        self._has_velocities = False
        self._codec: VelocityCodec | None = None
        self._check_numbers: Callable[[bytes], object] | None = None

    def learn(self, codec: VelocityCodec | None) -> None:
        """Take the codec of the stream's velocities; None if nobody can read them."""
        self._has_velocities, self._codec = self._has_commands, codec

    def learn_numbers(self, check: Callable[[bytes], object]) -> None:
        """Take what refuses (WireError) the stream's commands if they are no numbers."""
        self._check_numbers = check if self._has_commands else None

    def revise(self, revision: int) -> None:
        """Give verdicts with the settings' `revision` from now on."""
        self._revision = revision

    def verdict(self, flow: str, message: bytes) -> Verdict | None:
        """Return what becomes of a message instead of passing on as it is; None if it passes."""
        if flow == UNAPPROVED and self._blocks_unapproved:
            return None
        if self._check_numbers is not None:
            return self._number_verdict(flow, message, self._check_numbers)
        return self._velocity_verdict(flow, message) if self._has_velocities else None

    def _number_verdict(
        self, flow: str, message: bytes, check: Callable[[bytes], object]
    ) -> Verdict | None:
        try:
            check(message)
        except WireError as error:
            return self._refuse(flow, f"no command: {error}")
        return None

    def _velocity_verdict(self, flow: str, message: bytes) -> Verdict | None:
        if self._codec is None:
            return self._refuse(flow, "messages of this type hold no velocity that is known")
        try:
            is_finite = self._codec.is_finite(message)
        except WireError as error:
            return self._refuse(flow, f"no velocity: {error}")
        if not is_finite:
            return self._refuse(flow, "NaN or Inf is no velocity")
        return self._without_unused(flow, message, self._codec) if self._has_unused else None

    def _without_unused(self, flow: str, message: bytes, codec: VelocityCodec) -> Verdict | None:
        velocity = codec.decode(message)
        values = (*velocity.linear, *velocity.angular)
        if len(values) != len(self._is_used):
            return None
        used = tuple(v if use else 0.0 for v, use in zip(values, self._is_used, strict=True))
        if used == values:
            return None
        split = len(velocity.linear)
        changed = codec.encode(message, Velocity(used[:split], used[split:]))
        reason = f"the base does not use {self._unused}"
        return Verdict(Decision.MODIFY, flow, self._policy, reason, self._revision, changed)

    def _refuse(self, flow: str, reason: str) -> Verdict:
        return Verdict(Decision.DROP, flow, self._policy, reason, self._revision, error=True)
