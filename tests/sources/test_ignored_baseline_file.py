"""What is no baseline is refused with what to do."""

import json

import pytest

from rtron.errors import InputError
from rtron.sources.ignores import read_baseline
from rtron.vocabulary import RISKS_SCHEMA

EMPTY = {"schema": RISKS_SCHEMA, "findings": [], "ignored": [], "risks": []}


def read(tmp_path, text):
    path = tmp_path / "last.json"
    path.write_text(text)
    return read_baseline(path)


def test_an_empty_report_knows_nothing(tmp_path):
    baseline = read(tmp_path, json.dumps(EMPTY))
    assert (baseline.findings, baseline.risks) == ({}, frozenset())


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "not JSON"),
        ("[" * 200_000, "not JSON"),
        ("[]", "no report of a scan"),
        (json.dumps({**EMPTY, "schema": "rtron.risks/1"}), "no report of a scan"),
        (json.dumps({**EMPTY, "findings": 3}), "incomplete"),
        (json.dumps({**EMPTY, "findings": [{"id": "x"}]}), "incomplete"),
        (json.dumps({**EMPTY, "findings": [{"id": "x", "fingerprint": 3}]}), "incomplete"),
        (json.dumps({**EMPTY, "ignored": ["x"]}), "incomplete"),
        (json.dumps({**EMPTY, "risks": [None]}), "incomplete"),
        (json.dumps({"schema": RISKS_SCHEMA}), "incomplete"),
    ],
)
def test_another_file_is_refused(tmp_path, text, message):
    with pytest.raises(InputError) as raised:
        read(tmp_path, text)
    assert message in str(raised.value)
    assert raised.value.help.startswith("write one with")
