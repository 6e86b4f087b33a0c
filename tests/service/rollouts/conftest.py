"""Cars that have met the service."""

import pytest
from rollout_setup import RolloutSetup


@pytest.fixture
def cars(database):
    made = RolloutSetup(database).meet()
    yield made
    made.close()
