"""Places of C++ where a call may stand, and shapes of functions and classes that are rarely used."""

from cpp_programs import Writer


def odd_expressions(w: Writer):
    e, f = w.endpoint(), w.unused("f")
    w.top += [
        f"{e.type} {f}({w.handle}h, const std::string & name) {{ return {e.make('name')}; }}",
        f"struct S{f} {{ {e.type} made; int n = 0; }};",
        f"int count{f}(const {e.type} &) {{ return 1; }}",
    ]
    forms = (
        "int a[2] = {{0, 1}}; (void)a[count{f}({call})];",
        "if (count{f}({call}) > 0) {{ }}",
        "while (count{f}({call}) > 1) {{ }}",
        "for (auto one = {call}; false; ) {{ }}",
        "switch (count{f}({call})) {{ default: break; }}",
        "auto all = std::vector<{type}>{{{call}}};",
        "auto one = std::make_shared<S{f}>(S{f}{{{call}}});",
        "auto * one = new S{f}{{{call}, 1}};\n(void)one;",
        "[](auto made) {{ (void)made; }}({call});",
        "[made = {call}] {{ }}();",
        "do {{ }} while (count{f}({call}) == 0);",
        "(void)({call});",
        "auto one = static_cast<bool>(count{f}({call})) ? 1 : 2; (void)one;",
        "for (int i = 0; i < count{f}({call}); i++) {{ break; }}",
        "for (auto n = {call}; int one : {{1}}) {{ (void)one; (void)n; }}",
        "{{ auto made = std::make_pair(1, {call}); (void)made; }}",
        "const auto & made = {call}; (void)made;",
        "auto && [made, n] = S{f}{{{call}, 2}}; (void)made; (void)n;",
        "std::make_unique<{type}>({call});",
        "{type} all[] = {{{call}}}; (void)all;",
        "if (bool yes = true; yes && count{f}({call})) [[likely]] {{ }}",
        "try {{ throw count{f}({call}); }} catch (int) {{ }}",
        "std::vector<int>(count{f}({call})).size();",
        "-count{f}({call}) + (2 * count{f}({call2}));",
    )
    for form in w.random.sample(forms, 4):
        name, other = w.unused("t"), w.unused("t")
        w.expect(e, name)
        if "{call2}" in form:
            w.expect(e, other)
        call, second = (f'{f}(h, "{one}")' for one in (name, other))
        w.body.append(f"{{ {form.format(f=f, call=call, call2=second, type=e.type)} }}")


def decided_conditions(w: Writer):
    e, name = w.endpoint(), w.unused("s")
    dead, live = w.dead(e), w.names(e, 1)[0]
    true = (
        '{s} == "arm_left"', "!{s}.empty()", "{s}.size() == 8", '{s}.find("left") != std::string::npos',
        '{s}.substr(0, 3) == "arm"', '{s}.compare("arm_left") == 0', "{n} % 3 == 1",
        "({n} & 4) != 0", "({n} >> 1) == 2 && {n} != 3", '{s} != "b" || {n} < 0', "{n} / 3 == 1",
        "std::max({n}, 2) == 4", '{s}[0] == \'a\'', "{s}.back() == 't'", "!({n} == 5)",
        'std::string("a") + "b" == "ab"', "{n} > 3 ? true : false", "std::stoi(\"12\") == 12",
        "static_cast<double>({n}) > 3.5", "{n} == 4u", '{s} < "b"',
        '{s}.rfind("arm", 0) == 0', "strcmp({s}.c_str(), \"arm_left\") == 0",
    )  # fmt: skip
    condition = w.random.choice(true).format(s=name, n=f"n{name}")
    w.body += [
        f'std::string {name} = "arm_left";',
        f"const int n{name} = 4;",
        f"if ({condition}) {{ {e.literal(live)}; }} else {{ {dead}; }}",
    ]


def specialisations(w: Writer):
    e, name = w.endpoint(), w.unused("T")
    names = w.names(e, 4)
    w.top += [
        f'template <class T> struct {name} {{ static std::string text() {{ return "{names[0]}"; }} }};',
        f'template <> struct {name}<int> {{ static std::string text() {{ return "{names[1]}"; }} }};',
        f"template <class T> std::string f{name}();",
        f'template <> std::string f{name}<int>() {{ return "{names[2]}"; }}',
        f'template <> std::string f{name}<double>() {{ return "{names[3]}"; }}',
    ]
    w.body += [
        f"{e.make(f'{name}<double>::text()')};",
        f"{e.make(f'{name}<int>::text()')};",
        f"{e.make(f'f{name}<int>()')};",
        f"{e.make(f'f{name}<double>()')};",
    ]


def odd_functions(w: Writer):
    e, name = w.endpoint(), w.unused("f")
    forms = (
        "void {f}({h}h) try {{ {call}; }} catch (...) {{ }}",
        "auto {f}({h}h) -> void {{ {call}; }}",
        "inline namespace v{f} {{ void {f}({h}h) {{ {call}; }} }}",
        "namespace {{ void {f}({h}h) {{ {call}; }} }}",
        'extern "C" {{ void {f}({h}h) {{ {call}; }} }}',
        "constexpr auto {f} = []({h}h) {{ {call}; }};",
        "static void {f}({h}h) noexcept(false);\nstatic void {f}({h}h) noexcept(false) {{ {call}; }}",
        "[[maybe_unused]] inline void {f}({h}h) {{ {{ {{ {call}; }} }} ; }}",
        "decltype(auto) {f}({h}h) {{ return {call}; }}",
        "struct O{f} {{ struct I {{ void g({h}h) const; }}; }};\n"
        "void O{f}::I::g({h}h) const {{ {call}; }}\nvoid {f}({h}h) {{ O{f}::I().g(h); }}",
        "template <class H> requires true void {f}(H && given) {{ {h}h = given; {call}; }}",
        "void {f}({h}h, auto... rest) {{ (void)sizeof...(rest); {call}; }}",
        "template <class T = int, class H> auto {f}(H & given) -> std::enable_if_t<true, int> {{\n"
        "  {h}h = given; {call}; return 1; }}",
        "void {f}(auto && given) {{ {h}h = given; {call}; }}",
        "union U{f} {{ int n; float x; void g({h}h) {{ {call}; }} }};\n"
        "void {f}({h}h) {{ U{f} u; u.n = 1; u.g(h); }}",
        "void {f}({h}h) {{ auto g = [](auto self, {h}h, int n) -> void {{\n"
        "  if (n > 0) {{ {call}; self(self, h, n - 1); }} }};\n  g(g, h, 1); }}",
        "#define BODY{f} {{ {call}; }}\nvoid {f}({h}h) BODY{f}",
        "using H{f} = std::remove_reference_t<{h}>;\nvoid {f}(H{f} & h) {{ {call}; }}",
    )
    for at, form in enumerate(w.random.sample(forms, 3)):
        made = w.unused("t")
        w.expect(e, made)
        call = e.literal(made)
        w.top.append(form.format(f=f"{name}_{at}", h=w.handle, call=call))
        if form.startswith(("template <class T = int", "using")) and w.library.ros > 1:
            w.body.append(f"{{ auto p = h; {name}_{at}(p); }}")
        else:
            w.body.append(f"{name}_{at}(h);")


def odd_classes(w: Writer):
    e, name = w.endpoint(), w.unused("C")
    names = w.names(e, 5)
    w.top += [
        f"struct A{name} {{",
        f"  explicit A{name}({w.handle}h) {{ {e.literal(names[0])}; }}",
        f"  void go({w.handle}h) {{ {e.literal(names[1])}; }}",
        "};",
        f"struct B{name} {{",
        f'  B{name}({w.handle}h, std::string a = "{names[2]}") : made{{{e.make("a")}}} {{}}',
        f"  {e.type} made;",
        "};",
        f"class {name} : private A{name}, public B{name} {{",
        "public:",
        f'  explicit {name}({w.handle}h) : A{name}(h), B{name}{{h}}, b_(h, "{names[3]}") {{',
        f"    A{name}::go(h);",
        "  }",
        f"  ~{name}() {{ }}",
        "private:",
        f"  B{name} b_;",
        "};",
        f"struct D{name} : public {name} {{",
        f"  using {name}::{name};",
        f"  void go({w.handle}h) {{ {e.literal(names[4])}; }}",
        "};",
    ]
    w.body += [f"D{name} d{name}(h);", f"d{name}.go(h);"]


def state_machines(w: Writer):
    e, name = w.endpoint(), w.unused("M")
    names = w.names(e, 3)
    w.top += [
        f"class {name} {{",
        "  enum State { INIT, READY, DONE } state_ = INIT;",
        f"  {w.library.member} h;",
        "public:",
        f"  explicit {name}({w.library.member} handle) : h(handle) {{}}",
        "  bool step() {",
        "    switch (state_) {",
        f"      case INIT: {e.literal(names[0])}; state_ = READY; return true;",
        f"      case READY: {{ {e.literal(names[1])}; state_ = DONE; break; }}",
        f"      case DONE: {e.literal(names[2])}; return false;",
        "    }",
        "    return true;",
        "  }",
        "};",
    ]
    w.body += [f"{name} m{name}(h);", f"while (m{name}.step()) {{ }}"]


def names_read(w: Writer):
    e, name = w.endpoint(), w.unused("s")
    names = w.names(e, 2)
    view = f'std::string_view("{names[1]}").data()'
    w.body += [
        w.random.choice([
            f'std::istringstream {name}("{names[0]} {names[1]}");\n'
            f"for (std::string one; {name} >> one; ) {{ {e.make('one')}; }}",
            f'std::stringstream {name}("{names[0]},{names[1]}");\nstd::string one{name};\n'
            f"while (std::getline({name}, one{name}, ',')) {{ {e.make(f'one{name}')}; }}",
            f'std::string {name} = "{names[0]} {names[1]}";\nauto at{name} = {name}.find(\' \');\n'
            f"{e.make(f'{name}.substr(0, at{name})')};\n{e.make(f'{name}.substr(at{name} + 1)')};",
            f'char {name}[64];\nsnprintf({name}, sizeof({name}), "%s", "{names[0]}");\n'
            f"{e.make(name)};\n{e.make(view)};",
        ]),
    ]  # fmt: skip


ODD_PLACES = [
    *(odd_expressions, decided_conditions, specialisations, odd_functions, odd_classes),
    *(state_machines, names_read),
]
