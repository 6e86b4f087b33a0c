"""Random setup.py files that Python itself runs: their entry points are found, or it is noted."""

import random

from example_budget import examples
from rtron.sources.workspace.python_package import read_python_package

LISTS = ("nodes", "tools")
STATEMENTS = (
    "{l} = ['a', 'b']",
    "{l} = [f'{{name}}_x', 'y']",
    "{l} += ['c']",
    "{l} = {l} + {m}",
    "{l} = [n + '_z' for n in {m}]",
    "{l} = ['%s_%s' % (n, name) for n in {m}]",
    "{l} = ['{{}}_q'.format(n) for n in sorted({m})]",
    "for n in list({m}):\n    {l}.append(f'{{n}}_w')",
    "{l}.extend({m})",
    "{l} = list({m})",
    "{l} = [*{m}, 'v']",
    "for n, o in [('r', 's'), ('t', 'u')]:\n    {l}.append(n + o)",
    "{l} = list(dict(k='1', l='2'))",
    "{l} = [''.join({m})]",
    "name = name + '_m'",
)
ENDINGS = (
    "setup(entry_points={{'console_scripts': [f'{{n}} = p.{{n}}:main' for n in {l}]}})",
    (
        "scripts = []\nfor n in {l} + {m}:\n    scripts.append(n + ' = p.' + n + ':main')\n"
        "setup(name=name, entry_points=dict(console_scripts=scripts))"
    ),
    (
        "points = {{}}\npoints['console_scripts'] = ['%s = p.m:main' % n for n in {l}]\n"
        "arguments = {{'entry_points': points}}\nsetup(**arguments)"
    ),
)


def random_setup(seed):
    """Return the setup.py of a seed."""
    chosen = random.Random(seed)
    lines = ["name = 'p'", "nodes = ['n']", "tools = ['t']"]
    for _ in range(chosen.randint(1, 6)):
        first, second = chosen.sample(LISTS, 2)
        lines.append(chosen.choice(STATEMENTS).format(l=first, m=second))
    first, second = chosen.sample(LISTS, 2)
    return "\n".join([*lines, chosen.choice(ENDINGS).format(l=first, m=second), ""])


def test_no_entry_point_that_python_gives_is_lost_silently(tmp_path):
    seeds, silent = examples(400), 0
    for seed in range(seeds):
        text, given = random_setup(seed), {}
        exec(text, {"setup": given.update})
        (tmp_path / "setup.py").write_text(text)
        found = read_python_package(tmp_path, "p")
        made = {entry.partition(" = ")[0] for entry in given["entry_points"]["console_scripts"]}
        assert found.unresolved or found.entry_points.keys() == made, (seed, text)
        silent += not found.unresolved
    assert silent > seeds // 2
