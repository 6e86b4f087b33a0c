"""Letting Fast DDS announce the guard often, so that the guard learns soon of whoever comes.

Two participants know each other when one has heard the other's announcement and answered. Fast DDS
repeats it every 3 s (its own default, `leaseAnnouncement`): where the first ones are lost, an
intruder and a driver may have met seconds before the guard hears of the intruder.
"""

import logging
import os
from collections.abc import MutableMapping
from pathlib import Path

log = logging.getLogger(__name__)

_FILE = "FASTDDS_DEFAULT_PROFILES_FILE"
_FASTDDS_2_FILE = "FASTRTPS_DEFAULT_PROFILES_FILE"
_FASTDDS_2_DISTRIBUTIONS = ("humble", "iron", "jazzy")
"""The distributions with Fast DDS 2, which reads the former variable."""
_PROFILE = Path(__file__).with_name("announce.xml")


def enable_fast_announcements(environ: MutableMapping[str, str] = os.environ) -> bool:
    """Announce the participants made from now on ten times a second; tell whether that is so.

    Where the user has profiles of their own, these count: then intruders may be found later.
    """
    profile = environ.get(_FILE) or environ.get(_FASTDDS_2_FILE)
    if profile == str(_PROFILE):
        return True
    if profile:
        log.info("your profiles of Fast DDS count: intruders may be found up to 3 s later")
        return False
    name = _FASTDDS_2_FILE if environ.get("ROS_DISTRO") in _FASTDDS_2_DISTRIBUTIONS else _FILE
    environ[name] = str(_PROFILE)
    return True
