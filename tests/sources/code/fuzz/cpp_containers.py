"""Constructs of C++ that hold names or endpoints: braces, containers, algorithms."""

from cpp_programs import Writer


def map_assigned_in_braces(w: Writer):
    e, map_, struct = w.endpoint(), w.unused("map"), w.unused("S")
    first, second = w.names(e, 2)
    w.top.append(f"struct {struct} {{ {e.type} made; int n; }};")
    w.body += [
        f"std::map<std::string, {struct}> {map_};",
        f"{map_} = {{",
        f'  {{"a", {{{e.make(w.text(first))}, 1}}}},',
        f'  {{"b", {struct}{{{e.make(w.text(second))}, 2}}}},',
        "};",
    ]
    _make_of_keys(w, map_)


def _make_of_keys(w: Writer, map_: str):
    """Loop over a map from "a" to "b": what its keys name is made too."""
    e, prefix = w.endpoint(), w.unused("t")
    w.expect(e, f"{prefix}a")
    w.expect(e, f"{prefix}b")
    made = e.make(f'"{prefix}" + key')
    w.body.append(f"for (auto & [key, value] : {map_}) {{ {made}; }}")


def map_of_pointers_assigned_in_braces(w: Writer):
    e, map_, struct = w.endpoint(), w.unused("map"), w.unused("S")
    first, second = w.names(e, 2)
    w.top += [
        f"struct {struct} {{",
        f"  {e.type} made;",
        f"  explicit {struct}(int) {{}}",
        f"  void make({w.handle}h, const std::string & name) {{ made = {e.make('name')}; }}",
        "};",
    ]
    w.body += [
        f"std::map<int, std::shared_ptr<{struct}>> {map_};",
        f"{map_} = {{{{0, std::make_shared<{struct}>(1)}}, {{1, std::make_shared<{struct}>(2)}}}};",
        f"{map_}[0]->make(h, {w.text(first)});",
        f"{map_}[1]->make(h, {w.text(second)});",
    ]


def struct_assigned_in_braces(w: Writer):
    e, struct, inner, one = w.endpoint(), w.unused("S"), w.unused("S"), w.unused("s")
    first, second, third = w.names(e, 3)
    w.top += [
        f"struct {inner} {{ int n; {e.type} made; }};",
        f"struct {struct} {{ {e.type} made; {inner} within; std::vector<std::string> names; }};",
    ]
    w.body += [
        f"{struct} {one};",
        f'{one} = {{.made = {e.make(w.text(first))}, .names = {{"{third}"}}}};',
        f"{one}.within = {{.n = 1, .made = {e.make(w.text(second))}}};",
        f"for (auto & name : {one}.names) {{ {e.make('name')}; }}",
    ]


def aggregate_in_braces(w: Writer):
    e, struct, made = w.endpoint(), w.unused("S"), w.unused("s")
    names = w.names(e, 2)
    w.top.append(f"struct {struct} {{ int n = 3; std::string name; }};")
    w.body += [
        f'std::vector<{struct}> {made}{{{{1, "{names[0]}"}}, {{.name = "{names[1]}"}}}};',
        f"for (const {struct} & one : {made}) {{ {e.make('one.name')}; }}",
    ]


def containers_in_braces(w: Writer):
    e, made = w.endpoint(), w.unused("v")
    names = w.names(e, 3)
    kinds = (
        "std::vector<std::string>", "std::list<std::string>", "std::set<std::string>",
        "std::array<std::string, 3>", "std::deque<std::string>", "auto",
    )  # fmt: skip
    kind = w.random.choice(kinds)
    rows = {
        "auto": f"std::vector<std::string>{{{w.quoted(names)}}}",
        "std::array<std::string, 3>": f"{{{{{w.quoted(names)}}}}}",
    }
    row = rows.get(kind, f"{{{w.quoted(names)}}}")
    forms = [f"{kind} {made} = {row};"]
    if kind != "auto":
        forms += [f"{kind} {made}{row};", f"{kind} {made};\n{made} = {row};"]
    w.body.append(w.random.choice(forms))
    loops = (
        f"for (const auto & name : {made}) {{ {e.make('name')}; }}",
        f"for (auto it = {made}.begin(); it != {made}.end(); ++it) {{ {e.make('*it')}; }}",
        f"std::for_each({made}.begin(), {made}.end(), [&](auto & name) {{ {e.make('name')}; }});",
    )
    w.body.append(w.random.choice(loops))


def array_of_c(w: Writer):
    e, made = w.endpoint(), w.unused("a")
    names = w.names(e, 2)
    where = w.random.choice([w.top, w.body])
    const = w.random.choice(["const char *", "const std::string"])
    where.append(f"{const} {made}[] = {{{w.quoted(names)}}};")
    loops = (
        f"for (auto name : {made}) {{ {e.make('name')}; }}",
        f"for (size_t i = 0; i < 2; i++) {{ {e.make(f'{made}[i]')}; }}",
        f"for (int i = 1; i >= 0; --i) {{ {e.make(f'{made}[i]')}; }}",
    )
    w.body.append(w.random.choice(loops))


def array_of_structs(w: Writer):
    e, struct, made = w.endpoint(), w.unused("S"), w.unused("a")
    names = w.names(e, 2)
    where = w.random.choice([w.top, w.body])
    where.append(f"struct {struct} {{ std::string name; int n; }};")
    forms = (f"{struct} {made}[2];", f"std::vector<{struct}> {made}(2);",
             f"std::array<{struct}, 2> {made};", f"std::vector<{struct}> {made};\n{made}.resize(2);")  # fmt: skip
    w.body.append(w.random.choice(forms))
    w.body += [f'{made}[{at}].name = "{name}";' for at, name in enumerate(names)]
    w.body.append(f"for (auto & one : {made}) {{ {e.make('one.name')}; }}")


def objects_made_in_place(w: Writer):
    e, struct, made = w.endpoint(), w.unused("W"), w.unused("v")
    names = w.names(e, 3)
    w.top += [
        f"struct {struct} {{",
        f"  {e.type} made;",
        f"  {struct}({w.handle}h, const std::string & name) : made({e.make('name')}) {{}}",
        "};",
    ]
    w.body += [
        f"std::vector<{struct}> {made};",
        f'{made}.emplace_back(h, "{names[0]}");',
        f'{made}.push_back({struct}(h, "{names[1]}"));',
        f'{made}.push_back({{h, "{names[2]}"}});',
    ]


def entries_made_in_place(w: Writer):
    e, struct, made = w.endpoint(), w.unused("W"), w.unused("m")
    names = w.names(e, 4)
    w.top += [
        f"struct {struct} {{",
        f"  {e.type} made;",
        f"  {struct}({w.handle}h, const std::string & name) {{ made = {e.make('name')}; }}",
        "};",
    ]
    w.body += [
        f"std::map<std::string, {struct}> {made};",
        f'{made}.emplace("a", {struct}(h, "{names[0]}"));',
        f'{made}.try_emplace("b", h, "{names[1]}");',
        f'{made}.insert({{"c", {struct}{{h, "{names[2]}"}}}});',
        f'{made}.insert(std::make_pair("d", {struct}(h, "{names[3]}")));',
    ]


def entries_added(w: Writer):
    e, made = w.endpoint(), w.unused("m")
    names = w.names(e, 4)
    w.body += [
        f"std::map<int, std::string> {made};",
        f'{made}[0] = "{names[0]}";',
        f'{made}.insert({{1, "{names[1]}"}});',
        f'{made}.insert_or_assign(2, "{names[2]}");',
        f"{made}.emplace(std::piecewise_construct, std::forward_as_tuple(3),",
        f'  std::forward_as_tuple("{names[3]}"));',
        f"for (const auto & entry : {made}) {{ {e.make('entry.second')}; }}",
    ]


def items_added(w: Writer):
    e, made, other = w.endpoint(), w.unused("l"), w.unused("l")
    names = w.names(e, 5)
    w.body += [
        f"std::deque<std::string> {made};",
        f'{made}.push_front("{names[0]}");',
        f'{made}.emplace_back("{names[1]}");',
        f'{made}.emplace_front("{names[2]}");',
        f'std::vector<std::string> {other} = {{"{names[3]}"}};',
        f"{made}.insert({made}.end(), {other}.begin(), {other}.end());",
        f'{made}.insert({made}.begin(), "{names[4]}");',
        f"while (!{made}.empty()) {{ {e.make(f'{made}.front()')}; {made}.pop_front(); }}",
    ]


def several_of_one_key(w: Writer):
    e, made = w.endpoint(), w.unused("m")
    names = w.names(e, 3)
    w.body += [
        f'std::multimap<int, std::string> {made}{{{{1, "{names[0]}"}}, {{1, "{names[1]}"}}}};',
        f'{made}.emplace(2, "{names[2]}");',
        f"for (auto & [key, name] : {made}) {{ {e.make('name')}; }}",
    ]


def transformed(w: Writer):
    e, made, other = w.endpoint(), w.unused("v"), w.unused("v")
    prefix = w.unused("t")
    w.expect(e, f"{prefix}a")
    w.expect(e, f"{prefix}b")
    algorithms = (
        f"std::transform({made}.begin(), {made}.end(), std::back_inserter({other}),\n"
        f'  [](const std::string & s) {{ return "{prefix}" + s; }});',
        f'for (auto & s : {made}) {other}.push_back("{prefix}" + s);',
        f"std::transform({made}.cbegin(), {made}.cend(), {other}.begin(),\n"
        f'  [](const std::string & s) {{ return "{prefix}" + s; }});',
    )
    chosen = w.random.randrange(3)
    size = "(2)" if chosen == 2 else ""
    w.body += [
        f'std::vector<std::string> {made} = {{"a", "b"}};',
        f"std::vector<std::string> {other}{size};",
        algorithms[chosen],
        f"for (auto & name : {other}) {{ {e.make('name')}; }}",
    ]


def copied(w: Writer):
    e, made, other = w.endpoint(), w.unused("v"), w.unused("v")
    names = w.names(e, 2)
    copies = (
        f"std::vector<std::string> {other}({made}.begin(), {made}.end());",
        f"std::vector<std::string> {other}{{{made}}};",
        f"std::set<std::string> {other}{{{made}.begin(), {made}.end()}};",
        f"std::list<std::string> {other};\n"
        f"std::copy({made}.begin(), {made}.end(), std::back_inserter({other}));",
        f"auto {other} = std::move({made});",
        f"std::vector<std::string> {other};\nstd::swap({made}, {other});",
        f"std::vector<std::string> {other};\n{other}.swap({made});",
        f"std::vector<std::string> {other};\n{other}.assign({made}.begin(), {made}.end());",
    )
    w.body += [
        f"std::vector<std::string> {made} = {{{w.quoted(names)}}};",
        w.random.choice(copies),
        f"for (auto & name : {other}) {{ {e.make('name')}; }}",
    ]


def filled_by_reference(w: Writer):
    e, fill, made = w.endpoint(), w.unused("fill"), w.unused("v")
    names = w.names(e, 2)
    w.top += [
        f"void {fill}(std::vector<std::string> & into, int n) {{",
        f"  if (n == 0) {{ into = {{{w.quoted(names)}}}; }}",
        f'  else {{ into.push_back("dead{w.id}"); }}',
        "}",
    ]
    w.body += [
        f"std::vector<std::string> {made};",
        f"{fill}({made}, 0);",
        f"for (const std::string & name : {made}) {{ {e.make('name')}; }}",
    ]


def tuples(w: Writer):
    e, made = w.endpoint(), w.unused("t")
    names = w.names(e, 2)
    w.body += [
        w.random.choice([
            f'auto {made} = std::make_tuple("{names[0]}", 1, std::string("{names[1]}"));',
            f'std::tuple<std::string, int, std::string> {made}{{"{names[0]}", 1, "{names[1]}"}};',
        ]),
        w.random.choice([
            f"{e.make(f'std::get<0>({made})')};\n{e.make(f'std::get<2>({made})')};",
            f"auto [a{made}, n{made}, b{made}] = {made};\n"
            f"{e.make(f'a{made}')};\n{e.make(f'b{made}')};",
        ]),
    ]  # fmt: skip


def optionals(w: Writer):
    e, made = w.endpoint(), w.unused("o")
    name, other, dead = *w.names(e, 2), w.unused("dead")
    w.body += [
        w.random.choice([
            f"std::optional<std::string> {made} = {w.text(name)};",
            f"std::optional<std::string> {made}{{{w.text(name)}}};",
            f"std::optional<std::string> {made};\n{made} = {w.text(name)};",
            f"std::optional<std::string> {made};\n{made}.emplace({w.text(name)});",
        ]),
        f"if ({made}) {{ {e.make(f'*{made}')}; }}",
        f'if (!{made}.has_value()) {{ {e.literal(dead)}; }}',
        f"std::optional<std::string> no{made};",
        f'if (no{made}) {{ {e.literal(dead)}; }}',
        e.make(f'no{made}.value_or("{other}")') + ";",
    ]  # fmt: skip


def variants(w: Writer):
    e, made = w.endpoint(), w.unused("v")
    name = w.names(e, 1)[0]
    uses = (
        f"if (std::holds_alternative<std::string>({made})) {{\n"
        f"  {e.make(f'std::get<std::string>({made})')};\n}}",
        f"if (auto held = std::get_if<std::string>(&{made})) {{ {e.make('*held')}; }}",
    )
    w.body += [
        f"std::variant<std::string, int> {made} = std::string({w.text(name)});",
        w.random.choice(uses),
    ]


def nested_containers(w: Writer):
    e, made = w.endpoint(), w.unused("v")
    names = w.names(e, 3)
    w.body += [
        f"std::vector<std::vector<std::string>> {made} = {{{{{w.quoted(names[:2])}}}, {{{w.quoted(names[2:])}}}}};",
        f"for (auto & row : {made}) for (auto & name : row) {{ {e.make('name')}; }}",
    ]


def sorted_names(w: Writer):
    e, made = w.endpoint(), w.unused("v")
    names = w.names(e, 2)
    dead = w.unused("dead")
    w.body += [
        f"std::vector<std::pair<int, std::string>> {made} = {{",
        f'  {{2, "{names[1]}"}}, {{1, "{names[0]}"}}, {{0, "{dead}"}}}};',
        f"std::sort({made}.begin(), {made}.end());",
        f"for (const auto & [rank, name] : {made}) {{ if (rank > 0) {{ {e.make('name')}; }} }}",
    ]


CONTAINERS = [
    *(map_assigned_in_braces, map_of_pointers_assigned_in_braces, struct_assigned_in_braces),
    *(aggregate_in_braces, containers_in_braces, array_of_c, array_of_structs),
    *(objects_made_in_place, entries_made_in_place, entries_added, items_added),
    *(several_of_one_key, transformed, copied, filled_by_reference, tuples, optionals),
    *(variants, nested_containers, sorted_names),
]
