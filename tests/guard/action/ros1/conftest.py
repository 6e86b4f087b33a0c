"""What the tests of actions share."""

import pytest
from action_app import compile_actions


@pytest.fixture(scope="session")
def programs(programs_folder):
    return compile_actions(programs_folder)
