"""Whose turn it is among commands that wait for higher ones to fall silent."""

from collections.abc import Mapping

from rtron.policies.active_flows import Speaker, Speakers
from rtron.policies.state_transfer import Carried, InTurn
from rtron.policies.verdicts import goes_next, has_output, with_priority
from rtron.vocabulary import Flow, PolicySettings


class MaskingTurn:
    """A flow that has spoken masks all lower ones until it is silent for its `timeout`.

    `release_after` stands in for a timeout that is not set. A command that goes counts as spoken
    at that moment: what the robot does just now is not overridden at once by a lower flow.
    """

    __slots__ = ("_highest", "_owner", "_speakers")

    def __init__(self, settings: PolicySettings) -> None:
        default = settings.release_after
        self._speakers = Speakers(
            settings.flows,
            lambda flow: default if flow.timeout is None else flow.timeout,
        )
        self._highest: Speaker | None = None
        self._owner: Speaker | None = None

    @property
    def owner(self) -> Flow | None:
        """The flow whose command went last, while it is fresh."""
        return self._owner.flow if self._owner else None

    def hear(self, flow: Flow, now: int) -> None:
        """Let `flow` mask the lower ones from now on."""
        self._speakers.hear(self._speakers.named[flow.name], now)
        self._highest = self._speakers.highest(now)

    def why_wait(self, flow: Flow, first: Flow | None) -> str:
        """Let a message go if no higher flow is fresh and none of a higher flow waits."""
        highest = self._highest
        if highest and highest.flow.priority > flow.priority:
            reason = has_output if highest is self._owner else goes_next
            return with_priority(highest.flow, reason(highest.flow))
        if first and first.priority > flow.priority:
            return with_priority(first, goes_next(first))
        return ""

    def take(self, flow: Flow, now: int) -> None:
        """Give the turn to `flow`, or renew it."""
        self.hear(flow, now)
        self._owner = self._speakers.named[flow.name]

    def lapse(self, now: int) -> None:
        """Forget who fell silent."""
        self._highest = self._speakers.highest(now)
        if self._owner and now >= self._owner.lapses:
            self._owner = None

    def end(self, now: int) -> None:
        """Take the owner for silent."""
        if self._owner:
            self._owner.lapses = now

    def ends(self) -> int | None:
        """Return when the owner falls silent, or a flow that masks although its message is gone."""
        speaker = self._owner or self._highest
        return speaker.lapses if speaker else None

    def in_turn(self) -> InTurn | None:
        """Return whose turn it is; of a command, only when it went last matters."""
        owner = self._owner
        if owner is None:
            return None
        spoke = owner.lapses - owner.limit
        return InTurn(owner.flow.name, spoke, spoke)

    def spoke(self, now: int) -> Mapping[str, int]:
        """Return when each fresh flow spoke last."""
        return self._speakers.spoke(now)

    def resume(self, owner: Flow | None, carried: Carried) -> None:
        """Know who spoke when; the owner stays the one whose command went last."""
        self._speakers.resume(carried.spoke)
        if owner and owner.name in carried.spoke:
            self._owner = self._speakers.named[owner.name]
