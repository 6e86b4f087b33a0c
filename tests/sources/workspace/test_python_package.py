"""Programs of Python packages whose setup.py puts its entry points together."""

import pytest
from file_tree import package
from workspace_tree import workspace

from rtron.sources.workspace.python_package import read_python_package

HEAD = "from setuptools import setup\nname = 'p'\nNODES = ['a', 'b']\n"
BOTH = {"a": ("p.a", "main"), "b": ("p.b", "main")}
ENTRIES = {
    "setup(entry_points={'console_scripts': [f'{n} = {name}.{n}:main' for n in NODES]})": BOTH,
    "setup(entry_points={'console_scripts': ['%s = p.%s:main' % (n, n) for n in NODES]})": BOTH,
    "setup(entry_points={'console_scripts': ['{} = p.{}:main'.format(n, n) for n in NODES]})": BOTH,
    "setup(entry_points={'console_scripts': list(n + '=p.' + n + ':main' for n in NODES)})": BOTH,
    ("scripts = []\nfor n in NODES:\n    scripts.append(f'{n} = p.{n}:main')\n"
     "setup(entry_points={'console_scripts': scripts})"): BOTH,
    ("scripts = ['a = p.a:main']\nscripts += ['b = p.b:main']\n"
     "setup(entry_points=dict(console_scripts=scripts))"): BOTH,
    ("points = {'console_scripts': ['a = p.a:main']}\n"
     "points['console_scripts'].extend(['b = p.b:main'])\nsetup(entry_points=points)"): BOTH,
    ("d = {}\nd['entry_points'] = {'console_scripts': ['a = p.a:main', *['b = p.b:main']]}\n"
     "def main():\n    try:\n        setup(**d)\n    finally:\n        pass\n"): BOTH,
    ("setup(entry_points={'console_scripts':\n"
     " [f'{n} = p.{m}:main' for n, m in [('a', 'a'), ('b', 'b')]]})"): BOTH,
    "setup(entry_points='[console_scripts]\\na = p.a:main\\nb = p.b:main')": BOTH,
    "setup(entry_points={'console_scripts': 'a = p.a:main\\nb = p.b:main'})": BOTH,
    "setup(entry_points={'console_scripts': [f'a{i} = p.a:main' for i in (1, 2)]})": {
        "a1": ("p.a", "main"), "a2": ("p.a", "main")},
    "setup(name=name, packages=find_packages())": {},
}  # fmt: skip


@pytest.mark.parametrize("text", ENTRIES)
def test_entry_points_that_are_put_together(tmp_path, text):
    (tmp_path / "setup.py").write_text(HEAD + text)
    found = read_python_package(tmp_path, "p")
    assert found.entry_points == ENTRIES[text]
    assert found.unresolved == ()


@pytest.mark.parametrize(
    ("name", "text", "line"),
    [
        ("setup.py", "\nsetup(entry_points={'console_scripts': [f'a = {x}.a:m' for x in y()]})", 2),
        ("setup.py", "setup(entry_points={'console_scripts': nodes()})", 1),
        ("setup.py", "setup(entry_points=nodes())", 1),
        ("setup.py", "setup(entry_points='x')", 1),
        ("setup.py", "\nprint 'Python 2'", 2),
        ("setup.cfg", "[options]\nx = y\nno value", 0),
        ("setup.py", "s = 'x' * 9\ns = 'xxxxxxxx'\nfor i in [1] * 3:\n" + "    s += s\n" * 40, 0),
        ("setup.py", "l = [1]\n" + "l += l\n" * 40 + "setup()", 0),
    ],
)
def test_what_is_not_understood_is_noted_with_its_place(tmp_path, name, text, line):
    path = tmp_path / name
    path.write_text(text)
    (note,) = read_python_package(tmp_path, "p").unresolved
    assert note.what == name
    assert [(each.file, each.line) for each in note.evidence] == [(str(path), line)]


def test_the_notes_are_those_of_the_workspace(tmp_path):
    package(tmp_path / "p", {"setup.py": "setup(entry_points=nodes())"})
    found = workspace(tmp_path)
    assert found.executable("p", "n") is None
    assert [note.what for note in found.unresolved()] == ["setup.py"]


def test_scripts_of_setup_are_programs_though_they_are_not_executable(tmp_path):
    setup = "setup(scripts=['bin/go', 'bin/none'])"
    files = {"setup.py": setup, "bin/go": "import rclpy", "x": "#!"}
    path = package(tmp_path / "p", files)
    found = workspace(tmp_path)
    assert found.executable("p", "go").sources == (path / "bin/go",)
    assert found.executable("p", "none") is None
    assert found.program_names("p") == ("go", "x")


def test_the_modules_folder_of_a_package_needs_no_init_file(tmp_path):
    """PEP 420; ROS 1 keeps its modules in `src`, whatever scripts lie beside it."""
    setup = "setup(packages=['p'], entry_points={'console_scripts': ['n = p.node:main']})"
    path = package(tmp_path / "p", {"setup.py": setup, "p/node.py": "", "p/part.py": ""})
    package(tmp_path / "q", {"q/script.py": "", "src/q/part.py": ""})
    found = workspace(tmp_path)
    assert found.executable("p", "n").sources == (path / "p/node.py",)
    assert found.python_module("p.part", "p", path / "p/node.py") == path / "p/part.py"
    assert found.python_module("q.part", "q", path / "x.py") == tmp_path / "q/src/q/part.py"


def test_the_modules_of_a_package_may_have_names_of_their_own(tmp_path):
    """Setuptools: without `package_dir` they stand beside setup.py, whatever else `src` holds."""
    setup = "setup(packages=['deck'], entry_points={'console_scripts': ['n = deck.node:main']})"
    files = {"setup.py": setup, "deck/node.py": "", "deck/part.py": "", "src/driver.cpp": ""}
    path = package(tmp_path / "p", files)
    found = workspace(tmp_path)
    assert found.executable("p", "n").sources == (path / "deck/node.py",)
    assert found.python_module("deck.part", "p", path / "deck/node.py") == path / "deck/part.py"
