"""The lease of a group of streams: at most one commander at a time may move what they move.

No I/O and no clock: `now` is a time in ns of one steady clock that never goes back. A commander is
a publisher of the plan with a rank; nobody else is ever granted anything. The lease ends by itself
`ttl` after it was granted or renewed last. Each answer says why, and who holds the lease.

A lease changes hands with both sides' consent (`offer`, then `accept`), or by rank (`take_over`).
A person who commands nothing gives it to a commander (`give`), and ends it.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace

from rtron.policies.verdicts import format_seconds
from rtron.vocabulary import CommanderRank

_RANKS = tuple(CommanderRank)


@dataclass(frozen=True, slots=True)
class Commander:
    """Who may hold a lease: a publisher's node name as the plan has it, and the rank."""

    name: str
    rank: CommanderRank

    def outranks(self, other: "Commander") -> bool:
        """Tell whether this commander may take a lease from the other."""
        return _is_above(self.rank, other.rank)

    def __str__(self) -> str:
        return f"{self.name} ({self.rank})"


@dataclass(frozen=True, slots=True)
class Person:
    """Who says who is in command and is no commander; without a rank, above all ranks."""

    name: str
    rank: CommanderRank | None

    def may_give_to(self, commander: Commander) -> bool:
        """Tell whether a commander is not above the person."""
        return self.rank is None or not _is_above(commander.rank, self.rank)

    def may_end(self, grant: "Grant") -> bool:
        """Tell whether the person has given the grant, or is above who holds it."""
        if self.rank is None or self == grant.given_by:
            return True
        return _is_above(self.rank, grant.holder.rank)

    def __str__(self) -> str:
        return f"{self.name} ({self.rank})" if self.rank else self.name


@dataclass(slots=True, eq=False)
class Grant:
    """One commander's time with the lease; who gets it again gets another grant.

    It holds before `expires_at` (ns). When it ends early, `expires_at` is moved to that moment, so
    whoever has a grant needs one comparison to know whether it holds. `given_by` is the person who
    has given it, None if the holder has asked for it.
    """

    holder: Commander
    number: int
    since: int
    expires_at: int
    reason: str
    given_by: Person | None = None

    def holds(self, now: int) -> bool:
        """Tell whether the grant has not ended at `now`."""
        return now < self.expires_at

    def end(self, now: int) -> None:
        """End the grant at `now`, if it has not ended before."""
        self.expires_at = min(self.expires_at, now)


@dataclass(frozen=True, slots=True, kw_only=True)
class LeaseAnswer:
    """Whether a request was granted, and why."""

    granted: bool
    reason: str


class CommandLease:
    """Who may move what the streams of one group move; at first nobody."""

    __slots__ = (
        "_commanders",
        "_last_holder",
        "_number",
        "_offered_to",
        "_offered_until",
        "latest_grant",
        "name",
        "service",
        "ttl",
    )

    def __init__(
        self,
        name: str,
        commanders: Iterable[Commander],
        ttl: int,
        service: CommanderRank | None = None,
    ) -> None:
        """`ttl` (ns) is how long a grant holds that is not renewed, and an offer.

        `service` is the rank of persons at the security service, None if they only look.
        """
        self.name = name
        self.service = service
        self.ttl = ttl
        self.latest_grant: Grant | None = None
        """The last grant; None once it has been seen that it has ended."""
        self._commanders = {each.name: each for each in commanders}
        self._number = 0
        self._last_holder: Commander | None = None
        self._offered_to = ""
        self._offered_until = 0

    @property
    def commander_names(self) -> tuple[str, ...]:
        """The names of all who may hold the lease."""
        return tuple(self._commanders)

    def grant(self, now: int) -> Grant | None:
        """Return the grant that holds at `now`, None if nobody may move anything."""
        if self.latest_grant is not None and not self.latest_grant.holds(now):
            self.latest_grant = None
        return self.latest_grant

    def deadline(self, now: int) -> int | None:
        """Return when (ns) the grant that holds at `now` ends unless it is renewed."""
        grant = self.grant(now)
        return grant.expires_at if grant else None

    def acquire(self, who: str, now: int, why: str = "") -> LeaseAnswer:
        """Grant the lease if nobody holds it; the holder's own request renews it."""
        commander, grant = self._commanders.get(who), self.grant(now)
        if commander is None:
            return self._refuse_stranger(who)
        if grant is None:
            return self._grant_to(commander, now, _with_reason("acquired", why))
        if grant.holder == commander:
            return self.renew(who, now)
        hint = "take it over" if commander.outranks(grant.holder) else "ask for it to be offered"
        return _refused(f"{self._held(grant, now)}: {hint}")

    def renew(self, who: str, now: int) -> LeaseAnswer:
        """Let the holder's grant begin its time anew; one that has ended is not renewed."""
        grant = self._grant_of(who, now)
        if grant is None:
            return self._refuse_other(who, now)
        grant.expires_at = now + self.ttl
        return _granted(f"{self.name} is renewed for {format_seconds(self.ttl)}")

    def release(self, who: str, now: int, why: str = "") -> LeaseAnswer:
        """End the holder's grant: nobody holds the lease then."""
        grant = self._grant_of(who, now)
        if grant is None:
            return self._refuse_other(who, now)
        grant.end(now)
        return _granted(_with_reason(f"{self.name} is released by {grant.holder}", why))

    def offer(self, who: str, to: str, now: int) -> LeaseAnswer:
        """Let the holder offer the lease to another commander, in place of an offer before."""
        grant, other = self._grant_of(who, now), self._commanders.get(to)
        if grant is None:
            return self._refuse_other(who, now)
        if other is None or other == grant.holder:
            return _refused(f"{to or 'nobody'} is no other commander of {self.name}")
        self._offered_to, self._offered_until = to, now + self.ttl
        how_long = format_seconds(self.ttl)
        return _granted(f"{self.name} is offered to {other} for {how_long}")

    def accept(self, who: str, now: int) -> LeaseAnswer:
        """Let the commander have the lease whom its holder has offered it to."""
        commander, grant = self._commanders.get(who), self.grant(now)
        if commander is None:
            return self._refuse_stranger(who)
        if grant is None or who != self._offered_to or now >= self._offered_until:
            return _refused(f"nobody offers {self.name} to {commander}; {self.status(now)}")
        reason = f"handed over by {grant.holder}"
        grant.end(now)
        return self._grant_to(commander, now, reason)

    def take_over(self, who: str, now: int, why: str = "") -> LeaseAnswer:
        """Let a commander of higher rank than the holder have the lease."""
        commander, grant = self._commanders.get(who), self.grant(now)
        if commander is None:
            return self._refuse_stranger(who)
        if grant is None or grant.holder == commander:
            return self.acquire(who, now, why)
        if not commander.outranks(grant.holder):
            return self._refuse_lower(commander, grant, now)
        grant.end(now)
        reason = _with_reason(f"taken over from {grant.holder}", why)
        return self._grant_to(commander, now, reason)

    def give(self, to: str, by: Person, now: int, why: str) -> LeaseAnswer:
        """Grant the lease to a commander, whoever holds it, as far as the person's rank goes."""
        commander, grant = self._commanders.get(to), self.grant(now)
        if commander is None:
            return self._refuse_stranger(to)
        if not by.may_give_to(commander):
            return _refused(f"{commander} has a higher rank than {by}")
        if grant is not None:
            if not by.may_end(grant):
                return self._refuse_lower(by, grant, now)
            grant.end(now)
        return self._grant_to(commander, now, _with_reason(f"given by {by}", why), by)

    def renew_given(self, by: Person, now: int) -> LeaseAnswer:
        """Let a grant begin its time anew for the person who has given it."""
        grant = self.grant(now)
        if grant is None or grant.given_by != by:
            return _refused(f"{by} has not given {self.name}: {self.status(now)}")
        return self.renew(grant.holder.name, now)

    def end(self, by: Person, now: int, why: str) -> LeaseAnswer:
        """End the grant, whoever has it, as far as the person's rank goes."""
        grant = self.grant(now)
        if grant is None:
            return _refused(self.status(now))
        if not by.may_end(grant):
            return self._refuse_lower(by, grant, now)
        grant.end(now)
        return _granted(_with_reason(f"{self.name} is taken from {grant.holder} by {by}", why))

    def require_neutral(self, now: int) -> None:
        """Let the holder go on, but only after a neutral command on each stream."""
        grant = self.grant(now)
        if grant is not None:
            self._number += 1
            expires_at = grant.expires_at
            grant.end(now)
            self.latest_grant = replace(grant, number=self._number, expires_at=expires_at)

    def status(self, now: int) -> str:
        """Return who holds the lease, since when and why, as a person reads it."""
        grant = self.grant(now)
        if grant:
            return self._held(grant, now)
        last = self._last_holder
        return f"{self.holder_text(now)}; {last} held it last" if last else self.holder_text(now)

    def holder_text(self, now: int) -> str:
        """Return who holds the lease, the same text for one grant."""
        grant = self.grant(now)
        return f"{grant.holder} holds {self.name}" if grant else f"nobody holds {self.name}"

    def _grant_to(
        self, commander: Commander, now: int, reason: str, given_by: Person | None = None
    ) -> LeaseAnswer:
        self._number += 1
        self._offered_to = ""
        self._last_holder = commander
        self.latest_grant = Grant(commander, self._number, now, now + self.ttl, reason, given_by)
        how_long = format_seconds(self.ttl)
        text = f"{self.name} is granted to {commander} for {how_long}, {reason}"
        return _granted(f"{text}; it moves nothing before a neutral command")

    def _grant_of(self, who: str, now: int) -> Grant | None:
        grant = self.grant(now)
        return grant if grant and grant.holder.name == who else None

    def _held(self, grant: Grant, now: int) -> str:
        since = format_seconds(now - grant.since)
        return f"{grant.holder} holds {self.name} for {since}, {grant.reason}"

    def _refuse_stranger(self, who: str) -> LeaseAnswer:
        return _refused(f"{who} is no commander of {self.name}: the plan does not name it")

    def _refuse_lower(self, who: Commander | Person, grant: Grant, now: int) -> LeaseAnswer:
        return _refused(f"{self._held(grant, now)}: {who} has no higher rank")

    def _refuse_other(self, who: str, now: int) -> LeaseAnswer:
        if who not in self._commanders:
            return self._refuse_stranger(who)
        return _refused(f"{who} does not hold {self.name}: {self.status(now)}")


def _is_above(rank: CommanderRank, other: CommanderRank) -> bool:
    return _RANKS.index(rank) < _RANKS.index(other)


def _granted(reason: str) -> LeaseAnswer:
    return LeaseAnswer(granted=True, reason=reason)


def _refused(reason: str) -> LeaseAnswer:
    return LeaseAnswer(granted=False, reason=reason)


def _with_reason(what: str, why: str) -> str:
    return f"{what}: {why}" if why else what
