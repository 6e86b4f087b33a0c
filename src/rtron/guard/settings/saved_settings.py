"""The settings that the security service sent last: the guard begins with them, and stops."""

import logging
import time
from functools import partial

from rtron.errors import InputError, SourceError
from rtron.guard.core.event_loop import BackgroundWorker, EventLoop
from rtron.guard.link.options import LinkOptions
from rtron.guard.link.settings_file import read_settings
from rtron.guard.settings.in_force import SettingsInForce
from rtron.guard.system.machine_time import machine_time
from rtron.vocabulary import EmergencyStop, Settings

log = logging.getLogger(__name__)

_PERIOD_S = 0.1


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


class SavedStop:
    """Looks at the settings file ten times a second; puts a stop in force, and nothing else.

    Settings come by the bulk process, which may be away, hang or be busy with pictures.

    A stop is released by settings that come on the usual way. A disk that is full keeps no stop,
    and one that hangs keeps this look waiting and no command.
    """

    def __init__(self, settings: SettingsInForce, options: LinkOptions, loop: EventLoop) -> None:
        self._settings = settings
        self._file = options.settings_file
        self._loop = loop
        self._worker = BackgroundWorker(self._look, "saved-stop")
        self._read_at = 0
        self._failure = ""
        self._is_closed = False

    def open(self) -> None:
        """Look from now on."""
        if not self._is_closed:
            self._loop.call_later(_PERIOD_S, self.open)
            self._worker.request()

    def close(self) -> None:
        """Look no more."""
        self._is_closed = True

    def _look(self) -> None:
        """Read the file if it has changed, in the worker's thread."""
        try:
            written_at = self._file.stat().st_mtime_ns
        except OSError:
            return  # nothing was kept
        if written_at == self._read_at:
            return
        try:
            saved = read_settings(self._file, machine_time())
        except SourceError as error:  # not at the start: what is in force is known
            self._log_once(str(error))
            return
        self._read_at, self._failure = written_at, ""
        if saved and saved.stop:
            self._loop.post(partial(self._stop, saved, saved.stop))

    def _log_once(self, failure: str) -> None:
        """Say why the file cannot be read, which is tried again at the next look."""
        if failure != self._failure:
            log.error("%s", failure)
        self._failure = failure

    def _stop(self, saved: Settings, stop: EmergencyStop) -> None:
        if saved.revision > self._settings.revision:
            self._settings.stop_robot(stop)
