"""The scan of one app in a process of its own."""

import pytest

from rtron.errors import SourceError
from rtron.survey import app_scan
from rtron.survey.app_listing import AppToScan
from rtron.survey.app_scan import scan_app


def subject(repositories, launch):
    return AppToScan(
        top=repositories, repository=repositories / "drive", launch=repositories / "drive" / launch
    )


def test_what_the_scan_complains_of_is_told(repositories):
    with pytest.raises(SourceError, match=r"broken\.launch"):
        scan_app(subject(repositories, "drive_base/launch/broken.launch"))


def test_a_scan_that_takes_too_long_is_ended(repositories, monkeypatch):
    monkeypatch.setattr(app_scan, "TIMEOUT_S", 0.001)
    monkeypatch.setattr(app_scan, "_STOP_TIMEOUT_S", 10**6)  # it stops when it is told to
    with pytest.raises(SourceError, match="not done within"):
        scan_app(subject(repositories, "drive_base/launch/two.launch"))
