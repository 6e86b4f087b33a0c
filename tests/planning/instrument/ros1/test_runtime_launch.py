"""Guarding launch files that nodes start themselves, with no ROS: what is copied, linked, said."""

import os
import subprocess
from pathlib import Path

import pytest
from file_tree import write
from plans import grcn, plan_of
from roslaunch_oracle import package

from rtron.errors import InputError
from rtron.planning.instrument import RuntimeLaunchTree, instrument_ros1, write_guarded_launch
from rtron.planning.instrument.common.guarded_launch import GuardFiles
from rtron.planning.instrument.ros1.runtime_launch import find_scripts, starter_script
from rtron.sources.launch.common.packages import find_packages
from rtron.sources.launch.ros1.reader import read_launch
from rtron.vocabulary import Evidence, LaunchNode

T = "/cmd_vel"
PLAN = plan_of(grcn(T, ["/a", "/b"], ["/c"]))
NODE = '<node pkg="nodes" type="t" name="{}"/>'
BODY = '<node pkg="core" type="start" name="start"/>' + NODE.format("c")
FILES = {
    "ws/core/package.xml": package("core"),
    "ws/core/nodes/start": "#!/usr/bin/python3\nimport starting\nprint(__file__)\n",
    "ws/core/nodes/starting.py": "TEXT = __file__\n",
    "ws/core/nodes/other.py": "",
    "ws/core/app.launch": f"<launch>{BODY}</launch>",
    "ws/nav/package.xml": package("nav"),
    "ws/nav/map.yaml": "map",
    "ws/nav/launch/a.launch": f"<launch>\n  <!-- kept -->\n  {NODE.format('a')}\n</launch>",
    "ws/nav/launch/in.launch": '<launch><include file="$(dirname)/b.launch"/></launch>',
    "ws/nav/launch/b.launch": f"<launch>{NODE.format('b')}</launch>",
    "ws/nav/launch/other.launch": f"<launch>{NODE.format('other')}</launch>",
    "ws/beside/file": "beside",
}


class App:
    """Packages in a workspace, and what `/start` starts."""

    def __init__(self, folder):
        self.folder = folder
        self.out = folder / "out" / "guarded.launch"
        self.started = []
        write(folder, FILES)

    @property
    def overlay(self):
        return self.out.with_suffix(".d") / "overlay"

    def write(self, name, text):
        write(self.folder, {name: text})
        return self

    def start(self, name, by="/start", program="ws/core/nodes/start", **args):
        tree = read_launch(self.folder / name, args, self.packages, {})
        place = Evidence(file=str(self.folder / program), line=1)
        self.started.append(RuntimeLaunchTree(tree=tree, starter=by, evidence=(place,)))
        return self

    @property
    def packages(self):
        return find_packages([self.folder / "ws"], {})

    def guard(self, plan=PLAN):
        tree = read_launch(self.folder / "ws/core/app.launch", {}, self.packages, {})
        return instrument_ros1(
            tree, plan, self.out, GuardFiles(""), started=self.started, packages=self.packages
        )

    def written(self, plan=PLAN):
        result = self.guard(plan)
        write_guarded_launch(result)
        return result

    def lost(self):
        return {end.what: end.why for end in self.guard().unenforceable if end.what != "/b"}


@pytest.fixture
def app(tmp_path):
    return App(tmp_path)


def targets(app, name):
    tree = read_launch(app.overlay / name, {}, app.packages, {})
    return {node.name: [(r.written_source, r.target) for r in node.remaps] for node in tree.nodes()}


def test_a_started_launch_file_has_a_copy_with_remaps_and_the_rest_of_its_package(app):
    result = app.start("ws/nav/launch/a.launch").written()
    assert targets(app, "nav/launch/a.launch") == {"/a": [(T, "/rtron/cmd_vel/flow1")]}
    assert "<!-- kept -->" in (app.overlay / "nav/launch/a.launch").read_text()
    assert (app.overlay / "nav/map.yaml").readlink() == app.folder / "ws/nav/map.yaml"
    assert (app.overlay / "nav/launch/b.launch").is_symlink()
    assert {remap.node for remap in result.remaps} == {"/a", "/c"}


def test_the_program_is_copied_and_what_lies_beside_its_package_is_linked(app):
    app.start("ws/nav/launch/a.launch").written()
    copy = app.overlay / "core/nodes/start"
    assert copy.resolve() == copy
    assert os.access(copy, os.X_OK)
    assert copy.read_text() == FILES["ws/core/nodes/start"]
    assert (app.overlay / "core/nodes/other.py").is_symlink()
    assert (app.overlay / "beside/file").read_text() == "beside"


def test_a_module_that_starts_a_launch_file_is_copied_too(app):
    app.start("ws/nav/launch/a.launch", program="ws/core/nodes/starting.py").written()
    assert not (app.overlay / "core/nodes/starting.py").is_symlink()
    assert "/a" not in app.lost()


def test_an_include_of_a_started_file_leads_to_its_copy(app):
    app.start("ws/nav/launch/in.launch").written()
    assert targets(app, "nav/launch/in.launch") == {"/b": [(T, "/rtron/cmd_vel/flow2")]}


def test_the_guarded_launch_can_be_moved(app):
    app.start("ws/nav/launch/in.launch").written()
    app.out.parent.rename(app.folder / "moved")
    app.out = app.folder / "moved" / app.out.name
    assert targets(app, "nav/launch/in.launch") == {"/b": [(T, "/rtron/cmd_vel/flow2")]}


def test_nothing_is_made_where_no_started_node_is_planned(app):
    result = app.start("ws/nav/launch/other.launch").written()
    assert not app.overlay.exists()
    assert not result.links
    assert "starter" not in app.out.read_text()


def test_a_file_that_stays_as_it_is_is_found_beside_the_program(app):
    app.write("else/far/package.xml", package("far")).write("else/far/x.launch", "<launch/>")
    app.start("else/far/x.launch").start("ws/nav/launch/a.launch").written()
    assert (app.overlay / "else/far/x.launch").exists()
    assert (app.overlay / "ws/nav/launch/a.launch").exists()


def test_packages_behind_links_are_laid_out_as_they_really_lie(app):
    write(app.folder, {"git/far/package.xml": package("far")})
    write(app.folder, {"git/far/x.launch": f"<launch>{NODE.format('a')}</launch>"})
    (app.folder / "ws/far").symlink_to(app.folder / "git/far")
    app.start("ws/far/x.launch").written()
    assert targets(app, "git/far/x.launch") == {"/a": [(T, "/rtron/cmd_vel/flow1")]}
    assert (app.overlay / "ws/core/nodes/start").exists()


def test_a_starter_in_a_started_launch_file_is_led_by_its_copy(app):
    second = '<launch><node pkg="core" type="start" name="second"/></launch>'
    app.write("ws/nav/second.launch", second)
    app.start("ws/nav/second.launch").start("ws/nav/launch/a.launch", by="/second").written()
    text = (app.overlay / "nav/second.launch").read_text()
    assert "/../../starter" in text
    assert (app.overlay / "nav/../../starter").resolve() == app.out.with_suffix(".d") / "starter"


@pytest.mark.parametrize(
    ("own", "expected"), [("", '"{}"'), (' launch-prefix="nice -n 3"', '"{}" nice -n 3')]
)
def test_the_starter_comes_before_the_nodes_own_prefix(app, own, expected):
    node = BODY.replace(' name="start"', f' name="start"{own}')
    app.write("ws/core/app.launch", f"<launch>{node}</launch>")
    app.start("ws/nav/launch/a.launch").written()
    prefix = expected.format("$(dirname)/guarded.d/starter").replace('"', "&quot;")
    text = app.out.read_text()
    assert f'launch-prefix="{prefix}"' in text or f"launch-prefix='{expected}'" in text.replace(
        "$(dirname)/guarded.d/starter", "{}"
    )


def test_a_prefix_that_an_expression_chooses_is_refused(app):
    own = " launch-prefix=\"$(eval 'x')\""
    node = BODY.replace(' name="start"', f' name="start"{own}')
    app.write("ws/core/app.launch", f"<launch>{node}</launch>")
    with pytest.raises(InputError, match="eval"):
        app.start("ws/nav/launch/a.launch").guard()


def test_no_link_leads_back_to_the_guarded_launch(app):
    app.out = app.folder / "ws" / "deep" / "guarded.launch"
    app.write("ws/deep/file", "").start("ws/nav/launch/a.launch").written()
    app.written()
    found = [Path(folder).name for folder, _, _ in os.walk(app.overlay, followlinks=True)]
    assert {"core", "nav", "beside", "deep"} <= set(found)
    assert "guarded.d" not in found


def test_a_mirror_has_an_end(app, monkeypatch):
    app.start("ws/nav/launch/a.launch")
    links = len(app.guard().links)
    monkeypatch.setattr("rtron.planning.instrument.ros1.instrumentation.MAX_LINKS", links)
    app.guard()
    monkeypatch.setattr("rtron.planning.instrument.ros1.instrumentation.MAX_LINKS", links - 1)
    with pytest.raises(InputError, match="holds more than"):
        app.guard()


def test_a_copied_package_cannot_hold_its_copy(app):
    app.out = app.folder / "ws/core/deep/guarded.launch"
    with pytest.raises(InputError, match="to be copied"):
        app.start("ws/nav/launch/a.launch").guard()


def test_the_copies_are_no_packages_of_the_workspace(app):
    app.out = app.folder / "ws" / "guarded.launch"
    before = app.packages
    app.start("ws/nav/launch/a.launch").written()
    assert app.packages == before


def test_a_colon_cannot_stand_in_the_package_path(app):
    app.out = app.folder / "a:b" / "guarded.launch"
    with pytest.raises(InputError, match="cannot hold packages"):
        app.start("ws/nav/launch/a.launch").guard()


def test_a_file_in_no_package_is_out_of_reach(app):
    app.write("loose/a.launch", FILES["ws/nav/launch/a.launch"]).start("loose/a.launch")
    assert "lies in no package" in app.lost()["/a"]
    app.written()
    assert not app.overlay.exists()


def test_a_starter_that_is_not_launched_is_out_of_reach(app):
    app.start("ws/nav/launch/a.launch", by="/ghost")
    assert "no launch file starts /ghost" in app.lost()["/a"]


def test_a_path_that_stands_in_the_program_is_out_of_reach(app):
    app.write("ws/core/nodes/start", f"#!/bin/sh\nroslaunch {app.folder}/ws/nav/launch/a.launch\n")
    assert "as it is" in app.start("ws/nav/launch/a.launch").lost()["/a"]


@pytest.mark.parametrize(
    ("attribute", "child", "given"),
    [
        (' args="$(find nav)/launch/a.launch"', "", "its arguments"),
        (
            "",
            '<param name="file" value="$(find nav)/launch/a.launch"/>',
            "the parameter /start/file",
        ),
        ("", '<env name="NAV" value="$(find nav)"/>', "$NAV"),
    ],
)
def test_a_path_that_roslaunch_gives_is_out_of_reach(app, attribute, child, given):
    start = f'<node pkg="core" type="start" name="start"{attribute}>{child}</node>'
    app.write("ws/core/app.launch", f"<launch>{start}{NODE.format('c')}</launch>")
    assert given in app.start("ws/nav/launch/a.launch").lost()["/a"]


def test_a_path_to_something_else_of_the_package_does_no_harm(app):
    args = ' args="$(find nav)/map.yaml"'
    body = BODY.replace(' name="start"', f' name="start"{args}')
    app.write("ws/core/app.launch", f"<launch>{body}</launch>")
    assert "/a" not in app.start("ws/nav/launch/a.launch").lost()


def test_a_module_elsewhere_that_looks_beside_itself_is_out_of_reach(app):
    app.write("ws/core/src/core/module.py", "print(__file__)")
    app.start("ws/nav/launch/a.launch", program="ws/core/src/core/module.py")
    assert "not beside its program" in app.lost()["/a"]


def test_one_file_has_one_copy(app):
    named = '<launch><arg name="n"/><node pkg="nodes" type="t" name="$(arg n)"/></launch>'
    app.write("ws/nav/named.launch", named)
    app.start("ws/nav/named.launch", n="a").start("ws/nav/named.launch", n="b")
    ends = {end.what: end.why for end in app.guard().unenforceable}
    assert "several ways" in ends["/b"]
    assert "/a" not in ends


def test_one_file_started_twice_for_the_same_remaps_is_reached(app):
    app.start("ws/nav/launch/a.launch").start("ws/nav/launch/a.launch")
    assert "/a" not in app.lost()


def test_what_a_lost_launch_file_starts_is_lost_as_well(app):
    second = '<launch><node pkg="core" type="start" name="second"/></launch>'
    app.write("loose/second.launch", second)
    app.start("loose/second.launch").start("ws/nav/launch/a.launch", by="/second")
    assert "out of reach" in app.lost()["/a"]


def test_what_is_lost_can_be_accepted(app):
    app.write("loose/a.launch", FILES["ws/nav/launch/a.launch"]).start("loose/a.launch")
    plan = plan_of(grcn(T, ["/a"], ["/c"]), accept_unenforceable=("/a",))
    assert [(end.what, end.accepted) for end in app.guard(plan).unenforceable] == [("/a", True)]


def run(app, *command, **environ):
    starter = app.out.with_suffix(".d") / "starter"
    done = subprocess.run(
        [starter, *command], env=environ, check=True, capture_output=True, text=True
    )
    return done.stdout


@pytest.mark.parametrize("name", ["plain", "a b;c"])
def test_the_starter_runs_the_copy_and_puts_the_copies_first(tmp_path, name):
    app = App(tmp_path / name)
    app.start("ws/nav/launch/a.launch").written()
    overlay, original = app.overlay.resolve(), app.folder / "ws/core/nodes/start"
    python = "/usr/bin/python3"
    assert run(app, python, original).strip() == str(overlay / "core/nodes/start")
    relay = app.folder / "devel/lib/core/start"
    assert run(app, "echo", relay, "x y").strip() == f"{overlay}/core/nodes/start x y"
    path = run(app, "sh", "-c", "echo $ROS_PACKAGE_PATH", ROS_PACKAGE_PATH="/opt").strip()
    assert path == f"{overlay}/nav:{overlay}/core:/opt"
    path = run(app, "/bin/sh", "-c", "echo $ROS_PACKAGE_PATH").strip()
    assert path == f"{overlay}/nav:{overlay}/core"


def test_names_are_no_commands_and_no_patterns(tmp_path):
    copy = Path("c/$(touch x)")
    script = tmp_path / "starter"
    (tmp_path / "overlay").mkdir()
    odd = "core/`touch x`'*"
    script.write_text(starter_script([Path("p q")], {Path("/no/$(touch x)"): (odd, copy)}))
    ran = subprocess.run(
        ["/bin/sh", script, "printf", "%s|", f"/lib/{odd}", "/lib/core/`touch x`'y", "*"],
        check=True,
        capture_output=True,
        text=True,
        cwd=tmp_path,
    )
    assert ran.stdout == f"{tmp_path}/overlay/{copy}|/lib/core/`touch x`'y|*|"
    assert not (tmp_path / "x").exists()


def test_a_pipe_that_is_named_like_the_program_is_left_alone(app):
    (app.folder / "ws/core/nodes/start").unlink()
    os.mkfifo(app.folder / "ws/core/nodes/start")
    app.start("ws/nav/launch/a.launch", program="ws/core/package.xml").written()
    assert targets(app, "nav/launch/a.launch") == {"/a": [(T, "/rtron/cmd_vel/flow1")]}


def test_a_deep_folder_in_a_package_hides_no_other(tmp_path, deep_folder):
    deep_folder(tmp_path)
    script = tmp_path / "scripts/run"
    script.parent.mkdir()
    script.write_text("#!/bin/sh\n")
    (tmp_path / "package.xml").write_text("<package><name>p</name></package>")
    node = LaunchNode(name="/n", package="p", type="run", element_index=1)
    (found,) = find_scripts([node], {"p": tmp_path})
    assert found.path == script
