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
"""
