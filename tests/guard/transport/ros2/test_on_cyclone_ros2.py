"""The same tests of the transport on Cyclone DDS, where its RMW is there (mark.ros2)."""

from pathlib import Path

import pytest
from cyclone_rmw import run_on_cyclone, runs_others

TESTS = Path(__file__).parent.parent
LIMIT_S = 900
pytestmark = [*runs_others, pytest.mark.timeout(LIMIT_S)]


def test_the_transport_keeps_to_its_contract_on_cyclone_dds():
    run_on_cyclone(TESTS, LIMIT_S)
