"""What the tests of actions share."""

import pytest
from action_app import compile_actions


@pytest.fixture(scope="session")
def programs(tmp_path_factory):
    return compile_actions(tmp_path_factory.mktemp("actions"))
