"""New settings for the running guard: all of them, at once, or nothing and why."""

from rtron.errors import InputError
from rtron.guard.core.coordinator import Host
from rtron.guard.settings.emergency_stop import Emergency
from rtron.guard.settings.granted import Granted
from rtron.guard.settings.mission_rules import Rules
from rtron.guard.transport.common.protocol import Transport
from rtron.messages.common.velocity import VELOCITY_TYPES
from rtron.vocabulary import MisfitError, Plan, PolicyName, Settings, normalise_type, streams
from rtron.vocabulary.settings_validation import in_force


class Applying:
    """Puts settings in force in a host that guards `plan`, before it is opened or while it runs.

    The messages wait meanwhile. Everything that can fail is made first; then the new parts take
    the places of the old ones and go on with what these know.
    """

    def __init__(self, plan: Plan, host: Host, transport: Transport) -> None:
        self.revision = plan.revision
        """The revision in force."""
        self._plan = plan
        self._host = host
        self._transport = transport
        self._rules = Rules(plan, host.senses)
        self._granted = Granted(host, transport)
        self._emergency = Emergency(host, transport)

    @property
    def stopped(self) -> bool:
        """Whether the emergency stop keeps the robot from moving.

        It cannot in a dry run, nor where the plan only observes: there it is only told.
        """
        return bool(self._host.emergency) and self._emergency.stops

    def apply(self, settings: Settings, wall_now: int) -> None:
        """Put settings in force; `wall_now` is the wall clock (ns) that overrides end by.

        RTronError if they cannot be: then nothing has changed.
        """
        plan = self._in_force(settings)
        rules = self._rules.prepare(plan)
        pairs = zip(self._host.guarded, streams(plan), strict=True)
        adaptations = [
            each.prepare(stream, rules.senses, rules.standings) for each, stream in pairs
        ]
        now = self._transport.now()
        if settings.stop:
            self._emergency.stop(settings.stop)
        self._rules.put(rules, now)
        self._host.adapt(rules.senses, adaptations)
        self._granted.put(settings.overrides, wall_now)
        self.revision = settings.revision
        if not settings.stop:
            self._emergency.release()
        self._host.attend()

    def _in_force(self, settings: Settings) -> Plan:
        try:
            plan = in_force(self._plan, settings)
        except MisfitError as error:
            raise InputError(str(error)) from None
        _check_types(plan)
        return plan


def _check_types(plan: Plan) -> None:
    """Refuse to limit what is no velocity: nothing would pass any more."""
    if plan.rsrcn is None or plan.rsrcn.policy is PolicyName.BLOCK:
        return
    for topic in plan.rsrcn.vflows:
        if topic.type and normalise_type(topic.type) not in VELOCITY_TYPES:
            told = f"{plan.rsrcn.policy} cannot limit {topic.topic}, which carries {topic.type}"
            raise InputError(told)
