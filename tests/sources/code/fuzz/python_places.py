"""Places of a Python program that surely run (LIVE), and that surely do not (DEAD); BLOCK is there.

Those of LATER run once the node spins.
"""

LIVE = """if keep is not None:
    BLOCK
---
if not keep and keep:
    pass
elif 1 < 2 <= 2:
    BLOCK
else:
    pass
---
for one@ in range(1):
    BLOCK
---
for one@ in range(3):
    if one@ < 2:
        continue
    BLOCK
---
while True:
    BLOCK
    break
---
while False:
    pass
else:
    BLOCK
---
for one@ in "ab":
    if one@ == "c":
        break
else:
    BLOCK
---
try:
    pass
finally:
    BLOCK
---
try:
    pass
except ValueError:
    pass
else:
    BLOCK
---
try:
    raise KeyError("x")
except KeyError:
    BLOCK
---
with contextlib.suppress(ValueError):
    BLOCK
---
def run@():
    BLOCK
run@()
---
def run@():
    if not keep and keep:
        return
    BLOCK
run@()
---
def outer@():
    def run@():
        BLOCK
    return run@
outer@()()
---
class Run@:
    def run(self):
        BLOCK
Run@().run()
---
class Run@:
    def __init__(self):
        self.setup()
    def setup(self):
        BLOCK
run@ = Run@()
---
class Base@:
    def __init__(self):
        self.setup()
    def setup(self):
        pass
class Run@(Base@):
    def setup(self):
        super().setup()
        BLOCK
Run@()
---
class Run@:
    @staticmethod
    def run():
        BLOCK
Run@.run()
---
class Run@:
    @classmethod
    def run(cls):
        BLOCK
Run@.run()
---
def run@():
    BLOCK
class Run@:
    made = run@()
---
runs@ = []
def register@(function):
    runs@.append(function)
    return function
@register@
def run@():
    BLOCK
for one@ in runs@:
    one@()
---
def run@():
    BLOCK
{"a": run@, "b": print}["a"]()
---
def run@(count):
    if count == 0:
        BLOCK
        return
    run@(count - 1)
run@(1)
---
def run@():
    BLOCK
    yield
for one@ in run@():
    pass
---
def run@():
    BLOCK
thread@ = threading.Thread(target=run@)
thread@.start()
thread@.join()
---
class Run@(threading.Thread):
    def run(self):
        BLOCK
run@ = Run@()
run@.start()
run@.join()
---
match keep:
    case None:
        pass
    case _:
        BLOCK
---
def run@(_):
    BLOCK
sorted([1], key=lambda one: run@(one) or one)
---
def run@(_):
    BLOCK
functools.partial(run@, 1)()
---
if (one@ := 1) and one@ > 0:
    BLOCK
---
def run@():
    BLOCK
class Run@:
    def __init__(self):
        for name in ("run", "stop"):
            setattr(self, name, run@ if name == "run" else print)
Run@().run()
---
def run@():
    BLOCK
globals()["call@"] = run@
call@()
---
if __name__ == "__main__":
    BLOCK
---
try:
    try:
        raise KeyError("x")
    except ValueError:
        pass
    finally:
        BLOCK
except KeyError:
    pass
---
with threading.Lock(), contextlib.nullcontext():
    BLOCK
---
@contextlib.contextmanager
def run@():
    BLOCK
    yield
with run@():
    pass
---
with contextlib.ExitStack() as stack@:
    BLOCK
---
def run@():
    BLOCK
list(map(lambda function: function(), [run@]))
---
def run@():
    BLOCK
queue@ = [run@]
while queue@:
    queue@.pop(0)()
---
class Run@:
    pass
def run@(self):
    BLOCK
Run@.run = run@
Run@().run()
---
class Run@:
    def setup_a(self):
        BLOCK
    def run(self, kind):
        getattr(self, f"setup_{kind}")()
Run@().run("a")
---
class Run@:
    def run(self):
        BLOCK
type(Run@()).run(None)
---
class A@:
    def run(self):
        pass
class B@(A@):
    def run(self):
        BLOCK
for one@ in (A@, B@):
    one@().run()
---
class Run@:
    def __init__(self):
        self.actions = {"a": self.make}
    def make(self):
        BLOCK
    def run(self):
        for name, action in self.actions.items():
            action()
Run@().run()
---
class Run@:
    def __init__(self):
        self.listeners = []
    def add(self, listener):
        self.listeners.append(listener)
    def fire(self):
        for listener in self.listeners:
            listener(self)
def run@(_):
    BLOCK
owner@ = Run@()
owner@.add(run@)
owner@.fire()
---
def run@():
    BLOCK
globals()["run@"]()
---
def run@():
    BLOCK
getattr(sys.modules[__name__], "run@", run@)()
---
def run@(value):
    BLOCK
    return value
run@(1) and run@(1)
---
def run@():
    BLOCK
with concurrent.futures.ThreadPoolExecutor() as pool@:
    pool@.submit(run@).result()
---
async def run@():
    BLOCK
coroutine@ = run@()
try:
    coroutine@.send(None)
except StopIteration:
    pass
---
class Run@:
    def __init__(self, function):
        function()
@Run@
def run@():
    BLOCK
---
class Run@:
    def __enter__(self):
        BLOCK
        return self
    def __exit__(self, *error):
        return True
with Run@() as run@:
    raise ValueError("x")
---
class Run@:
    def __exit__(self, *error):
        BLOCK
    def __enter__(self):
        return self
with Run@():
    pass
---
def run@(step=0):
    while True:
        step += 1
        if step == 3:
            break
        elif step == 2:
            BLOCK
run@()
---
def run@():
    try:
        return 1
    finally:
        BLOCK
run@()
---
def run@(*functions, **named):
    for function in functions:
        function()
    named["last"]()
def block@():
    BLOCK
run@(print, last=block@)
---
def run@(depth):
    def inner():
        if depth:
            BLOCK
    return inner
run@(1)()
---
class Run@:
    _one = None
    @classmethod
    def get(cls):
        if cls._one is None:
            cls._one = cls()
            cls._one.setup()
        return cls._one
    def setup(self):
        BLOCK
Run@.get()
---
class Base@:
    kinds = []
    def __init_subclass__(cls):
        super().__init_subclass__()
        Base@.kinds.append(cls)
class Run@(Base@):
    def run(self):
        BLOCK
for kind@ in Base@.kinds:
    kind@().run()
"""
LATER_ROSPY = """def run@(event):
    BLOCK
rospy.Timer(rospy.Duration(0.01), run@, oneshot=True)
---
def run@():
    BLOCK
rospy.Timer(rospy.Duration(0.01), lambda event: run@(), oneshot=True)
---
def run@():
    BLOCK
RUNS@ = {"a": run@}
def later@(event):
    RUNS@["a"]()
rospy.Timer(rospy.Duration(0.01), later@, oneshot=True)
---
class Run@:
    def __init__(self):
        self.run = self.make
        rospy.Timer(rospy.Duration(0.01), self.later, oneshot=True)
    def later(self, event):
        self.run()
    def make(self):
        BLOCK
run@ = Run@()
---
def run@():
    BLOCK
threading.Timer(0.01, run@).start()
"""
LATER_RCLPY = """def run@():
    BLOCK
    timer@.cancel()
timer@ = node.create_timer(0.01, run@)
---
def run@():
    BLOCK
RUNS@ = {"a": run@}
def later@():
    timer@.cancel()
    RUNS@["a"]()
timer@ = node.create_timer(0.01, later@)
---
class Run@:
    def __init__(self):
        self.run = self.make
        self.timer = node.create_timer(0.01, self.later)
    def later(self):
        self.timer.cancel()
        self.run()
    def make(self):
        BLOCK
keep.append(Run@())
"""
DEAD = """if False:
    BLOCK
---
if keep is None:
    BLOCK
---
if 1 > 2 or not keep and keep:
    BLOCK
---
while False:
    BLOCK
---
for one@ in []:
    BLOCK
---
for one@ in range(3):
    if one@ >= 0:
        continue
    BLOCK
---
for one@ in "ab":
    if one@ == "a":
        break
else:
    BLOCK
---
while True:
    break
else:
    BLOCK
---
def run@():
    return
    BLOCK
run@()
---
def run@():
    BLOCK
---
class Run@:
    def run(self):
        BLOCK
Run@()
---
class Base@:
    def run(self):
        BLOCK
class Run@(Base@):
    def run(self):
        pass
Run@().run()
---
try:
    pass
except ValueError:
    BLOCK
---
try:
    raise KeyError("x")
    BLOCK
except KeyError:
    pass
---
try:
    raise KeyError("x")
except ValueError:
    BLOCK
except KeyError:
    pass
---
try:
    raise KeyError("x")
except KeyError:
    pass
else:
    BLOCK
---
match "a":
    case "b":
        BLOCK
---
match {"kind": "a"}:
    case {"kind": "b"}:
        BLOCK
---
def run@():
    BLOCK
{"a": run@, "b": print}["b"]()
---
def run@():
    BLOCK
keep is None and run@()
---
def run@():
    BLOCK
[run@() for one in [1] if one > 1]
---
if isinstance("a", int):
    BLOCK
---
if "a" in ("b", "c"):
    BLOCK
---
def run@():
    BLOCK
def run@():
    pass
run@()
---
class Run@:
    @property
    def run(self):
        BLOCK
Run@()
---
class Run@:
    run = None
    def __getattr__(self, name):
        BLOCK
Run@().run
---
class Run@:
    def __call__(self):
        BLOCK
Run@()
---
class Base@:
    def __init__(self):
        BLOCK
class Run@(Base@):
    def __init__(self):
        pass
Run@()
---
if one@ := 0:
    BLOCK
---
match 3:
    case int(one@) if one@ > 5:
        BLOCK
---
def run@():
    BLOCK
any(one or run@() for one in [1])
---
def run@():
    BLOCK
1 or run@()
---
def run@():
    BLOCK
    return 1
{"a": 1}.get("a", run@)
---
def run@():
    BLOCK
functools.partial(run@)
---
if [] or {} or "" or 0 or None:
    BLOCK
---
if not {"a": 1}.get("a"):
    BLOCK
---
def run@(flag=False):
    if flag:
        BLOCK
run@()
---
class Run@:
    flag = False
    def run(self):
        if self.flag:
            BLOCK
Run@().run()
---
def run@():
    for one in "ab":
        return
    BLOCK
run@()
---
def run@():
    try:
        raise KeyError("x")
    finally:
        return
    BLOCK
run@()
---
class Run@(Exception):
    pass
try:
    raise Run@()
except ValueError:
    BLOCK
except Run@:
    pass
"""
