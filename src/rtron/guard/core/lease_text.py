"""Who holds a lease, since when and why, in the guard's reports."""

import time

from rtron.policies.authority.command_lease import CommandLease
from rtron.vocabulary import SECOND, LeaseStatus


def lease_text(lease: CommandLease, now: int) -> str:
    """Return who holds a lease at `now` (ns, steady), since when and why, for people."""
    grant = lease.grant(now)
    if grant is None:
        return lease.status(now)
    since = time.localtime(wall_time(grant.since, now))
    text = time.strftime("%Y-%m-%d %H:%M:%S", since)
    return f"{lease.holder_text(now)} since {text}, {grant.reason}"


def lease_status(lease: CommandLease, now: int) -> LeaseStatus:
    """Return the same for the security service; times are rounded, so that they stay the same."""
    grant = lease.grant(now)
    if grant is None:
        return LeaseStatus(name=lease.name, reason=lease.status(now))
    return LeaseStatus(
        name=lease.name,
        holder=grant.holder.name,
        rank=grant.holder.rank,
        since=_rounded_time(grant.since, now),
        until=_rounded_time(grant.expires_at, now),
        reason=grant.reason,
        grant=grant.number,
        given_by=str(grant.given_by or ""),
    )


def lease_values(lease: CommandLease, now: int) -> dict[str, object]:
    """Return the same for programs; `since` in s of the wall clock, `ttl` in s."""
    grant = lease.grant(now)
    values: dict[str, object] = {"lease": lease.name, "ttl": lease.ttl / SECOND}
    if grant is None:
        return {**values, "holder": "", "reason": lease.status(now)}
    since = round(wall_time(grant.since, now), 3)
    holder, rank = grant.holder.name, grant.holder.rank.value
    return {**values, "holder": holder, "rank": rank, "since": since, "reason": grant.reason}


def _rounded_time(at: int, now: int) -> int:
    """Return a time of the steady clock as one of the wall clock, ns in whole hundredths of s."""
    return round(wall_time(at, now) * 100) * (SECOND // 100)


def wall_time(at: int, now: int) -> float:
    """Return a time of the guard's steady clock as a time of the wall clock, s."""
    return time.time() - (now - at) / SECOND
