"""The security service of a run, and what is asked of it."""

import os

import pytest

from rtron.demos.runtime.processes import ProcessGroup
from rtron.demos.runtime.service import (
    DecisionCounts,
    EventHistory,
    run_service,
    sum_decision_counts,
)
from rtron.errors import SourceError
from rtron.workflows.service_client import SecurityServiceClient


def counts(**flows):
    return {"values": {"streams": {"/cmd_vel": {"flows": flows}}}}


def test_the_service_runs_as_long_as_the_block(tmp_path):
    graph = tmp_path / "graph.json"
    graph.write_text('{"schema": "rtron.graph/1", "app": "tb3", "nodes": []}')
    environ = {**os.environ, "XDG_RUNTIME_DIR": str(tmp_path)}
    with ProcessGroup(tmp_path) as processes:
        with run_service(processes, tmp_path / "service", environ) as service:
            service.wait()
            assert service.history.robots() == []
            assert service.history.state() is None
            assert len(service.password) >= 12
            assert service.environ()["RTRON_SERVICE"] == service.url
            assert service.guard_token.stat().st_mode & 0o077 == 0
            assert service.developer_token.stat().st_mode & 0o077 == 0
            assert service.page == f"{service.url}/#/robots/tb3/events"
            with pytest.raises(SourceError, match="there is no such robot"):
                service.upload(graph)
        with pytest.raises(SourceError, match="does not answer"):
            service.history.robots()


def test_counts_are_added_up_by_topic_and_flow():
    events = [counts(nav=(3, 0, 0, 1), other=(0, 0, 5, 0)), counts(nav=(2, 1, 0, 0))]
    assert sum_decision_counts(events) == {
        "/cmd_vel": {"nav": DecisionCounts(5, 1, 0, 1), "other": DecisionCounts(dropped=5)}
    }


def test_events_are_asked_for_page_by_page(monkeypatch):
    pages = {
        None: {"events": [{"at": 3}, {"at": 2}], "next": 7},
        7: {"events": [{"at": 1}], "next": None},
    }
    recorded = EventHistory(SecurityServiceClient("http://nowhere", "token"), "tb3")
    monkeypatch.setattr(EventHistory, "wait_until_linked", lambda *_: None)
    monkeypatch.setattr(
        SecurityServiceClient, "get", lambda _, path, **query: pages[query.get("before")]
    )
    assert [event["at"] for event in recorded.events(0, 10)] == [1, 2, 3]
