"""Constructs of C++ that call: functions, lambdas, templates, callbacks."""

from cpp_programs import Writer


def function(w: Writer):
    e, name = w.endpoint(), w.unused("f")
    first, second = w.names(e, 2)
    w.top += [
        f"namespace n{name} {{",
        f"{e.type} {name}({w.handle}h, const std::string & name, int n = 0);",
        f"{e.type} {name}({w.handle}h, const std::string & name, int) {{ return {e.make('name')}; }}",
        "}",
    ]
    w.body += [
        f"auto made{name} = n{name}::{name}(h, {w.text(first)});",
        f"{{ using namespace n{name}; {name}(h, {w.text(second)}, 1); }}",
    ]


def overloads(w: Writer):
    e, name = w.endpoint(), w.unused("f")
    names = w.names(e, 3)
    kinds = ("int", "double", "const std::string &")
    w.top += [
        f"void {name}({w.handle}h, {kind}) {{ {e.literal(made)}; }}"
        for kind, made in zip(kinds, names, strict=True)
    ]
    calls = [f"{name}(h, 1);", f"{name}(h, 1.5);", f'{name}(h, std::string("s"));']
    w.random.shuffle(calls)
    w.body += calls


def lambdas(w: Writer):
    e, name = w.endpoint(), w.unused("f")
    names = w.names(e, 4)
    w.body += [
        f'std::string kept{name} = "{names[0]}";',
        f"auto {name} = [&h, kept{name}] {{ {e.make(f'kept{name}')}; }};",
        f'kept{name} = "dead{w.id}";',
        f"{name}();",
        f"[&, text = std::string({w.text(names[1])})]() mutable {{ {e.make('text')}; }}();",
        f"auto any{name} = [&](const auto & text, auto... rest) {{ {e.make('text')}; }};",
        f'any{name}("{names[2]}");',
        f'any{name}(std::string("{names[3]}"), 1, 2);',
    ]


def stored_functions(w: Writer):
    e, made = w.endpoint(), w.unused("f")
    names = w.names(e, 3)
    literal = [e.literal(name) for name in names]
    forms = (
        [
            f"std::vector<std::function<void()>> {made};",
            f"{made}.push_back([&] {{ {literal[0]}; }});",
            f"{made}.emplace_back([&] {{ {literal[1]}; }});",
            f"{made}.push_back(std::bind([&](int) {{ {literal[2]}; }}, 1));",
            f"for (auto & call : {made}) call();",
        ],
        [
            f"std::map<std::string, std::function<void()>> {made} = {{",
            f'  {{"a", [&] {{ {literal[0]}; }}}}, {{"b", [&] {{ {literal[1]}; }}}}}};',
            f'{made}["c"] = [&] {{ {literal[2]}; }};',
            f'{made}["a"]();\n{made}.at("b")();',
            f'if (auto it = {made}.find("c"); it != {made}.end()) it->second();',
        ],
        [
            f"std::function<void()> {made} = nullptr;",
            f"{made} = [&] {{ {literal[0]}; }};\nif ({made}) {made}();",
            f"{made} = [&, before = {made}] {{ {literal[1]}; {literal[2]}; }};\n{made}();",
        ],
    )
    w.body += w.random.choice(forms)


def never_called(w: Writer):
    e, made = w.endpoint(), w.unused("f")
    name = w.names(e, 1)[0]
    w.body += [
        f"std::map<int, std::function<void()>> {made};",
        f"{made}[0] = [&] {{ {w.dead(e)}; }};",
        f"{made}[1] = [&] {{ {e.make(w.text(name))}; }};",
        f"{made}[1]();",
    ]


def handed_on(w: Writer):
    e, apply, twice = w.endpoint(), w.unused("apply"), w.unused("twice")
    names = w.names(e, 2)
    w.top += [
        w.random.choice([
            f"template <class F> void {apply}(F && f) {{ f(); }}",
            f"void {apply}(const std::function<void()> & f) {{ if (f) f(); }}",
            f"void {apply}(std::function<void()> f) {{ auto g = std::move(f); g(); }}",
        ]),
        f"template <class F, class... T> auto {twice}(F f, T &&... t) {{",
        "  return f(std::forward<T>(t)...);",
        "}",
    ]  # fmt: skip
    w.body += [
        f"{apply}([&] {{ {e.literal(names[0])}; }});",
        f"{twice}([&](std::string a, std::string b) {{ return {e.make('a + b')}; }},",
        f'  "{names[1][:2]}", std::string("{names[1][2:]}"));',
    ]


def bound(w: Writer):
    e, name = w.endpoint(), w.unused("f")
    names = w.names(e, 2)
    w.top.append(f"void {name}({w.handle}h, const std::string & name) {{ {e.make('name')}; }}")
    w.body += [
        f'auto bound{name} = std::bind({name}, {_by_reference(w)}, "{names[0]}");',
        f"bound{name}();",
        f"auto rest{name} = std::bind(&{name}, {_by_reference(w)}, std::placeholders::_1);",
        f'rest{name}(std::string("{names[1]}"));',
    ]


def _by_reference(w: Writer) -> str:
    return "std::ref(h)" if w.handle.endswith("&") else "h"


def pointers_to_functions(w: Writer):
    e, name = w.endpoint(), w.unused("f")
    names = w.names(e, 2)
    w.top += [
        f"void {name}({w.handle}h, const char * name) {{ {e.make('name')}; }}",
        f"void other{name}({w.handle}h, const char *) {{ {w.dead(e)}; }}",
        f"using Call{name} = void (*)({w.handle}, const char *);",
    ]
    w.body += [
        f"Call{name} call{name} = &{name};",
        f'call{name}(h, "{names[0]}");',
        f'(*call{name})(h, "{names[1]}");',
    ]


def templates(w: Writer):
    e, name = w.endpoint(), w.unused("F")
    names = w.names(e, 2)
    head, _, number = names[1].rpartition("_")
    w.top += [
        f"template <class T, int N> struct {name} {{",
        f"  {e.type} made;",
        f"  {name}({w.handle}h, T text) {{ made = {e.make('text + std::to_string(N)')}; }}",
        "};",
        f'template <int N> std::string text{name}() {{ return "{head}_" + std::to_string(N); }}',
    ]
    first, _, last = names[0].rpartition("_")
    w.body += [
        f'{name}<std::string, {last}> made{name}(h, "{first}_");',
        f"{e.make(f'text{name}<{number}>()')};",
    ]


def packs(w: Writer):
    e, name = w.endpoint(), w.unused("f")
    names = w.names(e, 3)
    forms = (
        [
            f"template <class... T> void {name}({w.handle}h, T... names) {{ ({e.make('names')}, ...); }}"
        ],
        [
            f"inline void {name}({w.handle}) {{}}",
            f"template <class H, class... T> void {name}({w.handle}h, H first, T... rest) {{",
            f"  {e.make('first')};",
            f"  {name}(h, rest...);",
            "}",
        ],
        [
            f"template <class... T> void {name}({w.handle}h, const T &... names) {{",
            f"  for (const std::string & name : {{std::string(names)...}}) {{ {e.make('name')}; }}",
            "}",
        ],
        [
            f"template <class... T> void {name}({w.handle}h, T &&... names) {{",
            f"  int all[] = {{({e.make('names')}, 0)...}};",
            "  (void)all;",
            "}",
        ],
    )
    w.top += w.random.choice(forms)
    w.body.append(f"{name}(h, {w.quoted(names)});")


def lists_as_arguments(w: Writer):
    e, name = w.endpoint(), w.unused("f")
    names = w.names(e, 2)
    kinds = ("std::vector<std::string>", "const std::vector<std::string> &")
    kinds += ("std::initializer_list<const char *>", "std::initializer_list<std::string>")
    w.top += [
        f"void {name}({w.handle}h, {w.random.choice(kinds)} names) {{",
        f"  for (auto & name : names) {{ {e.make('name')}; }}",
        "}",
    ]
    w.body.append(f"{name}(h, {{{w.quoted(names)}}});")


def braces_returned(w: Writer):
    e, name, struct = w.endpoint(), w.unused("f"), w.unused("S")
    names = w.names(e, 3)
    w.top += [
        f"struct {struct} {{ int n; std::string name; }};",
        f'std::map<int, std::string> {name}() {{ return {{{{1, "{names[0]}"}}, {{2, "{names[1]}"}}}}; }}',
        f'{struct} one{name}() {{ return {{3, "{names[2]}"}}; }}',
    ]
    w.body += [
        f"for (auto & [key, name] : {name}()) {{ {e.make('name')}; }}",
        f"{e.make(f'one{name}().name')};",
    ]


def written_through(w: Writer):
    e, name = w.endpoint(), w.unused("f")
    names = w.names(e, 2)
    w.top += [
        f'void {name}(std::string & a, std::string * b) {{ a = "{names[0]}"; *b += "{names[1][-1]}"; }}'
    ]
    w.body += [
        f'std::string a{name}, b{name} = "{names[1][:-1]}";',
        f"{name}(a{name}, &b{name});",
        f"{e.make(f'a{name}')};\n{e.make(f'b{name}')};",
    ]


def invoked(w: Writer):
    e, name = w.endpoint(), w.unused("f")
    names = w.names(e, 3)
    w.top += [
        f"struct S{name} {{ void go({w.handle}h, std::string name) {{ {e.make('name')}; }} }};",
        f"std::once_flag once{name};",
    ]
    w.body += [
        e.literal(names[0]) + ";",
        f"S{name} s{name};",
        f's{name}.go({_by_reference(w)}, "{names[1]}");',
        f"std::call_once(once{name}, [&] {{ {e.literal(names[2])}; }});",
    ]


def threads(w: Writer):
    e, name = w.endpoint(), w.unused("C")
    names = w.names(e, 3)
    w.top += [
        f"struct {name} {{",
        f"  {w.library.member} h;",
        f"  void run(std::string name) {{ {e.make('name')}; }}",
        "};",
    ]
    w.body += [
        f"{name} made{name}{{h}};",
        f'std::thread(&{name}::run, &made{name}, "{names[0]}").join();',
        f"std::vector<std::thread> all{name};",
        f'all{name}.emplace_back([&] {{ made{name}.run("{names[1]}"); }});',
        f'all{name}.emplace_back(&{name}::run, &made{name}, "{names[2]}");',
        f"for (auto & one : all{name}) one.join();",
    ]


def timers(w: Writer):
    e, name = w.endpoint(), w.unused("timer")
    made = w.names(e, 1)[0]
    argument = "const ros::WallTimerEvent &" if w.library.ros == 1 else ""
    callback = f"[h = h]({argument}) mutable {{ {e.make(w.text(made))}; }}"
    kinds = {1: f"boost::function<void({argument})>", 2: "std::function<void()>"}
    w.body += [
        f"{kinds[w.library.ros]} {name} = {callback};",
        w.library.timer.format(id=name, h="h", callback=name),
    ]


def recursive_lambda(w: Writer):
    e, prefix, name = w.endpoint(), w.unused("t"), w.unused("f")
    for at in (1, 2):
        w.expect(e, f"{prefix}{at}")
    w.body += [
        f"std::function<void(int)> {name} = [&](int n) {{",
        "  if (n == 0) return;",
        f"  {e.numbered(prefix, 'n')};",
        f"  {name}(n - 1);",
        "};",
        f"{name}(2);",
    ]


FUNCTIONS = [
    *(function, overloads, lambdas, stored_functions, never_called, handed_on, bound),
    *(pointers_to_functions, templates, packs, lists_as_arguments, braces_returned),
    *(written_through, invoked, threads, timers, recursive_lambda),
]
