"""docs/plan.md names every key of a plan, of a GRCN and of a flow."""

from dataclasses import fields
from pathlib import Path

import pytest

from rtron.vocabulary import GRCN, Flow, Plan

PAGE = (Path(__file__).parents[2] / "docs" / "plan.md").read_text(encoding="utf-8")
KEYS = {key.name for form in (Plan, GRCN, Flow) for key in fields(form)}


@pytest.mark.parametrize("key", sorted(KEYS))
def test_a_key_is_on_the_page(key):
    assert f"`{key}`" in PAGE
