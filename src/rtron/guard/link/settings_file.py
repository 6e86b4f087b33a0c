"""The last settings on disk: the guard begins with them, whether or not the service is there."""

from dataclasses import replace
from pathlib import Path

from rtron.errors import SourceError, WireError
from rtron.guard.system.durable_file import replace_file
from rtron.guard.system.machine_time import MachineTime
from rtron.vocabulary import Settings
from rtron.wire.common.link_protocol import NewSettings, decode_to_guard, encode_to_guard


def read_settings(path: Path, at: MachineTime) -> Settings | None:
    """Return what was kept last; None if nothing was. SourceError if it cannot be read.

    Overrides end by the machine's own time. Once it was started anew nobody knows which are over:
    all of them are.
    """
    try:
        message = decode_to_guard(path.read_bytes())
    except FileNotFoundError:
        return None
    except (OSError, WireError) as error:
        raise _unreadable(path, error) from None
    if not isinstance(message, NewSettings):
        raise _unreadable(path, "no settings")
    if at.boot and message.boot == at.boot and message.now <= at.now:
        return message.settings
    return replace(message.settings, overrides={})


def _unreadable(path: Path, why: object) -> SourceError:
    return SourceError(f"the settings in {path} cannot be read, a stop may be among them: {why}")


def write_settings(path: Path, settings: Settings, at: MachineTime) -> None:
    """Write settings so that a crash at any moment leaves the old or the new ones, whole."""
    message = NewSettings(settings=settings, now=at.now, boot=at.boot)
    replace_file(path, encode_to_guard(message))
