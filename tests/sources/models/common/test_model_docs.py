"""docs/models.md names every key there is, functions.py every function."""

import re
from pathlib import Path

import pytest
from model_cases import site

from rtron.sources.models.common import functions
from rtron.sources.models.common.functions import model_functions
from rtron.sources.models.common.model_scope import node_scope
from rtron.sources.models.common.schema import Model, ModelEntry

PAGE = (Path(__file__).parents[4] / "docs" / "models.md").read_text(encoding="utf-8")
KEYS = {
    field.alias or name for form in (Model, ModelEntry) for name, field in form.model_fields.items()
}
NAMES = sorted(model_functions(node_scope(site())))


@pytest.mark.parametrize("key", sorted(KEYS))
def test_a_key_is_on_the_page(key):
    assert f"`{key}`" in PAGE


@pytest.mark.parametrize("name", NAMES)
def test_a_function_is_described(name):
    assert re.search(rf"\b{name}\(", functions.__doc__ or "")


def test_the_functions_on_the_page_are_there():
    assert set(re.findall(r"`(\w+)\(", PAGE)) <= {*NAMES}
