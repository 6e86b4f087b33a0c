"""Launch files made up by hypothesis: valid for roslaunch but for names that meet by chance.

A launch is a mapping of file names to texts; `app.launch` is the root, and every other file is
included from one before it.
"""

from dataclasses import dataclass, field

from hypothesis import strategies as st

NAMES = ("a", "b", "/a", "/b", "~a", "g/a", "/g/a", "a/b", "/n1/a")
NAMESPACES = ("g", "/g", "g/h", "/")
VALUES = ("g", "h", "true", "false", "1")
BOOLEANS = ("true", "false", "1", "0", "$(arg flag)", "$(eval arg('flag'))")
MAX_FILES = 4


@dataclass
class Files:
    """The files of one launch while they are being made; node names are unique over all."""

    texts: dict = field(default_factory=dict)
    nodes: int = 0

    def node_name(self):
        self.nodes += 1
        return f"n{self.nodes}"


@st.composite
def launches(draw):
    files = Files()
    write_file(draw, files, "app.launch")
    return files.texts


def write_file(draw, files, name):
    files.texts[name] = ""
    head = '<launch>\n  <arg name="flag" default="true"/>\n  <arg name="x" default="g"/>\n'
    files.texts[name] = head + elements(draw, files, depth=1) + "</launch>\n"


def elements(draw, files, depth):
    kinds = st.sampled_from([node, node, remap, group, include] if depth < 4 else [node, remap])
    chosen = draw(st.lists(kinds, max_size=4))
    return "".join("  " * depth + kind(draw, files, depth) + "\n" for kind in chosen)


def node(draw, files, depth):
    name = files.node_name()
    if draw(st.integers(0, 4)) == 0:
        name = f"$(anon {name})"
    inside = "".join(remap(draw, files, depth) for _ in range(draw(st.integers(0, 2))))
    args = draw(st.sampled_from(["", ' args="$(dirname)/$(arg x)"', " args='$(eval dirname())'"]))
    start = f'<node pkg="p" type="t" name="{name}"{args}{namespace(draw)}{condition(draw)}'
    comment = draw(st.sampled_from(["", "<!-- one -->", "\n"]))
    return f"{start}>{comment}{inside}</node>" if inside or comment else f"{start}/>"


def remap(draw, files, depth):
    names = st.sampled_from(NAMES)
    return f'<remap from="{draw(names)}" to="{draw(names)}"{condition(draw)}/>'


def group(draw, files, depth):
    inside = elements(draw, files, depth + 1)
    return f"<group{namespace(draw)}{condition(draw)}>\n{inside}{'  ' * depth}</group>"


def include(draw, files, depth):
    """Include a new file or one that includes nothing of us: there are no cycles."""
    if len(files.texts) >= MAX_FILES:
        return "<!-- enough -->"
    name = f"sub{len(files.texts)}.launch"
    write_file(draw, files, name)
    passed = draw(st.sampled_from(["", '<arg name="x" value="$(arg x)"/>', "all"]))
    start = f'<include file="$(dirname)/{name}"{namespace(draw)}{condition(draw)}'
    if passed == "all":
        return f'{start} pass_all_args="true"/>'
    return f"{start}>{passed}</include>" if passed else f"{start}/>"


def namespace(draw):
    chosen = draw(st.sampled_from([*NAMESPACES, "$(arg x)", None, None, None]))
    return "" if chosen is None else f' ns="{chosen}"'


def condition(draw):
    chosen = draw(st.sampled_from([*BOOLEANS, None, None, None, None, None, None]))
    return "" if chosen is None else f' {draw(st.sampled_from(["if", "unless"]))}="{chosen}"'
