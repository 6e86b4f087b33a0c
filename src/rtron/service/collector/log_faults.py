"""What the service itself finds wrong with its log: an alarm of the robot that it concerns."""

from dataclasses import asdict, dataclass

from rtron.vocabulary import Alarm, AlarmKind, EventKind, GuardEvent, GuardEventLevel

_RUN = "audit log"
_KEY_DIGITS = 16


@dataclass(frozen=True, slots=True)
class LogFault:
    """Why a chain is not what it was; `key` (hex) and `number` name the fault."""

    chain: str
    reason: str
    key: str
    number: int = 1

    @property
    def alarm(self) -> Alarm:
        """What people see of it."""
        text = f"the service's log was changed: in {self.chain} {self.reason}"
        return Alarm(kind=AlarmKind.AUDIT_LOG, reason=text, node=self.chain)

    def event(self, now: int) -> GuardEvent:
        """Return its event at `now` (ns), the same one each time that it is found."""
        return GuardEvent(
            run=f"{_RUN} {self.key[:_KEY_DIGITS]}",
            number=self.number,
            at=now,
            kind=EventKind.ALARM,
            level=GuardEventLevel.ERROR,
            reason=self.alarm.reason,
            values=asdict(self.alarm),
        )
