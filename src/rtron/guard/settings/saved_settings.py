"""The settings that the security service sent last: the guard begins with them."""

import logging
import time

from rtron.errors import InputError, SourceError
from rtron.guard.link.options import LinkOptions
from rtron.guard.link.settings_file import read_settings
from rtron.guard.settings.in_force import SettingsInForce
from rtron.guard.system.machine_time import machine_time
from rtron.vocabulary import EmergencyStop

log = logging.getLogger(__name__)


def settings_at_start(settings: SettingsInForce, options: LinkOptions) -> None:
    """Put the last settings in force that the service has sent, before the guard opens.

    Where they cannot be read, the robot is stopped until the service sends settings.
    """
    _prepare_folders(options)
    try:
        saved = read_settings(options.settings_file, machine_time())
    except SourceError as error:
        settings.stop_robot(EmergencyStop(by="the guard", reason=str(error), at=time.time_ns()))
    else:
        if saved:
            settings.apply(saved)


def _prepare_folders(options: LinkOptions) -> None:
    """Make the folders; a guard whose disk is full guards all the same."""
    try:
        options.prepare()
    except InputError as error:
        log.error("the link to the service will not work: %s", error)  # noqa: TRY400
