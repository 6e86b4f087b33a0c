"""Ways in which a Python program arrives at a name; the last line of each is the expression.

NAME is the name as a literal, HEAD and TAIL its two halves, UPPER its upper case, NUMBER and WORD
what it is made of (`t012_word`); `@` makes a program's variables its own.
"""

PLAIN = """NAME
---
HEAD + TAIL
---
"t%03d_%s" % (NUMBER, WORD)
---
"%(head)s%(tail)s" % {"head": HEAD, "tail": TAIL}
---
"t{:03d}_{}".format(NUMBER, WORD)
---
"{0}{1}".format(HEAD, TAIL)
---
"{a}{b[x]}".format(a=HEAD, b={"x": TAIL})
---
"".join([HEAD, TAIL])
---
number@, word@ = NUMBER, WORD
f"t{number@:03d}_{word@}"
---
word@ = WORD
f"{HEAD}{word@!s}"
---
UPPER.lower()
---
(" " + NAME + " ").strip()
---
("wrong." + NAME).split(".")[-1]
---
("x/" + NAME).rpartition("/")[2]
---
("xx" + NAME)[2:]
---
NAME[::-1][::-1]
---
NAME.replace("zz", "y")
---
NAME.ljust(3).center(2)
---
os.path.basename("/wrong/" + NAME)
---
os.path.splitext(NAME + ".wrong")[0]
---
str(pathlib.PurePath("/wrong", NAME).name)
---
"t" + str(NUMBER).zfill(3) + "_" + WORD
---
text@ = HEAD
text@ += TAIL
text@
---
NAME if NUMBER >= 0 else "wrong"
---
None or NAME
---
"" or HEAD and NAME
---
functools.reduce(lambda a, b: a + b, [HEAD, TAIL])
---
string.Template("${a}$b").substitute(a=HEAD, b=TAIL)
"""
CONTAINERS = """{"k": NAME, "l": "wrong"}["k"]
---
config@ = {"topics": [{"name": "wrong"}, {"name": NAME}]}
config@["topics"][1]["name"]
---
["wrong", NAME][1]
---
("wrong", NAME)[-1]
---
first@, *rest@ = ["wrong", NAME, "other"]
rest@[0]
---
a@, (b@, c@) = "wrong", (NAME, "other")
b@
---
dict(a="wrong", b=NAME)["b"]
---
dict([("a", NAME)])["a"]
---
dict(zip(["a", "b"], ["wrong", NAME]))["b"]
---
{key: value for key, value in [("a", "wrong"), ("b", NAME)]}["b"]
---
{**{"a": "wrong"}, **{"a": NAME}}["a"]
---
map@ = {"a": "wrong"}
map@.update({"a": NAME})
map@["a"]
---
map@ = {"a": "wrong"}
map@.update([("a", NAME)])
map@["a"]
---
map@ = {}
map@.setdefault("a", NAME)
map@.pop("a")
---
{"a": NAME}.copy().get("a", "wrong")
---
copy.deepcopy({"a": [NAME]})["a"][0]
---
collections.OrderedDict([("a", NAME)])["a"]
---
map@ = collections.defaultdict(list)
map@["a"].append(NAME)
map@["a"][0]
---
collections.defaultdict(lambda: NAME)["a"]
---
queue@ = collections.deque([NAME, "wrong"])
queue@.popleft()
---
list@ = ["wrong"]
list@.insert(0, NAME)
list@[0]
---
list@ = [NAME]
other@ = list@
other@ += ["wrong"]
list@.index("wrong") and list@[0]
---
list@ = []
other@ = list@
other@ += [NAME]
list@[0]
---
(["wrong"] + [NAME])[1]
---
sorted(["zzz", NAME])[0]
---
max(["x", NAME], key=len)
---
[one for one in ["wrong", NAME] if one.startswith("t0") or one.startswith("t1")][0]
---
list(filter(lambda one: one != "wrong", ["wrong", NAME]))[0]
---
list(map(lambda a, b: a + b, [HEAD], [TAIL]))[0]
---
[a + b for a in [HEAD] for b in [TAIL]][0]
---
next(iter([NAME, "wrong"]))
---
next(one for one in ["wrong", NAME] if one != "wrong")
---
list(reversed([NAME, "wrong"]))[1]
---
[name for index, name in enumerate(["wrong", NAME]) if index == 1][0]
---
({"wrong"} - {"wrong"} | {NAME}).pop()
---
(frozenset(["wrong", NAME]) - frozenset(["wrong"])).__iter__().__next__()
---
json.loads('{"a": ' + json.dumps(NAME) + '}')["a"]
---
yaml.safe_load("a: [wrong, " + NAME + "]")["a"][1]
---
{(1, 2): NAME, (2, 1): "wrong"}[1, 2]
---
{int: "wrong", str: NAME}[str]
---
list(itertools.chain(["wrong"], [NAME]))[1]
---
list(itertools.islice(["wrong", NAME, "other"], 1, 2))[0]
---
operator.itemgetter("a")({"a": NAME})
---
types.SimpleNamespace(a=NAME).a
---
Row@ = collections.namedtuple("Row", "kind name")
Row@("wrong", NAME).name
---
Row@ = collections.namedtuple("Row", ["kind", "name"])
kind@, name@ = Row@(name=NAME, kind="wrong")
name@
"""
FUNCTIONS = """def name@():
    return NAME
name@()
---
def name@(text=NAME):
    return text
name@()
---
def name@(a, b=TAIL):
    return a + b
name@(HEAD)
---
def name@(*parts, **more):
    return "".join(parts) + more["tail"]
name@(*[HEAD], **{"tail": TAIL})
---
def name@(a, *, b):
    return a + b
name@(HEAD, b=TAIL)
---
(lambda a, b: a + b)(HEAD, TAIL)
---
functools.partial(lambda a, b: a + b, HEAD)(TAIL)
---
def outer@(a):
    def inner@(b):
        return a + b
    return inner@
outer@(HEAD)(TAIL)
---
def outer@():
    text@ = "wrong"
    def inner@():
        nonlocal text@
        text@ = NAME
    inner@()
    return text@
outer@()
---
def set@():
    global text@
    text@ = NAME
set@()
text@
---
def set@():
    globals()["text@"] = NAME
set@()
text@
---
def name@():
    text = NAME
    locals()["text"] = "wrong"
    return text
name@()
---
def name@():
    if (text := NAME) and len(text) > 1:
        return text
    return "wrong"
name@()
---
def name@(wrong):
    return wrong and (text := NAME) and text
name@(True)
---
def names@():
    yield "wrong"
    yield NAME
list(names@())[1]
---
def names@():
    yield from [NAME, "wrong"]
next(names@())
---
def name@():
    for text in ["wrong", NAME, "other"]:
        if text == NAME:
            break
    else:
        text = "wrong"
    return text
name@()
---
def name@():
    text = "wrong"
    for text in ["wrong"]:
        pass
    else:
        text = NAME
    return text
name@()
---
def name@():
    try:
        return {}["missing"]
    except KeyError:
        return NAME
name@()
---
def name@():
    try:
        raise ValueError("wrong")
    except (TypeError, ValueError) as error:
        text = NAME
    finally:
        done = True
    return text
name@()
---
def name@():
    text = NAME
    wrong = [text for text in ["wrong"]]
    return text
name@()
---
def name@(kind):
    match kind:
        case "a":
            return "wrong"
        case "b" | "c":
            return NAME
        case _:
            return "other"
name@("b")
---
def name@(config):
    match config:
        case {"kind": "wrong", "name": text}:
            return "wrong"
        case {"kind": "right", "name": text}:
            return text
name@({"kind": "right", "name": NAME})
---
def name@(config):
    match config:
        case [text]:
            return "wrong"
        case ["x", text]:
            return text
name@(["x", NAME])
---
def name@(count):
    return NAME if count == 0 else name@(count - 1)
name@(2)
---
@functools.lru_cache(maxsize=None)
def name@():
    return NAME
name@()
---
def twice@(function):
    @functools.wraps(function)
    def wrapper(*args, **kwargs):
        return function(*args, **kwargs) + TAIL
    return wrapper
@twice@
def name@():
    return HEAD
name@()
---
@contextlib.contextmanager
def name@():
    yield NAME
with name@() as text@:
    pass
text@
---
def name@():
    count, text = 3, "wrong"
    while count:
        count -= 1
        if count == 1:
            text = NAME
    return text
name@()
"""
CLASSES = """class Names@:
    text = NAME
Names@.text
---
class Names@:
    text = "wrong"
    def __init__(self):
        self.text = NAME
Names@().text
---
class Names@:
    def __init__(self, head):
        self.head = head
    @property
    def text(self):
        return self.head + TAIL
Names@(HEAD).text
---
class Names@:
    def __init__(self):
        self._text = "wrong"
    @property
    def text(self):
        return self._text
    @text.setter
    def text(self, value):
        self._text = value
one@ = Names@()
one@.text = NAME
one@.text
---
class Names@:
    def get(self):
        return NAME
    text = property(get)
Names@().text
---
class Names@:
    @functools.cached_property
    def text(self):
        return NAME
Names@().text
---
class Names@:
    @staticmethod
    def text(head):
        return head + TAIL
Names@.text(HEAD)
---
class Names@:
    tail = TAIL
    @classmethod
    def text(cls, head):
        return head + cls.tail
Names@().text(HEAD)
---
class Base@:
    tail = "wrong"
    def text(self):
        return HEAD + self.tail
class Names@(Base@):
    tail = TAIL
Names@().text()
---
class Base@:
    def text(self):
        return HEAD
class Names@(Base@):
    def text(self):
        return super().text() + TAIL
Names@().text()
---
class First@:
    def text(self):
        return NAME
class Second@:
    def text(self):
        return "wrong"
class Names@(First@, Second@):
    pass
Names@().text()
---
class Names@:
    def __init__(self, **kwargs):
        self.text = "wrong"
        self.__dict__.update(kwargs)
Names@(text=NAME).text
---
class Names@:
    def __init__(self, **kwargs):
        self.text = "wrong"
        vars(self).update(kwargs)
Names@(text=NAME).text
---
class Names@:
    def __init__(self, **kwargs):
        self.text = "wrong"
        for key, value in kwargs.items():
            setattr(self, key, value)
getattr(Names@(text=NAME), "text")
---
class Names@:
    def __init__(self):
        self.text = "wrong"
        self.__dict__["text"] = NAME
Names@().text
---
class Names@:
    def __getattr__(self, name):
        return NAME
Names@().text
---
class Names@:
    def __getitem__(self, key):
        return HEAD + key
Names@()[TAIL]
---
class Names@:
    def __call__(self, tail):
        return HEAD + tail
Names@()(TAIL)
---
class Names@:
    def __str__(self):
        return NAME
str(Names@())
---
class Names@:
    def __str__(self):
        return HEAD
f"{Names@()}{TAIL}"
---
class Names@:
    def __add__(self, other):
        return HEAD + other
Names@() + TAIL
---
class Names@:
    def __iter__(self):
        return iter(["wrong", NAME])
list(Names@())[1]
---
class Names@:
    def __enter__(self):
        return NAME
    def __exit__(self, *error):
        return False
with Names@() as text@:
    pass
text@
---
class Names@:
    def __get__(self, owner, cls):
        return NAME
class Owner@:
    text = Names@()
Owner@().text
---
class Base@:
    def __init__(self):
        self.__text = NAME
    def text(self):
        return self.__text
class Names@(Base@):
    def __init__(self):
        super().__init__()
        self.__text = "wrong"
Names@().text()
---
word@ = NAME
class Names@:
    word@ = "wrong"
    def text(self):
        return word@
Names@().text()
---
class Builder@:
    def __init__(self):
        self.parts = []
    def add(self, part):
        self.parts.append(part)
        return self
    def text(self):
        return "".join(self.parts)
Builder@().add(HEAD).add(TAIL).text()
---
@dataclasses.dataclass
class Names@:
    head: str
    tail: str = TAIL
    text: str = dataclasses.field(init=False, default="wrong")
    def __post_init__(self):
        self.text = self.head + self.tail
Names@(HEAD).text
---
@dataclasses.dataclass
class Names@:
    texts: list = dataclasses.field(default_factory=list)
one@, two@ = Names@(), Names@()
one@.texts.append(NAME)
two@.texts.append("wrong")
one@.texts[0]
---
class Names@(enum.Enum):
    WRONG = "wrong"
    RIGHT = NAME
Names@.RIGHT.value
---
class Names@(enum.Enum):
    WRONG = "wrong"
    RIGHT = NAME
Names@["RIGHT"].value
---
class Names@(enum.Enum):
    A = 1
    B = 2
{Names@.A: "wrong", Names@.B: NAME}[Names@.B]
---
class Names@(typing.NamedTuple):
    head: str
    tail: str = TAIL
row@ = Names@(HEAD)
row@.head + row@.tail
---
class Base@:
    registry = {}
    def __init_subclass__(cls, **kwargs):
        Base@.registry[kwargs["key"]] = cls
class Names@(Base@, key="a"):
    text = NAME
Base@.registry["a"].text
---
class Names@:
    one = None
    def __new__(cls):
        if cls.one is None:
            cls.one = super().__new__(cls)
            cls.one.text = NAME
        return cls.one
Names@().text
---
Names@ = type("Names", (), {"text": NAME})
Names@().text
---
def make@(text):
    class Made:
        name = text
    return Made
make@(NAME)().name
"""
ROSPY = """rospy.get_param("~unset@", NAME)
---
rospy.get_param("~unset@", {"a": NAME})["a"]
---
rospy.remap_name(NAME)
"""
RCLPY = """node.declare_parameter("unset@", NAME).value
---
node.declare_parameter("unset@", NAME)
node.get_parameter("unset@").get_parameter_value().string_value
---
[p@.value for p@ in node.declare_parameters("", [("unset@", NAME)])][0]
"""
