"""Launch files that set parameters: what is special in each is its name."""
# ruff: noqa: E501 - XML reads better in one piece
# fmt: off

from launch_cases import NODE, Case, included

N = NODE.format("n")
TYPES = ("auto", "str", "string", "int", "double", "bool", "boolean", "yaml", "AUTO", " Int ")
TEXTS = ("1", "-1", "1.5", "1e3", ".5", "1.", "true", "False", "TRUE", "1_000", "1_0.5", "", " x ", "0x10", "010", "nan", "text", "a b", "[1, 2]", "{a: 1}", "2147483647", "-2147483648", "~x", "'1'", "no")

YAML = """
int: 1
octal: 010
hex: 0x1F
sexagesimal: 1:30
underscored: 1_000
float: 1.5
exponent: 1.0e+3
no_exponent: 1e3
infinite: .inf
boolean: no
string: text
quoted: "1"
block: |
  one
  two
folded: >
  one
  two
list: [1, two, 3.0, [4], {five: 5}]
map: {a: {b: {c: 1}}, d: 2}
empty: {}
empty_list: []
anchor: &a {x: 1, y: 2}
alias: *a
merged: {<<: *a, y: 3}
merged_list: {<<: [{p: 1}, {p: 2, q: 3}], r: 4}
degrees: deg(90)
radians: rad(pi/2)
tagged_degrees: !degrees 45
tagged_radians: !radians 2*pi
not_degrees: deg(1) and more
with/slash: 1
/global: 2
~private: 3
same: 1
same: 2
string_tag: !!str 1
float_tag: !!float 1
binary: !!binary aGVsbG8=
"""

PARAMETERS = (
    Case("param", '<param name="a" value="1"/>'),
    Case("param in groups", '<group ns="g"><group ns="h"><param name="a" value="1"/></group></group>'),
    Case("param of a global name in a group", '<group ns="g"><param name="/a" value="1"/></group>'),
    Case("param with slashes", '<param name="a//b/" value="1"/>'),
    Case("param of spaces around its name", '<param name=" a " value=" x "/>'),
    Case("param twice", '<param name="a" value="1"/><param name="a" value="2"/>'),
    Case("param spelled twice", '<param name="a" value="1"/><param name="/a" value="2"/>'),
    Case("param below a param", '<param name="a" value="1"/><param name="a/b" value="2"/>'),
    Case("param above a param", '<param name="a/b" value="2"/><param name="a" value="1"/>'),
    Case("param keeps its place when overridden", '<param name="a" value="1"/><param name="a/b" value="2"/><param name="a" value="3"/>'),
    Case("param if", '<param name="a" value="1" if="0"/><param name="b" value="1" unless="0"/>'),
    Case("param with an arg", '<arg name="x" default="3"/><param name="a$(arg x)" value="$(arg x)"/>'),
    Case("param yaml of a map replaces", '<param name="a/b" value="1"/><param name="a" type="yaml" value="{c: 2}"/>'),
    Case("param yaml of an empty map", '<param name="a/b" value="1"/><param name="a" type="yaml" value="{}"/>'),
    Case("param textfile", '<param name="a" textfile="$(dirname)/t.txt"/>', {"t.txt": "one\r\ntwo\n"}),
    Case("param textfile of a number", '<param name="a" textfile="$(dirname)/t.txt"/>', {"t.txt": "12\n"}),
    Case("param textfile of a bool", '<param name="a" textfile="$(dirname)/t.txt"/>', {"t.txt": "true\n"}),
    Case("param textfile as a string", '<param name="a" type="str" textfile="$(dirname)/t.txt"/>', {"t.txt": "12"}),
    Case("param textfile as yaml", '<param name="a" type="yaml" textfile="$(dirname)/t.txt"/>', {"t.txt": "{b: 1}"}),
    Case("param binfile", '<param name="a" binfile="$(dirname)/t.bin"/>', {"t.bin": "x"}),
    Case("param command cat", '<param name="a" command="cat \'$(dirname)/t.txt\'"/>', {"t.txt": "text"}),
    Case("param command cat of a number", '<param name="a" command="cat $(dirname)/t.txt"/>', {"t.txt": "1.5"}),
    Case("param command cat as a string", '<param name="a" type="str" command="/bin/cat $(dirname)/t.txt"/>', {"t.txt": "1.5"}),
    Case("node's param", '<node pkg="p" type="t" name="n" ns="g"><param name="a" value="1"/></node>'),
    Case("node's param of a global name", '<node pkg="p" type="t" name="n" ns="g"><param name="/a" value="1"/></node>'),
    Case("node's param of a private name", '<node pkg="p" type="t" name="n"><param name="~a" value="1"/><param name="~/b" value="1"/></node>'),
    Case("node's param twice", '<node pkg="p" type="t" name="n"><param name="a" value="1"/><param name="~a" value="2"/><param name="a" value="3"/></node>'),
    Case("node's param if", '<node pkg="p" type="t" name="n"><param name="a" value="1" if="false"/><param name="b" value="1" if="true"/></node>'),
    Case("node's param in capitals", '<node pkg="p" type="t" name="n"><PARAM name="a" value="1"/><RosParam>b: 1</RosParam></node>'),
    Case("node's param against one outside", '<param name="n/a" value="1"/><node pkg="p" type="t" name="n"><param name="a" value="2"/></node><param name="n/b" value="3"/>'),
    Case("node's rosparam comes before its params", '<node pkg="p" type="t" name="n"><param name="a" value="1"/><rosparam>a: 2</rosparam></node>'),
    Case("node's rosparam", '<node pkg="p" type="t" name="n" ns="g"><rosparam>{a: 1, b: {c: 2}}</rosparam><rosparam param="d">3</rosparam><rosparam ns="e">f: 4</rosparam></node>'),
    Case("node's rosparam of a global name", '<node pkg="p" type="t" name="n"><rosparam param="/a">1</rosparam><rosparam>/b: 2</rosparam></node>'),
    Case("node's rosparam of a private name", '<node pkg="p" type="t" name="n"><rosparam param="~a">1</rosparam><rosparam ns="~b">c: 2</rosparam></node>'),
    Case("anonymous node's param", '<node pkg="p" type="t" name="$(anon n)"><param name="a" value="$(anon n)"/><rosparam>b: 1</rosparam></node>'),
    Case("test's param", '<test pkg="p" type="t" test-name="n"><param name="a" value="1"/></test>'),
    Case("private param before nodes", f'<param name="~a" value="1"/>{N}{NODE.format("m")}'),
    Case("private param after the node", f'{N}<param name="~a" value="1"/>{NODE.format("m")}'),
    Case("private param twice", f'<param name="~a" value="1"/><param name="~a" value="2"/>{N}<param name="~a" value="3"/>'),
    Case("private param spelled twice", f'<param name="~a" value="1"/><param name="~/a" value="2"/><param name="~a" value="3"/>{N}'),
    Case("node's private param spelled twice", '<node pkg="p" type="t" name="n"><param name="~a" value="1"/><param name="a" value="2"/><param name="~a" value="3"/></node>'),
    Case("private param stays in its group", f'<group><param name="~a" value="1"/>{N}</group>{NODE.format("m")}'),
    Case("private param goes into groups", f'<param name="~a" value="1"/><group ns="g">{N}<group><param name="~a" value="2"/>{NODE.format("k")}</group></group>{NODE.format("m")}'),
    Case("private param goes into includes", '<param name="~a" value="1"/><include file="$(dirname)/sub.launch"/>', {"sub.launch": included(N)}),
    Case("private param stays in an include that is the first", '<include file="$(dirname)/sub.launch"/>' + N, {"sub.launch": included('<param name="~a" value="1"/>')}),
    Case("private param leaks out of an include that has some", '<param name="~b" value="0"/><include file="$(dirname)/sub.launch"/>' + N, {"sub.launch": included('<param name="~a" value="1"/>')}),
    Case("private param against the node's", '<param name="~a" value="1"/><node pkg="p" type="t" name="n"><param name="a" value="2"/></node>'),
    Case("private param against the node's rosparam", '<param name="~a" value="1"/><node pkg="p" type="t" name="n"><rosparam>a: 2</rosparam></node>'),
    Case("rosparam private at launch level", '<rosparam param="~a">1</rosparam>'),
    Case("rosparam of everything", f"<rosparam><![CDATA[{YAML}]]></rosparam>"),
    Case("rosparam file of everything", '<rosparam file="$(dirname)/a.yaml"/>', {"a.yaml": YAML}),
    Case("rosparam file into a namespace", '<group ns="g"><rosparam command="load" file="$(dirname)/a.yaml" ns="h"/></group>', {"a.yaml": "b: 1"}),
    Case("rosparam file into a param", '<rosparam command="load" file="$(dirname)/a.yaml" param="/x/y"/>', {"a.yaml": "b: 1"}),
    Case("rosparam with ns and param", '<rosparam ns="a" param="b">1</rosparam>'),
    Case("rosparam with ns and a global param", '<rosparam ns="a" param="/b">1</rosparam>'),
    Case("rosparam file twice", '<rosparam file="$(dirname)/a.yaml" ns="x"/><rosparam file="$(dirname)/a.yaml" ns="y"/>', {"a.yaml": "b: 1"}),
    Case("rosparam merges", "<rosparam>a: {b: 1, c: 2}</rosparam><rosparam>a: {c: 3, d: 4}</rosparam>"),
    Case("rosparam of a list", '<rosparam param="a">[1, 2, x]</rosparam>'),
    Case("rosparam of a map at a param", '<rosparam param="a">b: 1</rosparam>'),
    Case("rosparam of nothing", "<rosparam/><rosparam>  </rosparam><rosparam># a comment\n</rosparam>"),
    Case("rosparam of an empty map clears nothing", '<param name="a/b" value="1"/><rosparam>a: {}</rosparam>'),
    Case("rosparam around a comment", "<rosparam>a: 1\n<!-- no: 1 -->b: 2</rosparam>"),
    Case("rosparam subst_value", '<arg name="x" default="v"/><rosparam subst_value="true">a: $(arg x)\nb: $(dirname)/c\nd: $(optenv NONE 5)</rosparam>'),
    Case("rosparam subst_value in a file", '<arg name="x" default="1.5"/><rosparam file="$(dirname)/s/a.yaml" subst_value="True"/>', {"s/a.yaml": "a: $(arg x)\nb: $(dirname)"}),
    Case("rosparam without subst_value", '<rosparam subst_value="false">a: $(arg x)</rosparam>'),
    Case("rosparam subst_value of eval", '<arg name="x" default="2"/><rosparam param="a" subst_value="true">$(eval x * 2)</rosparam>'),
    Case("rosparam if", '<rosparam if="false">a: 1</rosparam><rosparam unless="false">b: 1</rosparam>'),
    Case("rosparam delete deletes nothing of the launch", '<param name="a" value="1"/><rosparam command="delete" param="a"/>'),
    Case("rosparam dump", '<rosparam command="dump" file="$(dirname)/dump.yaml"/>'),
    Case("clear_params of a group", '<param name="g/a" value="1"/><group ns="g" clear_params="true"><param name="b" value="2"/></group>'),
    Case("clear_params of a node", '<node pkg="p" type="t" name="n" clear_params="true"><param name="a" value="1"/></node>'),
    Case("clear_params empty", '<group clear_params=""/>'),
    Case("env", '<env name="A" value="1"/><env name="B" value=""/><group><env name="A" value="2"/><node pkg="p" type="t" name="n"><env name="C" value="$(dirname)"/></node></group>' + NODE.format("m")),
    Case("env if", '<env name="A" value="1" if="false"/>' + N),
    Case("env of an include", '<env name="A" value="1"/><include file="$(dirname)/sub.launch"><env name="B" value="2"/></include>' + NODE.format("m"), {"sub.launch": included(N)}),
    Case("machine", '<machine name="m" address="localhost" ssh-port="22" timeout="1.5" default="never"/>'),
    *(Case(f"param {type} {text!r}", f'<param name="a" type="{type}" value="{text}"/>') for type in ("auto", "str", "string", "AUTO") for text in TEXTS),
    *(Case(f"param {type} {text!r}", f'<param name="a" type="{type}" value="{text}"/>') for type, texts in {
        "int": ("1", " -1 ", "2147483647", "1_000"), "double": ("1", "1.5", "inf", "1e400"), "bool": ("true", "1", " FALSE ", "0"),
        " Boolean ": ("True",), "yaml": ("1", "[1, 2]", "{a: 1}", "text", "yes", "'1'"),
    }.items() for text in texts),
)

DOUBTED = (
    Case("int of a word", '<param name="a" type="int" value="x"/>'),
    Case("int of a float", '<param name="a" type="int" value="1.5"/>'),
    Case("int too large", '<param name="a" value="2147483648"/>'),
    Case("int too small", '<param name="a" value="-2147483649"/>'),
    Case("double of a word", '<param name="a" type="double" value="x"/>'),
    Case("bool of a word", '<param name="a" type="bool" value="yes"/>'),
    Case("type of nothing", '<param name="a" type="float" value="1"/>'),
    Case("yaml of none", '<param name="a" type="yaml" value="[1"/>'),
    Case("yaml of null", '<param name="a" type="yaml" value="null"/>'),
    Case("textfile missing", '<param name="a" textfile="$(dirname)/no.txt"/>'),
    Case("binfile missing", '<param name="a" binfile="$(dirname)/no.bin"/>'),
    Case("command cat missing", '<param name="a" command="cat $(dirname)/no.txt"/>'),
    Case("rosparam file missing", '<rosparam file="$(dirname)/no.yaml" param="a"/>'),
    Case("rosparam broken", '<rosparam param="a">[1</rosparam>'),
    Case("rosparam of a python tag", '<rosparam>a: !!python/object/apply:os.system ["true"]</rosparam>'),
    Case("rosparam of an unknown tag", "<rosparam>a: !unknown 1</rosparam>"),
    Case("rosparam of null", "<rosparam>a: null</rosparam>"),
    Case("rosparam of a date", "<rosparam>a: 2001-01-01</rosparam>"),
    Case("rosparam of a large int", "<rosparam>a: 4294967296</rosparam>"),
    Case("rosparam radians of a name", "<rosparam>a: rad(x)</rosparam>"),
    Case("rosparam degrees of a word", "<rosparam>a: deg(x)</rosparam>"),
)

REFUSED_PARAMETERS = (
    Case("param without a name", '<param value="1"/>'),
    Case("param without a value", '<param name="a"/>'),
    Case("param with two values", '<param name="a" value="1" textfile="x"/>'),
    Case("rosparam of another command", '<rosparam command="set"/>'),
    Case("rosparam delete with a file", '<rosparam command="delete" param="a" file="x"/>'),
    Case("rosparam subst_value of a number", '<rosparam subst_value="1">a: 1</rosparam>'),
    Case("clear_params without a namespace", '<group clear_params="true"/>'),
    Case("clear_params of a number", '<group ns="a" clear_params="1"/>'),
    Case("pass_all_args of a number", '<include file="$(dirname)/x.launch" pass_all_args="1"/>', {"x.launch": included("")}),
    Case("env without a name", '<env value="1"/>'),
    Case("env of an empty name", '<env name="" value="1"/>'),
    Case("env without a value", '<env name="A"/>'),
)

UNRESOLVED_PARAMETERS = (
    Case("rosparam of a scalar", "<rosparam>1</rosparam>"),
    Case("rosparam of an int as a key", "<rosparam>1: a</rosparam>"),
    Case("rosparam of a bool as a key", "<rosparam>a: {true: 1}</rosparam>"),
    Case("rosparam of two documents", "<rosparam>--- {a: 1}\n--- {b: 1}</rosparam>"),
    Case("rosparam file missing at the root", '<rosparam file="$(dirname)/no.yaml"/>'),
    Case("rosparam of an alias that is nothing", "<rosparam>a: *b</rosparam>"),
    Case("machine without an address", '<machine name="m"/>'),
    Case("machine with an environment", '<machine name="m" address="a"><env name="A" value="1"/></machine>'),
    Case("machine without a timeout", '<machine name="m" address="a" timeout="0"/>'),
    Case("machine of a strange port", '<machine name="m" address="a" ssh-port="x"/>'),
    Case("machine of a strange default", '<machine name="m" address="a" default="x"/>'),
)
