"""Descriptions that mean harm, or are broken: bounded, noted with their place, the rest read."""

import pytest

from rtron.errors import InputError
from rtron.sources.xacro import evaluate_xacro
from rtron.vocabulary import UnresolvedCause

ROBOT = '<robot xmlns:xacro="http://www.ros.org/wiki/xacro">\n{}\n<end/></robot>'


@pytest.fixture
def evaluated(tmp_path):
    def run(body, **files):
        for name, text in files.items():
            (tmp_path / f"{name}.xacro").write_text(text)
        path = tmp_path / "robot.xacro"
        path.write_text(ROBOT.replace("{}", body))
        return evaluate_xacro(path, {}, {}, {})

    return run


def macro(name, body):
    return f'<xacro:macro name="{name}" params="">{body}</xacro:macro>'


def doubling(value, first):
    values = (value.replace("P", f"p{n}") for n in range(60))
    properties = (f'<xacro:property name="p{n + 1}" value="{v}"/>' for n, v in enumerate(values))
    return f'<xacro:property name="p0" value="{first}"/>' + "".join(properties) + '<x y="${p60}"/>'


BOMBS = {
    "macros": "".join(macro(f"m{n + 1}", f"<xacro:m{n}/>" * 2) for n in range(60))
    + macro("m0", "")
    + "<xacro:m60/>",
    "endless macro": macro("m", "<xacro:m/><xacro:m/>") + "<xacro:m/>",
    "deep macro": macro("m", "<a>" * 99 + "<xacro:m/>" + "</a>" * 99) + "<xacro:m/>",
    "strings": doubling("${P}${P}", "aaaa"),
    "lists": doubling("${[P, P]}", "${[1]}"),
    "rounds": '<x y="${[1 for a in range(4000) for b in range(4000) for c in range(4000)]}"/>',
    "range": '<x y="${range(10**12)}"/>',
    "power": '<x y="${9**9**9**9}"/>',
    "repeated": "<x y=\"${'a' * 10**9}\"/>",
    "width": "<x y=\"${'%99999999d' % 1}\"/>",
    "replaced": "<x y=\"${('a' * 4000).replace('a', 'b' * 4000)}\"/>",
    "deep expression": f'<x y="${{{"-" * 3000}1}}"/>',
    "chain": "".join(f'<xacro:property name="p{n + 1}" value="${{p{n}}}"/>' for n in range(3000))
    + '<x y="${p3000}"/>',
    "written": f'<xacro:property name="p" value="{"a" * 4000}"/>'
    + macro("m0", '<a q="${p}"/>' * 100)
    + macro("m1", "<xacro:m0/>" * 100)
    + "<xacro:m1/>",
}


@pytest.mark.parametrize("name", BOMBS)
def test_what_grows_without_end_ends_soon_and_is_noted(name, evaluated):
    result = evaluated(BOMBS[name])
    assert result.unresolved
    assert len(result.text) < 20_000_000


@pytest.mark.parametrize(
    "expression",
    [
        "().__class__",
        "str.format",
        "(lambda: 1)()",
        "open('/etc/passwd')",
        "__import__('os')",
        "xacro.load",
        "math.__dict__",
        "'{0.real}'.format(1)",
        "[x for x.y in [1]]",
        "dict(**{})",
    ],
)
def test_what_lies_outside_the_grammar_is_not_evaluated(expression, evaluated):
    result = evaluated(f'<x y="${{{expression}}}"/>')
    (note,) = result.unresolved
    assert (note.evidence[0].line, note.hides) == (2, None)
    assert result.root.find("x").attributes["y"] == f"${{{expression}}}"
    assert result.root.find("end")


YAML = {
    "aliases": "a: &a [1,1,1,1,1,1,1,1,1,1]\n"
    + "".join(
        f"{n}{n}: &{n} [{', '.join([f'*{b}'] * 10)}]\n"
        for b, n in zip("abcdefghi", "bcdefghij", strict=True)
    ),
    "merges": "a: &a {x: 1}\n"
    + "".join(
        f"{n}{n}: &{n} {{<<: [{', '.join([f'*{b}'] * 10)}]}}\n"
        for b, n in zip("abcdefghi", "bcdefghij", strict=True)
    ),
    "tag": "a: !!python/object/apply:os.getcwd []\n",
    "deep": "[" * 1000,
    "large": "a" * 300_000,
    "unit": "a: !degrees __import__('os')\n",
}


@pytest.mark.parametrize("name", YAML)
def test_a_hostile_yaml_file_is_noted(name, evaluated, tmp_path):
    (tmp_path / "f.yaml").write_text(YAML[name])
    result = evaluated("<x y=\"${load_yaml('f.yaml')}\"/>")
    assert len(result.unresolved) == 1
    assert result.root.find("end")


def test_an_include_that_may_be_absent_may_have_any_name(evaluated):
    found = evaluated(f'<xacro:include filename="{"n" * 5000}" optional="true"/>')
    assert found.unresolved == ()


def test_an_include_that_comes_back_is_noted_once_with_its_place(evaluated, tmp_path):
    other = '<robot xmlns:xacro="x"><b/><xacro:include filename="./inner/../robot.xacro"/></robot>'
    result = evaluated('<a/><xacro:include filename="other.xacro"/>', other=other)
    assert [element.tag for element in result.root.elements()] == ["a", "b", "end"]
    (note,) = result.unresolved
    assert "includes itself" in note.why
    assert note.evidence[0].file == str(tmp_path / "other.xacro")


@pytest.mark.parametrize("name", ["absent.xacro", "/dev/zero", ".", "/*/*/*", "$(find nowhere)/a"])
def test_an_include_that_cannot_be_read_leaves_the_rest(name, evaluated, tmp_path):
    result = evaluated(f'<a/>\n<xacro:include filename="{name}"/>\n<xacro:wheel/><b c="${{w}}"/>')
    note, *others = result.unresolved
    assert [each.cause for each in others] == [UnresolvedCause.INCOMPLETE_DESCRIPTION] * 2
    assert (note.evidence[0].file, note.evidence[0].line) == (str(tmp_path / "robot.xacro"), 3)
    assert note.hides == "nodes"
    assert [element.tag for element in result.root.elements()] == ["a", "b", "end"]


@pytest.mark.parametrize(
    "body",
    [
        '<x y="${"/>',
        '<x y="$(find)"/>',
        '<x y="$(arg nobody)"/>',
        '<xacro:if value="maybe"><q/></xacro:if>',
        '<xacro:property name="not a name" value="1"/>',
        '<xacro:insert_block name="nobody"/>',
        '<xacro:element xacro:name="a b"/>',
        '<x><xacro:attribute name="&lt;" value="1"/></x>',
        '<xacro:nobody a="1"><p/></xacro:nobody>',
        '<xacro:call macro="nobody"/>',
        macro("m", "") + '<xacro:m a="1"/>',
        macro("m", "") + "<xacro:m><block/></xacro:m>",
        '<xacro:macro name="m" params="a">t</xacro:macro><xacro:m/>',
        '<xacro:macro name="m" params="*a">t</xacro:macro><xacro:m/>',
        '<xacro:property name="a" value="${a + 1}"/><x y="${a}"/>',
    ],
)
def test_a_fault_is_noted_once_with_its_line(body, evaluated):
    result = evaluated(body)
    (note,) = result.unresolved
    assert note.evidence[0].line == 2
    assert result.root.find("end")


@pytest.mark.parametrize(
    "text", ["", "<robot>", "<!DOCTYPE r [<!ENTITY a 'b'>]><r>&a;</r>", "<a>" * 400 + "</a>" * 400]
)
def test_a_file_that_is_no_plain_xml_is_an_input_error(text, tmp_path):
    path = tmp_path / "robot.xacro"
    path.write_text(text)
    with pytest.raises(InputError, match=r"robot\.xacro"):
        evaluate_xacro(path, {}, {}, {})
