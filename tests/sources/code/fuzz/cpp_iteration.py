"""Constructs of C++ that go through what containers hold: iterators, algorithms, ranges."""

from cpp_programs import Writer


def other_loops(w: Writer):
    e, made = w.endpoint(), w.unused("v")
    names = w.names(e, 2)
    one = e.make("one")
    loops = (
        f"std::ranges::for_each({made}, [&](const auto & one) {{ {one}; }});",
        f"for (auto it = {made}.rbegin(); it != {made}.rend(); ++it) {{ {e.make('*it')}; }}",
        f"for (auto it = std::begin({made}); it != std::end({made}); it++) {{ {e.make('it->c_str()')}; }}",
        f"(void)std::accumulate({made}.begin(), {made}.end(), 0, [&](int n, const auto & one) {{ {one}; return n + 1; }});",
        f"(void)std::any_of({made}.begin(), {made}.end(), [&](const auto & one) {{ {one}; return false; }});",
        f"(void)std::count_if({made}.begin(), {made}.end(), [&](const auto & one) {{ {one}; return true; }});",
        f"std::for_each_n({made}.begin(), 2, [&](const auto & one) {{ {one}; }});",
        f"std::for_each({made}.rbegin(), {made}.rend(), [&](const auto & one) {{ {one}; }});",
        f"for (size_t i = {made}.size(); i-- > 0; ) {{ {e.make(f'{made}[i]')}; }}",
        f"for (size_t i = 0; i < {made}.size(); i += 2) {{ {e.make(f'{made}.at(i)')}; {e.make(f'{made}[i + 1]')}; }}",
        f"{e.make(f'{made}.front()')};\n{e.make(f'{made}.back()')};",
        f"{e.make(f'*{made}.begin()')};\n{e.make(f'*std::next({made}.begin())')};",
        f"{e.make(f'{made}.begin()[0]')};\n{e.make(f'*({made}.begin() + 1)')};",
        f"for (auto & one : {made} | std::views::reverse) {{ {one}; }}",
        f"for (auto one = {made}.data(); one != {made}.data() + 2; ++one) {{ {e.make('*one')}; }}",
        f"while (!{made}.empty()) {{ {e.make(f'{made}.back()')}; {made}.pop_back(); }}",
        f"for (const auto & one : std::as_const({made})) {{ {one}; }}",
        f"for (auto && one : std::vector<std::string>({made})) {{ {one}; }}",
        f"auto it{made} = {made}.begin();\n{e.make(f'*it{made}')};\n++it{made};\n{e.make(f'*it{made}')};",
        f"auto it{made} = {made}.begin();\n{e.make(f'*it{made}++')};\n{e.make(f'*it{made}')};",
        f"auto it{made} = {made}.end();\nwhile (it{made} != {made}.begin()) {{ --it{made}; {e.make(f'*it{made}')}; }}",
    )
    w.body += [f"std::vector<std::string> {made} = {{{w.quoted(names)}}};", w.random.choice(loops)]


def taken_apart(w: Writer):
    e, made = w.endpoint(), w.unused("s")
    names = w.names(e, 2)
    w.top.append(f"struct S{made} {{ std::string a; int n = 1; std::string b; }};")
    w.body += [
        f'S{made} {made}{{"{names[0]}", 2, "{names[1]}"}};',
        f"{{ auto & [a, n, b] = {made}; {e.make('a')}; {e.make('b')}; (void)n; }}",
    ]


def maps_of_lists(w: Writer):
    e, made = w.endpoint(), w.unused("m")
    names = w.names(e, 3)
    w.body += [
        f"std::unordered_map<std::string, std::vector<std::string>> {made};",
        f'{made}["a"].push_back("{names[0]}");',
        f'{made}["a"].push_back("{names[1]}");',
        f'{made}["b"] = {{"{names[2]}"}};',
        f"for (auto & [key, list] : {made}) for (auto & name : list) {{ {e.make('name')}; }}",
    ]


def found_entries(w: Writer):
    e, made = w.endpoint(), w.unused("m")
    names, dead = w.names(e, 3), w.dead(e)
    entry = e.make(f'{made}.at("b")')
    w.body += [
        f'const std::map<std::string, std::string> {made}{{{{"a", "{names[0]}"}}, {{"b", "{names[1]}"}}}};',
        f'auto it{made} = {made}.find("a");',
        f"if (it{made} != {made}.end()) {{ {e.make(f'it{made}->second')}; }} else {{ {dead}; }}",
        f'if ({made}.find("z") != {made}.end()) {{ {dead}; }}',
        f'if ({made}.count("b")) {{ {entry}; }}',
        f'if ({made}.contains("y")) {{ {dead}; }} else {{ {e.literal(names[2])}; }}',
    ]


def queues(w: Writer):
    e, made = w.endpoint(), w.unused("q")
    names = w.names(e, 2)
    kind, top = w.random.choice([("stack", "top"), ("queue", "front")])
    w.body += [
        f"std::{kind}<std::string> {made};",
        f'{made}.push("{names[0]}");',
        f'{made}.emplace("{names[1]}");',
        f"while (!{made}.empty()) {{ {e.make(f'{made}.{top}()')}; {made}.pop(); }}",
    ]


def state_of_members(w: Writer):
    e, name = w.endpoint(), w.unused("M")
    names = w.names(e, 3)
    w.top += [
        f"class {name} {{",
        "public:",
        f"  explicit {name}({w.library.member} given) : h(given) {{ fill(); }}",
        f"  {name} & add(std::string one) {{ names_.push_back(std::move(one)); return *this; }}",
        "  void go() { for (auto & one : names_) make(one); names_.clear(); }",
        "private:",
        f'  void fill() {{ add("{names[0]}").add("{names[1]}"); }}',
        f"  void make(const std::string & one) {{ made_[one] = {e.make('one')}; }}",
        f"  {w.library.member} h;",
        "  std::vector<std::string> names_;",
        f"  std::map<std::string, {e.type}> made_;",
        "};",
    ]
    w.body += [f"{name} m{name}(h);", f"m{name}.go();", f'm{name}.add("{names[2]}").go();']


def erased(w: Writer):
    e, made = w.endpoint(), w.unused("v")
    name = w.names(e, 1)[0]
    w.body += [
        f'std::map<int, std::string> {made}{{{{1, "dead{w.id}"}}, {{2, "{name}"}}}};',
        w.random.choice([f"{made}.erase(1);", f"{made}.erase({made}.begin());"]),
        f"for (auto & [key, name] : {made}) {{ {e.make('name')}; }}",
    ]


ITERATION = [
    *(other_loops, taken_apart, maps_of_lists, found_entries, queues, state_of_members, erased)
]
