"""Descriptions, one feature each; the real xacro says what each of them stands for.

Beside each lie the files of FILES.
"""

FILES = {
    "parts.xacro": '<robot xmlns:xacro="http://ros.org/wiki/xacro"><xacro:property name="size" '
    'value="${2*3}"/><xacro:macro name="part" params="n:=7"><part n="${n}" s="${size}"/>'
    "</xacro:macro><included/></robot>",
    "glob_a.xacro": "<robot><a/></robot>",
    "glob_b.xacro": "<robot><b/></robot>",
    "inner/deep.xacro": '<robot xmlns:xacro="http://ros.org/wiki/xacro"><xacro:include '
    'filename="leaf.xacro"/></robot>',
    "inner/leaf.xacro": "<robot><leaf/></robot>",
    "robot.yaml": "wheel: {radius: 0.3, names: [left, right]}\nturn: !degrees 180\n"
    "gap: !millimeters 2*4\ntable: [[1, 2], [3, 4]]\n",
}

BLOCK = '<xacro:macro name="m" params="a *b **c"><x a="${a}"><xacro:insert_block name="b"/>'
BLOCK += '<xacro:insert_block name="c"/></x></xacro:macro>'

CASES = {
    "property": '<xacro:property name="a" value="2"/><x y="${a}" z="a${a}b${a*2.5}"/>',
    "text": '<xacro:property name="a" value="2"/><x>1 ${a} 3</x>',
    "lazy": '<xacro:property name="a" value="${b}"/><xacro:property name="b" value="1"/>'
    '<x y="${a}"/><xacro:property name="b" value="2"/><x y="${a}"/>',
    "eager": '<xacro:property name="b" value="1"/><xacro:property name="a" value="${b}" '
    'lazy_eval="false"/><xacro:property name="b" value="2"/><x y="${a}"/>',
    "property default": '<xacro:property name="a" default="1"/><xacro:property name="a" '
    'default="2"/><x y="${a}"/>',
    "property removed": '<xacro:property name="a" value="1"/><xacro:property name="a" '
    'remove="true"/><xacro:property name="a" default="2"/><x y="${a}"/>',
    "property by expression": '<xacro:property name="k" value="q"/><xacro:property '
    'name="${k}1" value="5"/><x y="${q1}"/>',
    "property block": '<xacro:property name="o"><origin xyz="${p} 0"/><b/></xacro:property>'
    '<xacro:property name="p" value="4"/><x><xacro:insert_block name="o"/></x>'
    '<xacro:insert_block name="o"/>',
    "literals": "".join(
        f'<xacro:property name="v" value="{v}"/><x v="${{v}}" t="${{v*2 if v else v}}"/>'
        for v in (
            "1",
            "1.50",
            "1e3",
            "true",
            "False",
            "'1'",
            "1_000",
            "abc",
            " 3 ",
            "0x1",
            "",
            "-1",
        )
    ),
    "quoted dollars": '<x y="$${a} $$(b) $$${a} $a $1 a$"/>',
    "scope global": '<xacro:macro name="m" params=""><xacro:property name="g" value="7" '
    'scope="global"/></xacro:macro><xacro:m/><x y="${g}"/>',
    "scope parent": '<xacro:macro name="i" params=""><xacro:property name="g" value="7" '
    'scope="parent"/></xacro:macro><xacro:macro name="m" params=""><xacro:i/><x y="${g}"/>'
    '</xacro:macro><xacro:property name="g" value="1"/><xacro:m/><y y="${g}"/>',
    "scope local": '<xacro:property name="g" value="1"/><xacro:macro name="m" params="">'
    '<xacro:property name="g" value="2"/><x y="${g}"/></xacro:macro><xacro:m/><x y="${g}"/>',
    "macro": '<xacro:macro name="m" params="a b:=3 c=\'x y\' d:=${a_}"><x a="${a}" b="${b}" '
    'c="${c}" d="${d}"/></xacro:macro><xacro:property name="a_" value="9"/>'
    '<xacro:m a="1"/><xacro:m a="${1+1}" b="q" d="w"/>',
    "macro forward": '<xacro:macro name="m" params="a:=^ b:=^|5 c:=^|${2*2}"><x y="${a}${b}${c}"/>'
    '</xacro:macro><xacro:property name="a" value="1"/><xacro:property name="c" value="2"/>'
    "<xacro:m/>",
    "macro empty default": '<xacro:macro name="m" params="a:=\'\' b:=$(arg q)"><x y="[${a}]" '
    'z="${b}"/></xacro:macro><xacro:arg name="q" default="5"/><xacro:m/>',
    "macro sees caller": '<xacro:macro name="i" params=""><x y="${z}"/></xacro:macro>'
    '<xacro:macro name="m" params="z"><xacro:i/></xacro:macro><xacro:m z="3"/>',
    "macro redefined": '<xacro:macro name="m" params=""><a/></xacro:macro><xacro:m/>'
    '<xacro:macro name="m" params=""><b/></xacro:macro><xacro:m/>',
    "macro defined in macro": '<xacro:macro name="m" params=""><xacro:macro name="n" params="">'
    "<n/></xacro:macro><xacro:n/></xacro:macro><xacro:m/>",
    "macro recursive": '<xacro:macro name="m" params="n"><x n="${n}"/><xacro:if value="${n}">'
    '<xacro:m n="${n-1}"/></xacro:if></xacro:macro><xacro:m n="12"/>',
    "macro named with prefix": '<xacro:macro name="xacro:m" params=""><x/></xacro:macro><xacro:m/>',
    "blocks": BLOCK + '<xacro:m a="1"><origin y="${1+1}"/><many q="1"><p/><q/></many></xacro:m>',
    "block from condition": '<xacro:macro name="m" params="*b"><xacro:insert_block name="b"/>'
    '</xacro:macro><xacro:m><xacro:if value="1"><origin/></xacro:if></xacro:m>',
    "block passed on": '<xacro:macro name="i" params="*b"><i><xacro:insert_block name="b"/></i>'
    '</xacro:macro><xacro:macro name="m" params="*b"><xacro:i><xacro:insert_block name="b"/>'
    "</xacro:i></xacro:macro><xacro:m><origin/></xacro:m>",
    "block evaluated twice": '<xacro:macro name="m" params="*b a"><xacro:insert_block name="b"/>'
    '</xacro:macro><xacro:m a="5"><o y="$${a}"/></xacro:m>',
    "call": '<xacro:macro name="m1" params="a"><x a="${a}"/></xacro:macro><xacro:property '
    'name="k" value="1"/><xacro:call macro="m${k}" a="2"/>',
    "include": '<xacro:include filename="parts.xacro"/><xacro:part/><xacro:part n="1"/>',
    "include namespace": '<xacro:include filename="parts.xacro" ns="p"/><xacro:p.part/>'
    '<x y="${p.size}"/><xacro:property name="size" value="1"/><xacro:p.part n="0"/>',
    "include glob": '<xacro:include filename="glob_*.xacro"/>',
    "include optional": '<xacro:include filename="absent.xacro" optional="true"/><x/>',
    "include relative": '<xacro:include filename="inner/deep.xacro"/>',
    "include found": '<xacro:include filename="$(find pkg)/parts.xacro"/>',
    "include by property": '<xacro:property name="f" value="parts"/>'
    '<xacro:include filename="${f}.xacro"/>',
    "include in condition": '<xacro:if value="0"><xacro:include filename="absent"/></xacro:if>',
    "if": "".join(
        f'<xacro:if value="{v}"><y/></xacro:if><xacro:unless value="{v}"><n/></xacro:unless>'
        for v in ("1", "0", "true", "False", "${1 == 1}", "${0.0}", "${'a' in ['a']}", "2", "${[]}")
    ),
    "arg": '<xacro:arg name="a" default="${1+1}"/><xacro:arg name="given" default="no"/>'
    '<x y="$(arg a)" z="${$(arg a)*2}" g="$(arg given)"/>',
    "arg of xacro": '<xacro:arg name="a" default="v"/><x y="${xacro.arg(\'a\')}"/>',
    "env": '<x y="$(env RTRON_TEST)/q" z="$(optenv RTRON_TEST no)" w="$(optenv RTRON_NO a b)"/>',
    "find": '<x y="package://$(find pkg)/a"/>',
    "cwd": '<x y="$(cwd)"/>',
    "eval": '<xacro:arg name="a" default="3"/><x y="$(eval a + 1)" z="$(eval a == 3)"/>',
    "element": '<xacro:property name="t" value="joint"/><xacro:element xacro:name="my_${t}" '
    'name="${t}"><i/></xacro:element>',
    "attribute": '<x a="1"><xacro:attribute name="b" value="q${1+1}"/><xacro:attribute name="a" '
    'value="3"/></x>',
    "xacro attributes go": '<x xacro:hidden="1" a="1"/>',
    "yaml": '<xacro:property name="c" value="${load_yaml(\'robot.yaml\')}"/>'
    "<x y=\"${c['wheel']['radius']}\" z=\"${c['wheel']['names'][1]}\" t=\"${c['turn']}\" "
    "g=\"${c['gap']}\" q=\"${c['table'][1][0]}\"/>",
    "yaml by dot": '<xacro:property name="c" value="${xacro.load_yaml(\'robot.yaml\')}"/>'
    '<x y="${c.wheel.radius*2}" z="${len(c.wheel.names)}"/>',
    "math": '<x a="${pi/2}" b="${math.pi}" c="${sin(radians(30))}" d="${sqrt(2)**2}" e="${e}" '
    'f="${math.atan2(1,2)}" g="${degrees(pi)}" h="${7//2} ${7%4} ${-7/2} ${abs(-2)}"/>'.replace(
        "${abs(-2)}", "${python.abs(-2)}"
    ),
    "names over constants": '<xacro:property name="e" value="5"/><x y="${e}"/>',
    "strings": "<x a=\"${'a' + str(1)}\" b=\"${'%s_%d' % ('a', 2)}\" c=\"${'a,b'.split(',')[1]}\" "
    "f=\"${'abc'[1:]}\" g=\"${'X'.lower()}\" h=\"${'a' * 3}\"/>",
    "lists": '<xacro:property name="v" value="${[1, 2.5, 3]}"/><x a="${v[0]}" b="${v}" '
    'c="${len(v)}" d="${sum}" e="${[i * 2 for i in v if i > 1]}" f="${max(v)}" '
    'g="${list(range(3))}" h="${list(map(float, [1, 2]))}"/>'.replace('d="${sum}" ', ""),
    "dicts": '<xacro:property name="d" value="${dict(a=1, b=\'x\')}"/><x y="${d[\'a\']}" '
    'z="${d[\'b\']}" n="${list(d.keys())}" g="${d.get(\'q\', 4)}"/>',
    "comprehension of tuples": '<x y="${[a + b for a, b in [(1, 2), (3, 4)]]}" '
    'z="${[i * j for i in [1, 2] for j in [3, 4]]}"/>',
    "conditions": '<xacro:property name="a" value="3"/><x a="${1 if a > 2 else 0}" '
    'b="${a == 3 and not a > 4}" c="${1 &lt; a &lt;= 3}" d="${True}"/>',
    "tokenize": "<x y=\"${xacro.tokenize('a, b;c')}\"/>",
    "python": '<x y="${python.len([1])}" z="${round(2.567, 1)}" w="${int(2.7)} ${float(2)}"/>',
    "kept prefixes": '<sensor:camera xmlns:sensor="http://playerstage.sourceforge.net/s" '
    'name="${1+1}"/>',
    "escapes": '<x a="&lt;&amp;&quot;\'" b="a&#10;b">&lt;t&gt; &amp;</x>',
    "cdata": "<x><![CDATA[a < 2]]></x>",
    "comments": "<!-- ${nothing} --><x><!-- a -->b<!-- c -->d</x>",
    "old spelling": '<property name="a" value="2"/><macro name="m" params="p *b"><x y="${a} ${p}"/>'
    '<insert_block name="b"/></macro><m p="1"><o/></m><if value="1"><y/></if><unless value="1">'
    '<z/></unless><include filename="parts.xacro"/>',
    "no old spelling": "<include><uri>model://sun</uri></include><if/><property/><m/>",
    "own name inside": '<xacro:macro name="inertial" params="m"><inertial><mass m="${m}"/>'
    '</inertial></xacro:macro><xacro:inertial m="2"/><other><inertial n="1"/></other>',
}
