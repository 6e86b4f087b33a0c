"""Launch files made up by hypothesis that set parameters in every way."""

import json

from hypothesis import strategies as st

NAMES = ("a", "b", "/a", "/b", "a/b", "g/a", "/g/a", "n1/a", "/n1/a", "a//b/")
PRIVATE = ("~a", "~b", "~a/b", "~/a")
NAMESPACES = ("g", "/g", "g/h", "/", "$(arg x)")
VALUES = ("1", "1.5", "true", "text", "", "$(arg x)", "1_0", "a.b")
KEYS = ("a", "b", "a/b", "/a", "~a")
MAX_FILES = 4

scalars = st.one_of(
    st.booleans(), st.integers(-(2**31), 2**31 - 1), st.sampled_from(["x", "", "1", "deg(90)"])
)
values = st.recursive(
    scalars,
    lambda inner: st.one_of(
        st.lists(inner, max_size=2),
        st.dictionaries(st.sampled_from([*KEYS, ""]), inner, max_size=3),
    ),
    max_leaves=5,
)
maps = st.dictionaries(st.sampled_from(KEYS), values, max_size=3)


@st.composite
def launches_with_parameters(draw):
    files = {}
    write_file(draw, files, "app.launch")
    return files


def write_file(draw, files, name):
    files[name] = ""
    body = elements(draw, files, depth=1)
    files[name] = f'<launch><arg name="x" default="g"/>{body}</launch>'


def elements(draw, files, depth):
    kinds = [param, private, rosparam, node, group, include]
    chosen = draw(st.lists(st.sampled_from(kinds if depth < 4 else kinds[:4]), max_size=5))
    return "\n".join(kind(draw, files, depth) for kind in chosen)


def param(draw, files, depth):
    name, value = draw(st.sampled_from(NAMES)), draw(st.sampled_from(VALUES))
    return f'<param name="{name}" value="{value}"{condition(draw)}/>'


def private(draw, files, depth):
    name, value = draw(st.sampled_from(PRIVATE)), draw(st.sampled_from(VALUES))
    return f'<param name="{name}" value="{value}"{condition(draw)}/>'


def rosparam(draw, files, depth):
    name = draw(st.sampled_from([None, None, *NAMES, *PRIVATE]))
    where = "" if name is None else f' {draw(st.sampled_from(["ns", "param"]))}="{name}"'
    text = json.dumps(draw(maps if name is None else values)).replace("null", "x")
    if draw(st.booleans()):
        return f"<rosparam{where}{condition(draw)}><![CDATA[{text}]]></rosparam>"
    file = f"params{len(files)}.yaml"
    files[file] = text
    return f'<rosparam file="$(dirname)/{file}"{where}{condition(draw)}/>'


def node(draw, files, depth):
    number = sum(text.count("<node") for text in files.values())
    files[f"number{len(files)}"] = "<node"
    name = draw(st.sampled_from([f"n{number}", f"n{number}", f"$(anon n{number})"]))
    kinds = st.sampled_from([param, private, rosparam])
    inside = "".join(kind(draw, files, depth) for kind in draw(st.lists(kinds, max_size=3)))
    clears = draw(st.sampled_from(["", "", ' clear_params="true"']))
    start = f'<node pkg="p" type="t" name="{name}"{clears}{namespace(draw)}{condition(draw)}'
    return f"{start}>{inside}</node>"


def group(draw, files, depth):
    inside = elements(draw, files, depth + 1)
    return f"<group{namespace(draw)}{condition(draw)}>{inside}</group>"


def include(draw, files, depth):
    name = f"sub{len(files)}.launch"
    if sum(file.endswith(".launch") for file in files) >= MAX_FILES:
        return ""
    write_file(draw, files, name)
    return f'<include file="$(dirname)/{name}"{namespace(draw)}{condition(draw)}/>'


def namespace(draw):
    chosen = draw(st.sampled_from([*NAMESPACES, None, None, None]))
    return "" if chosen is None else f' ns="{chosen}"'


def condition(draw):
    return draw(st.sampled_from(["", "", "", ' if="true"', ' if="0"', ' unless="$(eval 1)"']))
