import pytest

from rtron.service.console.routes import bundle, script


def names(modules, entry="main.js", loaded=()):
    return list(bundle(modules, entry, dict.fromkeys(loaded, "")))


def test_what_is_imported_comes_first_and_once():
    modules = {
        "main.js": 'import { b } from "./b.js";\nimport { c } from "./sub/c.js";\n',
        "b.js": 'import { c } from "./sub/c.js";\nexport const b = c;\n',
        "sub/c.js": 'import { d as e } from "../d.js";\nexport const c = e;\n',
        "d.js": "export function d() {}\n",
        "alone.js": "export const alone = 1;\n",
    }
    assert names(modules) == ["d.js", "sub/c.js", "b.js", "main.js"]
    assert names(modules, loaded=["d.js"]) == ["sub/c.js", "b.js", "main.js"]


def test_every_way_to_export_is_returned():
    text = (
        'export { x, y } from "./y.js";\nexport const a = 1;\nexport async function b() {}\n'
        "export class C {}\nconst inner = 1;\n"
    )
    made = script(bundle({"main.js": text, "y.js": "export{p as x,q as y};"}, "main.js", {}))
    assert 'const { x: x, y: y } = modules["y.js"];' in made
    assert "return { a: a, b: b, C: C, x: x, y: y };" in made
    assert "return { x: p, y: q };" in made
    assert "export" not in made


def test_modules_that_import_each_other_are_told():
    modules = {
        "main.js": 'import { a } from "./a.js";\n',
        "a.js": 'import { main } from "./main.js";\n',
    }
    with pytest.raises(ValueError, match=r"each other: main.js a.js main.js"):
        names(modules)


def test_a_name_that_is_not_exported_is_told():
    modules = {
        "main.js": 'import { a, b } from "./a.js";\n',
        "a.js": "export const a = 1, b = 2;\n",
    }
    with pytest.raises(ValueError, match=r"main.js: a.js does not export b"):
        names(modules)


@pytest.mark.parametrize(
    "text",
    [
        "export default 1;",
        "export let a = 1;",
        'import * as a from "./a.js";',
        'import "./a.js";',
        'import { a } from "elsewhere";',
    ],
)
def test_what_is_not_known_of_modules_is_told(text):
    with pytest.raises(ValueError, match=r"main\.js: (ex|im)port"):
        names({"main.js": text, "a.js": ""})
