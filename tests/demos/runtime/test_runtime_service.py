"""The security service of a run, and what is asked of it."""

import os
from types import SimpleNamespace

import pytest

from rtron.demos.runtime.processes import ProcessGroup
from rtron.demos.runtime.service import run_service
from rtron.errors import SourceError
from rtron.workflows.service_events import stored_events


def test_the_service_runs_as_long_as_the_block(tmp_path):
    graph = tmp_path / "graph.json"
    graph.write_text('{"schema": "rtron.graph/1", "app": "tb3", "nodes": []}')
    environ = {**os.environ, "XDG_RUNTIME_DIR": str(tmp_path)}
    with ProcessGroup(tmp_path) as processes:
        with run_service(processes, tmp_path / "service", environ) as service:
            service.wait()
            assert service.client.get("robots") == []
            assert len(service.password) >= 12
            assert service.environ()["RTRON_SERVICE"] == service.url
            assert [token.stat().st_mode & 0o077 for token in service.tokens.values()] == [0] * 3
            assert service.page == f"{service.url}/#/robots/tb3/events"
            with pytest.raises(SourceError, match="there is no such robot"):
                service.upload(graph)
        with pytest.raises(SourceError, match="does not answer"):
            service.client.get("robots")


def test_events_are_asked_for_page_by_page():
    pages = {
        None: {"events": [{"at": 3}, {"at": 2}], "next": 7},
        7: {"events": [{"at": 1}], "next": None},
    }
    client = SimpleNamespace(get=lambda _, **query: pages[query.get("before")])
    found = stored_events(client, robot="tb3", since=0, until=10)
    assert sorted(event["at"] for event in found) == [1, 2, 3]
