"""The order in which Python looks for members: C3 over the bases, and `super()` along it."""

from random import Random

import pytest
from ros1_runs import names as names1
from ros1_runs import python as python1
from ros2_runs import UNLAUNCHED, names, python

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.python.method_resolution_order import (
    MAX_CLASSES,
    MethodResolutionOrders,
)
from rtron.sources.code.ir import Class

CLASSES = {
    "a mixin before the node": (
        """class Mixin:
    def mk(self, topic):
        self.create_publisher(Bool, topic, 1)
class M(Mixin, Node):
    def __init__(self):
        super().__init__('m')
        self.mk('out')""",
        ["/out"],
    ),
    "a mixin behind the node": (
        """class Mixin:
    def mk(self, topic):
        self.create_publisher(Bool, topic, 1)
class M(Node, Mixin):
    def __init__(self):
        super().__init__('m')
        self.mk('out')""",
        ["/out"],
    ),
    "a mixin that passes on": (
        """class Mixin:
    def __init__(self, *a, **k):
        super().__init__(*a, **k)
        self.create_publisher(Bool, 'out', 1)
class M(Mixin, Node):
    def __init__(self):
        super().__init__('m', namespace='far')""",
        ["/far/out"],
    ),
    "classes named": (
        """class Mixin(object):
    def __init__(self, *a, **k):
        super(Mixin, self).__init__(*a, **k)
        self.create_publisher(Bool, 'out', 1)
class M(Mixin, Node):
    def __init__(self):
        super(M, self).__init__('m')""",
        ["/out"],
    ),
    "a diamond": (
        """class Top(Node):
    def __init__(self, name):
        super().__init__(name)
        self.create_publisher(Bool, 'top', 1)
class Left(Top):
    def __init__(self, name):
        super().__init__(name)
        self.create_publisher(Bool, 'left', 1)
class Right(Top):
    def __init__(self, name):
        super().__init__(name)
        self.create_publisher(Bool, 'right', 1)
class M(Left, Right):
    def __init__(self):
        super().__init__('m')""",
        ["/top", "/right", "/left"],
    ),
    "what the object's class overrides": (
        """class Base(Node):
    def __init__(self):
        super().__init__('m')
        self.create_publisher(Bool, self.topic(), 1)
    def topic(self):
        return 'base'
class M(Base):
    def __init__(self):
        super().__init__()
    def topic(self):
        return 'own_' + super().topic()""",
        ["/own_base"],
    ),
    "properties and methods of the class": (
        """class Base(Node):
    @property
    def topic(self):
        return 'base'
    @classmethod
    def kind(cls):
        return 'kind'
class M(Base):
    def __init__(self):
        super().__init__('m')
        self.create_publisher(Bool, self.topic + self.kind(), 1)
    @property
    def topic(self):
        return 'own_' + super().topic
    @classmethod
    def kind(cls):
        return '_my_' + super().kind()""",
        ["/own_base_my_kind"],
    ),
    "a base that is not in the source": (
        """from vendor import Unknown
class M(Unknown, Node):
    def __init__(self):
        super().__init__('m')
        self.create_publisher(Bool, 'out', 1)""",
        ["/out"],
    ),
}


@pytest.mark.parametrize(("top", "expected"), CLASSES.values(), ids=CLASSES)
def test_super_is_what_stands_behind_in_the_object_s_order(top, expected):
    found = python("M()", top, **UNLAUNCHED)
    assert names(found) == expected
    assert len(found.nodes) == 2


@pytest.mark.parametrize("call", ["super()", "super(First, self)"])
def test_a_mixin_of_ros_1_passes_on(call):
    body = f"""class First(object):
    def __init__(self, name):
        {call}.__init__(name)
        P('first')
class Second(object):
    def __init__(self, name):
        P(name)
class Both(First, Second):
    pass
Both('second')"""
    assert names1(python1(body)) == ["second", "first"]


def test_bases_that_contradict_each_other_are_noted():
    top = """class A(Node):
    pass
class M(Node, A):
    def __init__(self):
        super().__init__('m')
        self.create_publisher(Bool, 'out', 1)"""
    found = python("M()", top, **UNLAUNCHED)
    assert names(found) == ["/out"]
    (note,) = [note for note in found.unresolved if note.what == "class M"]
    assert "no order for its bases" in note.why
    assert note.evidence[0].line == 6


def _own(name, bases):
    return av.ClassValue(Class(name=name, file="n.py", line=1), bases)


def _order_of_python(name, bases):
    try:
        return type(name, bases, {})
    except TypeError:
        return None


@pytest.mark.parametrize("seed", range(40))
def test_the_order_is_that_of_python(seed):
    random, orders = Random(seed), MethodResolutionOrders()
    made = []
    for number in range(9):
        bases = random.sample(made, k=random.randint(0, min(3, len(made))))
        name = f"C{number}"
        own, real = (
            _own(name, tuple(own for own, _ in bases)),
            _order_of_python(name, tuple(real for _, real in bases)),
        )
        found = [cls.name for cls in orders.order_of(own)]
        assert (own in orders.refused) == (real is None)
        if real is not None:
            assert found == [cls.__name__ for cls in real.__mro__[:-1]]
            made.append((own, real))


def test_a_long_line_of_bases_ends():
    cls = _own("C", ())
    for _ in range(5000):
        cls = _own("C", (cls,))
    assert len(MethodResolutionOrders().order_of(cls)) <= MAX_CLASSES
