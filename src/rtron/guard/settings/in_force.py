"""The settings that one process of the guard has in force, and why it has refused others."""

import logging
from dataclasses import replace

from rtron.errors import RTronError
from rtron.guard.settings.applier import SettingsApplier
from rtron.guard.system.machine_time import machine_time
from rtron.vocabulary import EmergencyStop, Settings

log = logging.getLogger(__name__)


class SettingsInForce:
    """Puts settings in force or refuses them; an emergency stop is never refused."""

    def __init__(self, applier: SettingsApplier) -> None:
        self.current = Settings(revision=applier.revision)
        self.refusal = ""
        """Why settings were refused last, with their revision."""
        self._applier = applier

    @property
    def revision(self) -> int:
        """The revision in force."""
        return self._applier.revision

    @property
    def is_stopped(self) -> bool:
        """Whether the emergency stop keeps the robot from moving."""
        return self._applier.is_stopped

    def apply(self, settings: Settings) -> str:
        """Put settings in force; return why that is not possible, or nothing."""
        try:
            self._applier.apply(settings, machine_time().now)
        except RTronError as error:
            self.refuse(settings, str(error))
            return str(error)
        except MemoryError:
            raise
        except Exception as error:
            log.exception("settings: internal error")
            self.refuse(settings, f"internal error: {error}")
            return f"internal error: {error}"
        self.current = settings
        log.info("settings: revision %d is in force", settings.revision)
        return ""

    def refuse(self, settings: Settings, why: str) -> None:
        """Put nothing of settings in force but their stop, beside what is in force."""
        self.refusal = f"revision {settings.revision} is refused: {why}"
        log.error("settings: %s", self.refusal)
        if settings.stop:
            self.stop_robot(settings.stop)

    def stop_robot(self, stop: EmergencyStop) -> None:
        """Put an emergency stop in force beside what is in force."""
        self.current = replace(self.current, stop=stop)
        self._applier.apply(self.current, machine_time().now)
