"""The process that scans, and what becomes of apps that cannot be scanned."""

import os
import signal
from contextlib import closing

import pytest

from rtron.errors import SourceError
from rtron.sources.workspace import share_workspaces, shared_workspace
from rtron.survey import scan_server
from rtron.survey.app_listing import AppToScan, ScanRequest, find_apps
from rtron.survey.scan_server import WorkspaceSharing, raise_timeout, scan_forked
from rtron.survey.survey_run import ScanServers
from rtron.vocabulary import RiskKind


@pytest.fixture
def servers():
    with closing(ScanServers()) as opened:
        yield opened


@pytest.fixture
def requests():
    """Requests that are still open: no further one comes."""
    reading, writing = os.pipe()
    with os.fdopen(reading, "rb") as stream:
        yield stream
        os.close(writing)


def request_of(repositories, launch, seconds=60.0):
    repository = repositories / "drive"
    app = AppToScan(top=repositories, repository=repository, launch=repository / launch)
    return ScanRequest(app=app, seconds=seconds)


def test_one_process_scans_one_app_after_the_other(repositories):
    requests = [ScanRequest(app=app, seconds=60) for app in find_apps(repositories, print)]
    with closing(ScanServers()) as servers:
        two, one = map(servers.scan, requests)
        assert len(servers._started) == 1
    assert (two.survey.nodes, one.survey.nodes) == (3, 2)
    assert (two.survey.risks[RiskKind.GR_ST], two.error) == (1, "")


def test_a_ros_2_app_is_read_with_the_repositories_that_it_needs(servers, ros2_repositories):
    (app,) = find_apps(ros2_repositories, print)
    result = servers.scan(ScanRequest(app=app, seconds=60))
    assert result.error == ""
    assert (result.ros, result.survey.nodes) == (2, 2)


def test_what_the_scan_complains_of_is_the_reason(servers, repositories):
    result = servers.scan(request_of(repositories, "drive_base/launch/broken.launch"))
    assert result.survey is None
    assert result.error.startswith("drive/drive_base/launch/broken.launch:1: not XML")
    assert result.is_final


def test_a_scan_that_takes_too_long_is_ended(repositories, requests):
    asked = request_of(repositories, "drive_base/launch/two.launch", seconds=0.001)
    result = scan_forked(asked, requests)
    assert (result.survey, result.error) == (None, "not done within 0.001 s")


def test_a_scan_whose_process_dies_costs_itself_only(repositories, requests, monkeypatch):
    def die(_):
        os.kill(os.getpid(), signal.SIGKILL)

    monkeypatch.setattr(scan_server, "_survey", die)
    result = scan_forked(request_of(repositories, "drive_base/launch/two.launch"), requests)
    assert (result.error, result.is_final) == ("its process ended with -9", False)


@pytest.fixture
def sharing():
    """Share workspaces in this process, as the server does, until the end of the test."""
    before = signal.signal(signal.SIGALRM, raise_timeout)
    yield WorkspaceSharing()
    signal.signal(signal.SIGALRM, before)
    share_workspaces()


@pytest.mark.parametrize("top", ["repositories", "ros2_repositories"])
def test_a_workspace_that_is_read_once_changes_no_result(top, sharing, requests, request):
    app = list(find_apps(request.getfixturevalue(top), print))[-1]
    asked = ScanRequest(app=app, seconds=60, use_cache=False)
    alone = scan_forked(asked, requests)
    for _ in range(3):
        sharing.prepare(asked)
    assert sharing._workspace.packages
    shared = scan_forked(asked, requests)
    assert alone.survey == shared.survey


def test_a_workspace_that_takes_too_long_is_read_by_each_scan(repositories, sharing, requests):
    (app,) = (each for each in find_apps(repositories, print) if each.others == ())
    sharing.prepare(ScanRequest(app=app, seconds=1e-6))
    assert shared_workspace((app.repository,), "") is None
    assert scan_forked(ScanRequest(app=app, seconds=60), requests).survey


def test_a_fault_of_ours_is_a_reason(repositories, requests, monkeypatch):
    monkeypatch.setattr(scan_server, "_survey", lambda _: 1 // 0)
    result = scan_forked(request_of(repositories, "drive_base/launch/two.launch"), requests)
    assert result.error.startswith("RTron failed at it: ZeroDivisionError")


def test_a_scanning_process_that_is_gone_is_an_error(repositories):
    with closing(ScanServers()) as servers:
        servers.scan(request_of(repositories, "drive_base/launch/two.launch"))
        servers._started[0]._process.kill()
        with pytest.raises(SourceError, match="ended"):
            servers.scan(request_of(repositories, "drive_base/launch/two.launch"))
        again = servers.scan(request_of(repositories, "drive_base/launch/two.launch"))
    assert again.survey
