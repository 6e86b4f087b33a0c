"""Which tests need something that an RMW does not have, and what that is."""

import os

import pytest

RMW = os.environ.get("RMW_IMPLEMENTATION", "rmw_fastrtps_cpp")


def needs_fast_dds(reason):
    """Mark a test, or one of its cases, that only Fast DDS can pass."""
    return pytest.mark.skipif(not RMW.startswith("rmw_fastrtps"), reason=reason)
