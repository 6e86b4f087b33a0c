import json

import pytest
from service_app import open_app
from webhook_receiver import run_receiver

from rtron.service.config import ServiceConfig
from rtron.service.domain.hash_chain import HEADS_SCHEMA, verify_document


@pytest.fixture
def app(tmp_path, clock):
    config = ServiceConfig(database=tmp_path / "rtron.db", heads_interval_s=1)
    with open_app(config, clock) as app:
        yield app


def test_a_webhook_takes_signed_heads_and_no_alerts(app, client, admin):
    with run_receiver() as receiver:
        hook = {"url": f"http://127.0.0.1:{receiver.port}/heads", "level": "heads"}
        answer = client.post("/api/v1/webhooks", json=hook, headers=admin)
        assert answer.json()["level"] == "heads"
        document = json.loads(receiver.call()[2])
        keys = {app.state.service.signer.public_key}
        assert verify_document(document, keys, HEADS_SCHEMA)["heads"]["service"][0] == 1
        alarm = {"id": 1, "robot": "car1", "kind": "alarm", "level": "error"}
        app.state.service.hub.broadcast({"type": "event", "event": alarm})
        hook["level"] = "error"
        client.post("/api/v1/webhooks", json=hook, headers=admin)
        assert json.loads(receiver.call()[2])["heads"]["service"][0] == 2
