"""What a roll-out is at, and each of its robots."""

from rtron.vocabulary import StringEnum


class RolloutState(StringEnum):
    """What a roll-out is at; the last three are its ends.

    A roll-out that is done still reaches the robots that were off.
    """

    RUNNING = "running"
    PAUSED = "paused"
    REVERTING = "reverting"
    DONE = "done"
    REVERTED = "reverted"
    CANCELLED = "cancelled"


ACTIVE_STATES = frozenset({RolloutState.RUNNING, RolloutState.PAUSED, RolloutState.REVERTING})
"""No other roll-out may have a robot of one that is at this."""


class RobotPhase(StringEnum):
    """What a robot of a roll-out is at.

    `sending`: what was in force before is stored, so that the change may be made; `sent`: it is a
    revision of the robot's settings; `reverted`: the settings before are a revision again; `stuck`:
    they make no plan any more, so somebody has to look.
    """

    WAITING = "waiting"
    SENDING = "sending"
    SENT = "sent"
    REVERTED = "reverted"
    STUCK = "stuck"


class Problem(StringEnum):
    """What a robot may show after a change that it did not show before.

    `refused`: the guard, or the service, does not take the change. `alarm`: a new alarm. `blocked`:
    a higher share of its messages is blocked. `stopped`: it was stopped. `restarted`: its guard
    began anew. `gone`: its guard is not connected any more, or does not answer.
    """

    REFUSED = "refused"
    ALARM = "alarm"
    BLOCKED = "blocked"
    STOPPED = "stopped"
    RESTARTED = "restarted"
    GONE = "gone"
