"""Ways in which a Python program makes an endpoint, once it has the name.

E is the expression of the name; `F` an expression of a function that makes the endpoint of a name;
DIRECT(x) makes it of the name x; MAKER is the client library's own function or class.
"""

GENERIC = """DIRECT(E)
---
KEYWORDS(E)
---
keep.append(DIRECT(E))
---
F(E)
---
make@ = F
make@(E)
---
def make@(name):
    return DIRECT(name)
make@(E)
---
def make@(*args, **kwargs):
    return (F)(*args, **kwargs)
make@(E)
---
{"a": F, "b": print}["a"](E)
---
for make@, name@ in [(F, E)]:
    make@(name@)
---
for name@ in (E,):
    DIRECT(name@)
---
[DIRECT(name) for name in [E]]
---
ends@ = {name: DIRECT(name) for name in [E]}
---
list(map(F, [E]))
---
list(itertools.starmap(F, [(E,)]))
---
any([DIRECT(E)])
---
[(F)(config["name"]) for config in [{"name": E}]]
---
class Maker@:
    def make(self, name):
        return DIRECT(name)
Maker@().make(E)
---
class Maker@:
    def __init__(self, name):
        self.end = DIRECT(name)
maker@ = Maker@(E)
---
class Maker@:
    def __call__(self, name):
        return DIRECT(name)
Maker@()(E)
---
class Maker@:
    make = staticmethod(F)
Maker@().make(E)
---
class Maker@:
    def __init__(self, make):
        self.make = make
    def run(self, name):
        self.make(name)
Maker@(F).run(E)
---
class Maker@:
    def __init__(self, name):
        self.name = name
    @property
    def end(self):
        return DIRECT(self.name)
Maker@(E).end
---
class Maker@:
    def __init__(self, name):
        self.name = name
    @functools.cached_property
    def end(self):
        return DIRECT(self.name)
Maker@(E).end
---
class Maker@:
    def __init__(self, name):
        self.name = name
    def __enter__(self):
        return DIRECT(self.name)
    def __exit__(self, *error):
        return None
with Maker@(E) as end@:
    pass
---
class Maker@:
    def __init__(self, name):
        self.name = name
    def __enter__(self):
        return self
    def __exit__(self, *error):
        DIRECT(self.name)
with Maker@(E):
    pass
---
class Maker@:
    def __getattr__(self, attribute):
        return lambda name: DIRECT(name)
Maker@().whatever(E)
---
class Maker@:
    def __getitem__(self, name):
        return DIRECT(name)
Maker@()[E]
---
class Maker@:
    def __setattr__(self, attribute, name):
        DIRECT(name)
Maker@().whatever = E
---
class Maker@:
    def __setitem__(self, key, name):
        DIRECT(name)
Maker@()["whatever"] = E
---
class Maker@:
    def __iter__(self):
        yield DIRECT(E)
for end@ in Maker@():
    pass
---
class Maker@:
    def __lshift__(self, name):
        DIRECT(name)
        return self
Maker@() << E
---
class Maker@:
    @property
    def name(self):
        return None
    @name.setter
    def name(self, name):
        DIRECT(name)
Maker@().name = E
---
class Maker@:
    def __set__(self, owner, name):
        DIRECT(name)
class Owner@:
    end = Maker@()
Owner@().end = E
---
class Maker@:
    def __set_name__(self, owner, name):
        DIRECT(E)
class Owner@:
    end = Maker@()
---
class Maker@:
    def __init_subclass__(cls, **kwargs):
        DIRECT(cls.name)
class Made@(Maker@):
    name = E
---
class Maker@(type):
    def __init__(cls, name, bases, members):
        super().__init__(name, bases, members)
        DIRECT(members["name"])
class Made@(metaclass=Maker@):
    name = E
---
class Maker@:
    def __new__(cls, name):
        made = super().__new__(cls)
        made.end = DIRECT(name)
        return made
Maker@(E)
---
class Maker@:
    def __del__(self):
        pass
    def make(self, name):
        return DIRECT(name)
getattr(Maker@(), "ma" + "ke")(E)
---
@dataclasses.dataclass
class Maker@:
    name: str
    def __post_init__(self):
        self.end = DIRECT(self.name)
Maker@(E)
---
@dataclasses.dataclass
class Maker@:
    name: str
    make: object = F
maker@ = Maker@(E)
maker@.make(maker@.name)
---
class Maker@(enum.Enum):
    A = E
    def make(self):
        return DIRECT(self.value)
for one@ in Maker@:
    one@.make()
---
def decorate@(name):
    def decorator(function):
        DIRECT(name)
        return function
    return decorator
@decorate@(E)
def decorated@():
    pass
---
class Decorate@:
    def __init__(self, name):
        self.name = name
    def __call__(self, function):
        DIRECT(self.name)
        return function
@Decorate@(E)
def decorated@():
    pass
---
def decorate@(function):
    @functools.wraps(function)
    def wrapper(*args):
        name = function(*args)
        return DIRECT(name)
    return wrapper
@decorate@
def name@(text):
    return text
name@(E)
---
def decorate@(cls):
    cls.end = DIRECT(cls.name)
    return cls
@decorate@
class Made@:
    name = E
---
@contextlib.contextmanager
def making@(name):
    yield DIRECT(name)
with making@(E):
    pass
---
def making@(names):
    for name in names:
        yield DIRECT(name)
list(making@([E]))
---
def making@():
    while True:
        name = yield
        DIRECT(name)
generator@ = making@()
next(generator@)
generator@.send(E)
---
functools.reduce(lambda made, name: made + [DIRECT(name)], [E], [])
---
operator.methodcaller("__call__", E)(F)
---
[make(E) for make in (F,)]
---
stack@ = [E]
while stack@:
    name@ = stack@.pop()
    DIRECT(name@)
---
queue@ = queue.Queue()
queue@.put(E)
name@ = queue@.get()
DIRECT(name@)
---
with concurrent.futures.ThreadPoolExecutor() as pool@:
    pool@.submit(F, E).result()
---
with concurrent.futures.ThreadPoolExecutor() as pool@:
    list(pool@.map(F, [E]))
---
thread@ = threading.Thread(target=F, args=(E,))
thread@.start()
thread@.join()
---
@functools.singledispatch
def make@(name):
    raise TypeError(name)
@make@.register(str)
def make_text@(name):
    return DIRECT(name)
make@(E)
---
exec("DIRECT(name)", {**globals(), "name": E})
---
eval("make(name)", {"make": F, "name": E})
---
(end@ := DIRECT(E))
---
end@ = DIRECT(E) if keep is not None else None
---
keep is not None and DIRECT(E)
---
assert DIRECT(E) is not None
---
Row@ = collections.namedtuple("Row", "make name")
for row@ in [Row@(F, E)]:
    row@.make(row@.name)
---
space@ = types.SimpleNamespace(make=F)
space@.make(E)
---
async def make@(name):
    return DIRECT(name)
make@(E).send(None) if False else asyncio.new_event_loop().run_until_complete(make@(E))
"""
SUBCLASSES = """class End@(MAKER):
    pass
End@(ARGS(E))
---
class End@(MAKER):
    def __init__(self, name):
        MAKER.__init__(self, ARGS(name))
End@(E)
---
class End@(MAKER):
    def __init__(self, name):
        super().__init__(ARGS(name))
End@(E)
---
class End@(MAKER):
    def __init__(self, name):
        super(End@, self).__init__(ARGS(name))
End@(E)
---
class Middle@(MAKER):
    def __init__(self, *args, **kwargs):
        MAKER.__init__(self, *args, **kwargs)
class End@(Middle@):
    def __init__(self, name):
        Middle@.__init__(self, ARGS(name))
End@(E)
---
class Mixin@:
    def __init__(self, *args, **kwargs):
        super().__init__(*args, **kwargs)
class End@(Mixin@, MAKER):
    def __init__(self, name):
        super().__init__(ARGS(name))
End@(E)
---
base@ = MAKER
class End@(base@):
    def __init__(self, name):
        base@.__init__(self, ARGS(name))
End@(E)
---
type("End", (MAKER,), {})(ARGS(E))
---
MAKER.__call__(ARGS(E)) if False else MAKER(ARGS(E))
---
class Holder@:
    kind = MAKER
    def make(self, name):
        return self.kind(ARGS(name))
Holder@().make(E)
---
globals()["Kind@"] = MAKER
Kind@(ARGS(E))
"""
ROSPY = """from rospy import Publisher as Kind@
Kind@(E, String, queue_size=1)
---
import rospy as ros@
ros@.Publisher(E, String, queue_size=1)
---
getattr(rospy, "Publisher")(E, String, queue_size=1)
---
importlib.import_module("rospy").Publisher(E, String, queue_size=1)
---
rospy.Publisher(data_class=String, name=E, queue_size=1)
---
rospy.Publisher(**{"name": E, "data_class": String, "queue_size": 1})
---
rospy.Publisher(*[E, String], queue_size=1)
"""
RCLPY = """class Node@(Node):
    def __init__(self, name):
        super().__init__("node@")
        self.make(name)
    def make(self, name):
        self.end = self.create_publisher(String, name, 10)
keep.append(Node@(E))
---
class Mixin@:
    def make(self, name):
        self.create_publisher(String, name, 10)
class Node@(Mixin@, Node):
    def __init__(self, name):
        Node.__init__(self, "node@")
        self.make(name)
keep.append(Node@(E))
---
class Part@:
    def __init__(self, node):
        self.node = node
    def make(self, name):
        self.node.create_publisher(String, name, 10)
Part@(node).make(E)
---
getattr(node, "create_publisher")(String, E, 10)
---
rclpy.create_node("node@").create_publisher(String, E, 10)
---
node.create_publisher(topic=E, msg_type=String, qos_profile=10)
"""
