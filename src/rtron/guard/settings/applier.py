"""New settings for the running guard: all of them at once, or none."""

from rtron.errors import InputError
from rtron.guard.core.coordinator import Coordinator
from rtron.guard.settings.emergency_stop import EmergencyBrake
from rtron.guard.settings.granted import SettingsOverrides
from rtron.guard.settings.mission_rules import MissionRules
from rtron.guard.transport.common.protocol import Transport
from rtron.messages.common.velocity import VELOCITY_TYPES
from rtron.vocabulary import (
    Plan,
    PolicyName,
    Settings,
    SettingsMismatchError,
    build_streams,
    normalise_type,
)
from rtron.vocabulary.settings_validation import apply_valid_settings


class SettingsApplier:
    """Puts settings in force in a coordinator of `plan`, before it is opened or while it runs.

    Messages wait meanwhile. First it creates all that can fail; then the new parts replace the old
    ones and take over their state.
    """

    def __init__(self, plan: Plan, coordinator: Coordinator, transport: Transport) -> None:
        self.revision = plan.revision
        """The revision in force."""
        self._plan = plan
        self._coordinator = coordinator
        self._transport = transport
        self._rules = MissionRules(plan, coordinator.observations)
        self._overrides = SettingsOverrides(coordinator, transport)
        self._emergency_stop = EmergencyBrake(coordinator, transport)

    @property
    def is_stopped(self) -> bool:
        """Whether the emergency stop keeps the robot from moving.

        In a dry run, and where the plan only observes, the stop is only reported.
        """
        return bool(self._coordinator.emergency) and self._emergency_stop.has_effect

    def apply(self, settings: Settings, wall_now: int) -> None:
        """Put settings in force; `wall_now` is the wall clock (ns) that overrides end by.

        RTronError if they cannot be used; then nothing has changed.
        """
        plan = self._plan_in_force(settings)
        rules = self._rules.prepare(plan)
        pairs = zip(self._coordinator.streams, build_streams(plan), strict=True)
        adaptations = [
            each.prepare_update(stream, rules.observations, rules.rule_statuses)
            for each, stream in pairs
        ]
        now = self._transport.now()
        if settings.stop:
            self._emergency_stop.stop(settings.stop)
        self._rules.apply(rules, now)
        self._coordinator.apply_updates(rules.observations, adaptations)
        self._overrides.replace(settings.overrides, wall_now)
        self.revision = settings.revision
        if not settings.stop:
            self._emergency_stop.release()
        self._coordinator.recheck()

    def _plan_in_force(self, settings: Settings) -> Plan:
        try:
            plan = apply_valid_settings(self._plan, settings)
        except SettingsMismatchError as error:
            raise InputError(str(error)) from None
        _check_types(plan)
        return plan


def _check_types(plan: Plan) -> None:
    """Refuse to limit a topic without velocities: none of its messages would pass. InputError."""
    if plan.rsrcn is None or plan.rsrcn.policy is PolicyName.BLOCK:
        return
    for topic in plan.rsrcn.vflows:
        if topic.type and normalise_type(topic.type) not in VELOCITY_TYPES:
            text = f"{plan.rsrcn.policy} cannot limit {topic.topic}, which carries {topic.type}"
            raise InputError(text)
