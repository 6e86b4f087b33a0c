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
---
map@ = {"k": TAIL}
f"{HEAD}{map@['k']}"
---
f"{HEAD + TAIL}"
---
f"{HEAD if NUMBER else 'wrong'}{TAIL:s}"
---
width@ = 3
f"t{NUMBER:0{width@}d}_{WORD}"
---
"{:>{}}".format(NAME, 2)
---
"{0.tail}{1[0]}".format(types.SimpleNamespace(tail=HEAD), [TAIL])
---
"t%s_%s" % (str(NUMBER).rjust(3, "0"), WORD)
---
"".join(map(str, [HEAD, TAIL]))
---
"".join(part for part in (HEAD, TAIL))
---
NAME.encode().decode("utf-8")
---
("%s" % NAME).title().lower()
---
NAME[:2] + NAME[2:]
---
("wrong " + NAME).split()[1]
---
NAME.removeprefix("x").removesuffix("y")
---
["wrong", NAME][(1 + 2 * 3) % 2 ** 1 + 0 // 1]
---
["wrong", NAME][1 << 0]
---
["wrong", NAME][divmod(7, 3)[1]]
---
["wrong", NAME][~-2]
---
["wrong", NAME][int("1")]
---
["wrong", NAME][bool([0])]
---
["wrong", NAME][len("a" * 3) - 2]
---
["wrong", NAME][round(0.6) if isinstance(2, (int, float)) else 0]
---
NAME if hasattr("a", "upper") and not hasattr("a", "wrong") else "wrong"
---
NAME if callable(len) and not callable("a") else "wrong"
---
NAME if [1, 2] == [1, 2] and (1,) != (2,) and {1: 2} == {1: 2} else "wrong"
---
NAME if any(x > 1 for x in (1, 2)) and all(x > 0 for x in (1, 2)) else "wrong"
---
NAME if "a" < "b" < "c" and "z" not in "abc" else "wrong"
---
NAME if type("a") is str else "wrong"
---
NAME if isinstance("a", str) and not isinstance(None, str) else "wrong"
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
---
Row@ = collections.namedtuple("Row", "kind name")
Row@("x", "wrong")._replace(name=NAME)._asdict()["name"]
---
list@ = ["b", NAME, "a"]
list@.remove("b")
list@.reverse()
list@.pop()
---
list@ = ["wrong", "x"]
list@[0:1] = [NAME]
list@[0]
---
list@ = ["wrong"] * 2
list@[-1] = NAME
list@[1]
---
list@ = ["zz", NAME]
list@.sort(reverse=True)
list@[1]
---
list@ = sorted([("b", "wrong"), ("a", NAME)], key=lambda pair: pair[0])
list@[0][1]
---
map@ = {"a": "wrong"}
map@ |= {"a": NAME}
map@["a"]
---
({"a": "wrong"} | {"a": NAME})["a"]
---
map@ = {"a": {"b": []}}
map@["a"]["b"].append(NAME)
map@["a"]["b"][0]
---
map@ = {"b": "wrong", "a": NAME}
[map@[key] for key in sorted(map@)][0]
---
map@ = {"a": NAME}
key@, text@ = map@.popitem()
text@
---
map@ = {"a": "wrong", "b": NAME}
del map@["a"]
list(map@.values())[0]
---
dict.fromkeys(["a"], NAME)["a"]
---
{value: key for key, value in {NAME: "a"}.items()}["a"]
---
set@ = {"wrong"}
set@ |= {NAME}
set@.discard("wrong")
list(set@)[0]
---
{"wrong", NAME}.difference({"wrong"}).pop()
---
{"x", NAME}.intersection([NAME, "y"]).pop()
---
deque@ = collections.deque(["x"])
deque@.appendleft(NAME)
deque@[0]
---
a@ = b@ = []
a@.append(NAME)
b@[0]
---
(a@, b@), c@ = ["wrong", NAME], "other"
b@
---
*_, last@ = ("wrong", "other", NAME)
last@
---
[pair[1] for pair in zip("ab", ["wrong", NAME]) if pair[0] == "b"][0]
---
[name for index, (key, name) in enumerate([("a", "wrong"), ("b", NAME)], start=1) if index == 2][0]
---
[["wrong", NAME][index] for index in range(1, -1, -1)][0]
---
[a + b for a, b in itertools.product([HEAD], ["zzz", TAIL])][1]
---
functools.reduce(lambda made, key: made[key], ["a", 0], {"a": [NAME]})
---
min([NAME, "zzzz"])
---
next(filter(None, ["", NAME]))
---
next((one for one in [] if one), NAME)
---
iterator@ = iter(["wrong", NAME])
next(iterator@)
next(iterator@)
---
list(dict.fromkeys([NAME, NAME]))[0]
---
list(zip(*[("wrong", "x"), (NAME, "y")]))[0][1]
---
list(itertools.chain.from_iterable([["wrong"], [NAME]]))[1]
---
ast.literal_eval("['wrong', '" + NAME + "']")[1]
---
collections.ChainMap({"a": NAME}, {"a": "wrong"})["a"]
---
types.MappingProxyType({"a": NAME})["a"]
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
---
def add@(text, made=[]):
    made.append(text)
    return made
add@("wrong")
add@(NAME)[1]
---
functions@ = [lambda: text for text in ["wrong", NAME]]
functions@[0]()
---
functions@ = []
for text@ in [NAME, "wrong"]:
    functions@.append(lambda text=text@: text)
functions@[0]()
---
def count@():
    number = 0
    def step():
        nonlocal number
        number += 1
        return number
    return step
step@ = count@()
step@()
["x", "wrong", NAME][step@()]
---
def name@():
    return "wrong"
def name@():
    return NAME
name@()
---
def name@():
    try:
        return NAME
    finally:
        text = "wrong"
name@()
---
def name@():
    try:
        try:
            raise KeyError("x")
        finally:
            text = NAME
    except KeyError:
        return text
name@()
---
class Wrong@(Exception):
    pass
class Worse@(Wrong@):
    pass
def name@():
    try:
        raise Worse@()
    except KeyError:
        return "wrong"
    except Wrong@:
        return NAME
name@()
---
def name@():
    for a in "ab":
        for b in "ab":
            if b == "a":
                continue
            if a == "b":
                return NAME
            break
    return "wrong"
name@()
---
def name@(value):
    if isinstance(value, dict):
        return name@(value["a"])
    elif isinstance(value, (list, tuple)):
        return name@(value[0])
    return value
name@({"a": [NAME]})
---
def name@(a, b="wrong", *args, c="wrong", **kwargs):
    return a + c
name@(HEAD, "x", "y", c=TAIL, d="z")
---
def name@(a, b):
    return a + b
name@(b=TAIL, a=HEAD)
---
def name@(*args):
    first, *rest = args
    return rest[0]
name@("wrong", NAME)
---
list = ["wrong", NAME]
text@ = list[1]
del list
text@
---
def name@():
    str = NAME
    return str
name@()
---
def name@():
    import json as other
    return other.loads('["' + NAME + '"]')[0]
name@()
---
def name@():
    if typing.TYPE_CHECKING:
        return "wrong"
    return NAME
name@()
---
def outer@(function):
    return lambda *args, **kwargs: function(*args, **kwargs)
@outer@
@outer@
def name@(a, b=TAIL):
    return a + b
name@(HEAD)
---
parser@ = argparse.ArgumentParser()
parser@.add_argument("--topic", default=NAME)
parser@.parse_args([]).topic
---
def name@(point):
    match point:
        case int() | float():
            return "wrong"
        case str(text) if text.startswith("x"):
            return "wrong"
        case str(text):
            return text
name@(NAME)
---
def name@(point):
    match point:
        case {"a": [_, {"b": text}], **rest}:
            return text
        case _:
            return "wrong"
name@({"a": [1, {"b": NAME}], "c": 2})
---
def name@(point):
    match point:
        case (first, *middle, last) if last == "wrong":
            return first
name@([NAME, "x", "wrong"])
---
def name@(text):
    text += TAIL
    return text
name@(HEAD)
---
(lambda *args, **kwargs: args[0] + kwargs["b"])(HEAD, b=TAIL)
---
def names@(depth):
    if depth:
        yield from names@(depth - 1)
    yield NAME
list(names@(1))[0]
---
def name@():
    number = 10
    while number > 0:
        number -= 3
        if number < 2:
            break
    else:
        return "wrong"
    return NAME
name@()
---
try:
    text@ = int("x")
except ValueError:
    text@ = NAME
text@
---
try:
    text@ = ["wrong"][5]
except IndexError:
    text@ = NAME
text@
---
try:
    text@ = None.upper()
except AttributeError:
    text@ = NAME
text@
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
---
class Names@:
    count = 0
    def __init__(self):
        Names@.count += 1
        self.text = ["wrong", NAME, "wrong"][Names@.count]
Names@().text
---
class Outer@:
    class Inner:
        text = NAME
Outer@.Inner.text
---
class Names@:
    texts = {}
    for key@ in ("a", "b"):
        texts[key@] = "wrong" if key@ == "a" else NAME
Names@.texts["b"]
---
class Names@:
    __slots__ = ("text",)
    def __init__(self, text):
        self.text = text
Names@(NAME).text
---
class Names@:
    def __init__(self, text):
        self.text = text
    @classmethod
    def of(cls, *parts):
        return cls("".join(parts))
Names@.of(HEAD, TAIL).text
---
class Base@:
    @property
    def tail(self):
        return "wrong"
    def text(self):
        return HEAD + self.tail
class Names@(Base@):
    @property
    def tail(self):
        return TAIL
Names@().text()
---
class Base@(abc.ABC):
    @abc.abstractmethod
    def tail(self):
        pass
    def text(self):
        return HEAD + self.tail()
class Names@(Base@):
    def tail(self):
        return TAIL
Names@().text()
---
class A@:
    def parts(self):
        return [HEAD]
class B@(A@):
    def parts(self):
        return super().parts() + ["x"]
class C@(A@):
    def parts(self):
        return super().parts() + [TAIL]
class D@(B@, C@):
    pass
"".join(D@().parts()[:2])
---
class Names@:
    def text(self, tail):
        return HEAD + tail
    short = text
Names@().short(TAIL)
---
class Names@:
    def text(self, head, tail):
        return head + tail
    short = functools.partialmethod(text, HEAD)
Names@().short(TAIL)
---
class Names@:
    def text(self, tail):
        return HEAD + tail
method@ = Names@().text
list(map(method@, [TAIL]))[0]
---
class Names@:
    pass
one@ = Names@()
one@.text = "wrong"
two@ = one@
two@.text = NAME
one@.text
---
class Names@:
    def __eq__(self, other):
        return True
NAME if Names@() == Names@() else "wrong"
---
class Names@:
    def __bool__(self):
        return False
"wrong" if Names@() else NAME
---
class Names@:
    def __len__(self):
        return 0
"wrong" if Names@() else NAME
---
class Names@:
    def __contains__(self, key):
        return key == "a"
NAME if "a" in Names@() else "wrong"
---
class Names@:
    def __next__(self):
        return NAME
    def __iter__(self):
        return self
next(Names@())
---
class Names@(dict):
    pass
one@ = Names@()
one@["a"] = NAME
one@["a"]
---
class Names@(list):
    pass
one@ = Names@()
one@.append(NAME)
one@[0]
---
class Names@(str):
    pass
Names@(NAME)
---
@dataclasses.dataclass
class Base@:
    head: str
@dataclasses.dataclass
class Names@(Base@):
    tail: str = TAIL
    kind: typing.ClassVar[str] = "wrong"
    def text(self):
        return self.head + self.tail
Names@(HEAD).text()
---
@dataclasses.dataclass(frozen=True)
class Names@:
    text: str = "wrong"
dataclasses.replace(Names@(), text=NAME).text
---
@dataclasses.dataclass
class Names@:
    a: str
    b: str = NAME
dataclasses.asdict(Names@("wrong"))["b"]
---
class Names@(enum.IntEnum):
    A = 0
    B = 1
["wrong", NAME][Names@.B]
---
class Names@(enum.Enum):
    A = enum.auto()
    B = enum.auto()
[NAME, "wrong"][[one.name for one in Names@].index("A")]
---
class Names@(str, enum.Enum):
    A = NAME
Names@.A.value
---
class Names@(enum.Enum):
    A = NAME
Names@(NAME).value
---
class Names@:
    @staticmethod
    def _text():
        return NAME
    TEXTS = {"a": _text}
Names@.TEXTS["a"]()
---
class Names@:
    def __init__(self, **texts):
        self.__dict__.update(texts)
    def __getattr__(self, name):
        return "wrong"
Names@(text=NAME).text
---
Names@().text if "Names@" in globals() else NAME
---
class Base@:
    def __init__(self, **kwargs):
        for key, value in kwargs.items():
            setattr(self, "_" + key, value)
class Names@(Base@):
    def __init__(self, text):
        super().__init__(text=text)
Names@(NAME)._text
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
