"""What is written into an incident's file is what its readers check, field by field."""

import json

import pytest
from guarded_drive import posed_plan
from pydantic import TypeAdapter

from rtron.vocabulary import (
    EmergencyStop,
    FlowSettings,
    IncidentCause,
    IncidentHeader,
    NodeSettings,
    PolicyName,
    RuleSettings,
    Settings,
    TimedOverride,
)
from rtron.wire.common.incident_format import (
    FORMER_SETTINGS,
    INCIDENT,
    PLAN,
    SETTINGS,
    encode_metadata,
    encode_settings,
)

EVERY_SETTING = Settings(
    revision=7,
    nodes={
        "grcn": NodeSettings(
            policy=PolicyName.PREEMPTION,
            max_vel_limit=0.1 + 0.2,
            flows={"joystick ü": FlowSettings(priority=3, block=False)},
            rules={"near": RuleSettings(block=("/goal", '"quoted"\n'), when="a && b")},
        )
    },
    overrides={"rsrcn": TimedOverride(by="ann", reason="test", until=1 << 62)},
    stop=EmergencyStop(by="bob", reason="smoke", at=1),
)
HEADER = IncidentHeader(
    causes=(IncidentCause(at=1, kind="stop", topic="/cmd_vel", flow="nav", reason="timeout"),),
    omitted_causes=0,
    begin=0,
    end=2,
    app="app",
    ros=1,
    revision=7,
    rtron="1.0",
)


def assert_written(text, value):
    adapter = TypeAdapter(type(value))
    assert adapter.validate_json(text) == value
    assert json.loads(text) == json.loads(adapter.dump_json(value))


@pytest.mark.parametrize("settings", [Settings(), EVERY_SETTING])
def test_settings_are_written_whole(settings):
    assert_written(encode_settings(settings), settings)


def test_header_and_plan_are_written_whole():
    plan = posed_plan()
    metadata = encode_metadata(HEADER, plan, encode_settings(EVERY_SETTING), "{}")
    assert_written(metadata[INCIDENT]["json"], HEADER)
    assert_written(metadata[PLAN]["json"], plan)
    assert_written(metadata[SETTINGS]["json"], EVERY_SETTING)
    assert metadata[FORMER_SETTINGS]["json"] == "{}"
