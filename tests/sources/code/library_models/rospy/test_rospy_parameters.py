"""A parameter that is not set throws only where a handler takes what it throws."""

import pytest
from ros1_runs import names, python

READ = "try:\n    t = rospy.get_param('~t')\n    P('read')\nexcept {}:\n    P('caught')\n"


@pytest.mark.parametrize("handler", ["KeyError", "(ValueError, KeyError)", "Exception"])
def test_a_handler_that_takes_it_is_reached(handler):
    assert names(python(READ.format(handler))) == ["caught"]


@pytest.mark.parametrize("handler", ["rospy.ROSInterruptException", "ValueError"])
def test_what_no_handler_takes_may_be_set_by_another_program(handler):
    assert "read" in names(python(READ.format(handler)))
