"""What Python lists itself: the classes that extend one, and the items of an array."""

import pytest
from ros1_runs import names, python

PLUGINS = """
class Module:
    def start(self): pass
class Arm(Module):
    def start(self): P('arm')
class Base(Module):
    def start(self): P('base')
def heirs(cls):
    return cls.__subclasses__() + [heir for one in cls.__subclasses__() for heir in heirs(one)]
modules = [one() for one in heirs(Module)]
for module in modules:
    module.start()
"""


def test_each_class_that_extends_another_is_made():
    assert names(python(PLUGINS)) == ["arm", "base"]


@pytest.mark.parametrize("make", ["np.array", "np.asarray"])
def test_the_items_of_an_array_are_known(make):
    text = f"import numpy as np\nfor i in {make}([0, 1]):\n    P(f't{{i}}')\n"
    assert names(python(text)) == ["t0", "t1"]


def test_what_is_computed_of_an_array_is_not_known():
    text = "import numpy as np\nfor i in np.array([0, 1]) + np.array([2]):\n    P(f't{i}')\n"
    assert all("{" in name for name in names(python(text)))
