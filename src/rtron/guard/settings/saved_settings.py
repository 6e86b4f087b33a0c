"""The settings that the security service sent last: the guard begins with them."""

import logging

from rtron.errors import InputError
from rtron.guard.link.options import LinkOptions
from rtron.guard.link.settings_file import read_settings
from rtron.guard.settings.in_force import SettingsInForce
from rtron.guard.system.machine_time import machine_time

log = logging.getLogger(__name__)


def settings_at_start(settings: SettingsInForce, options: LinkOptions) -> None:
    """Put the last settings in force that the service has sent, before the guard opens."""
    _prepare_folders(options)
    saved = read_settings(options.settings_file, machine_time())
    if saved:
        settings.apply(saved)


def _prepare_folders(options: LinkOptions) -> None:
    """Make the folders; a guard whose disk is full guards all the same."""
    try:
        options.prepare()
    except InputError as error:
        log.error("the link to the service will not work: %s", error)  # noqa: TRY400
