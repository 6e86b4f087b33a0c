"""SDF worlds, and the models that they include."""

import pytest

from rtron.errors import InputError
from rtron.sources.gazebo import read_world

MODEL = """<sdf version="1.5"><model name="bot"><link name="base">
<sensor type="camera" name="eye"><plugin filename="libcamera.so" name="c"/></sensor>
<visual name="v"><plugin filename="libvideo.so" name="v"/></visual></link>
<plugin filename="libdrive.so" name="d"/></model></sdf>"""


@pytest.fixture
def world(tmp_path):
    def read(body, environ=None, packages=None):
        path = tmp_path / "app.world"
        path.write_text(f'<sdf version="1.5">{body}</sdf>')
        return read_world(path, packages or {}, environ or {})

    return read


@pytest.fixture
def models(tmp_path):
    folder = tmp_path / "pkg" / "models" / "bot"
    folder.mkdir(parents=True)
    (folder / "model.sdf").write_text(MODEL)
    return folder.parent


def include(uri, more=""):
    return f"<world name='w'><include><uri>{uri}</uri>{more}</include></world>"


def facts(fake_study):
    return [(p.filename, p.model, p.link) for p in fake_study.plugins]


def test_plugins_of_world_model_sensor_and_gui(world):
    found = world(
        '<world name="w"><plugin filename="liba.so" name="a"/><gui><plugin filename="libb.so"/>'
        '</gui><model name="m"><plugin filename="libc.so"/><model name="n"><plugin '
        'filename="libd.so"/></model></model></world>'
    )
    assert facts(found) == [("a", "", ""), ("b", "", ""), ("c", "m", ""), ("d", "m::n", "")]


@pytest.mark.parametrize("by", ["package", "environment"])
def test_a_model_is_found(by, world, models):
    given = {
        "package": {"packages": {"pkg": models.parent}},
        "environment": {"environ": {"GAZEBO_MODEL_PATH": f"/absent:{models}"}},
    }
    found = world(include("model://bot"), **given[by])
    assert facts(found) == [
        ("camera", "bot", "base"),
        ("video", "bot", "base"),
        ("drive", "bot", ""),
    ]
    assert found.plugins[0].evidence.file == str(models / "bot" / "model.sdf")
    assert found.plugins[0].evidence.line == 2
    assert found.unresolved == ()


def test_an_include_may_rename_its_model_and_add_a_plugin(world, models):
    more = '<name>two</name><plugin filename="libown.so" name="o"/>'
    found = world(include("model://bot", more), packages={"pkg": models.parent})
    assert {plugin.model for plugin in found.plugins} == {"two"}
    assert found.plugins[-1].filename == "own"


def test_a_models_config_names_its_newest_file(world, models):
    (models / "bot" / "model.config").write_text(
        '<model><sdf version="1.2">old.sdf</sdf><sdf version="1.5">new.sdf</sdf></model>'
    )
    (models / "bot" / "new.sdf").write_text(MODEL.replace("libcamera", "libnew"))
    found = world(include("model://bot"), packages={"pkg": models.parent})
    assert found.plugins[0].filename == "new"


@pytest.mark.parametrize(
    "uri",
    ["model://absent", "", "model://", "https://x/y", "model://../x", "model://" + "n" * 5000],
)
def test_an_include_that_is_not_found_leaves_the_rest(uri, world, models):
    found = world(
        f"<world name='w'>\n<include><uri>{uri}</uri></include><plugin filename='a'/></world>",
        packages={"pkg": models.parent},
    )
    (note,) = found.unresolved
    assert (note.evidence[0].line, note.hides) == (2, "nodes")
    assert [plugin.filename for plugin in found.plugins] == ["a"]


@pytest.mark.parametrize("way", ["absolute", "link"])
def test_what_lies_elsewhere_is_not_read(way, world, models, tmp_path_factory):
    secret = tmp_path_factory.mktemp("elsewhere") / "model.sdf"
    secret.write_text(MODEL)
    (models / "linked.sdf").symlink_to(secret)
    uri = f"file://{secret}" if way == "absolute" else "model://linked.sdf"
    found = world(include(uri), packages={"pkg": models.parent})
    assert found.plugins == ()
    (note,) = found.unresolved
    assert "is not in the folders that are read" in note.why


def test_what_gazebo_itself_has_is_not_missed(world):
    assert world(include("model://sun") + include("model://ground_plane")).unresolved == ()


def test_comments_may_stand_before_the_declaration(tmp_path):
    path = tmp_path / "app.world"
    path.write_text(f"<!-- a --> <!-- <?xml -->\n<?xml version='1.0'?>\n{MODEL}")
    (eye, *_) = read_world(path, {}, {}).plugins
    assert (eye.name, eye.evidence.line) == ("c", 4)
    path.write_text(f"text\n<?xml version='1.0'?>\n{MODEL}")
    with pytest.raises(InputError, match="not XML"):
        read_world(path, {}, {})


def test_models_that_include_each_other_end(world, models):
    twice = "<include><uri>model://bot</uri></include><include><uri>model://two</uri></include>"
    for name in ("bot", "two"):
        (models / name).mkdir(exist_ok=True)
        (models / name / "model.sdf").write_text(f"<sdf><model name='{name}'>{twice}</model></sdf>")
    found = world(include("model://bot"), packages={"pkg": models.parent})
    assert any("includes itself" in note.why for note in found.unresolved)


def test_a_file_that_is_no_xml_is_an_input_error(tmp_path):
    path = tmp_path / "stage.world"
    path.write_text("define block model ()")
    with pytest.raises(InputError, match=r"stage\.world"):
        read_world(path, {}, {})
