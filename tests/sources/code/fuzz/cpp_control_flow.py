"""Constructs of C++ that decide what runs, and what never does."""

from cpp_programs import Writer


def plain(w: Writer):
    e = w.endpoint()
    w.body.append(f"{e.make(w.text(w.names(e, 1)[0]))};")


def dead_branches(w: Writer):
    e, dead, flag = w.endpoint(), w.unused("dead"), w.unused("flag")
    name = w.names(e, 1)[0]
    never = e.literal(dead)
    w.top += [
        f"constexpr bool {flag} = false;",
        f"#if 0\nauto n{flag} = {never};\n#endif",
        f"#ifdef UNDEFINED_{flag}\nauto n{flag} = {never};\n#endif",
    ]
    w.body += [
        w.random.choice([
            f"if ({flag}) {{ {never}; }}",
            f"if (false) {{ {never}; }} else {{ }}",
            f"if constexpr ({flag}) {{ {never}; }}",
            f"while ({flag}) {{ {never}; }}",
            f"for (int i = 0; i < 0; i++) {{ {never}; }}",
            f"{flag} && ({never}, true);",
            f"// {never};\n/* {never}; */",
        ]),
        f"if (!{flag}) {{ {e.make(w.text(name))}; }}",
    ]  # fmt: skip


def dead_functions(w: Writer):
    e, dead, name = w.endpoint(), w.unused("dead"), w.unused("f")
    never = e.literal(dead)
    w.top += [
        w.random.choice([
            f"void {name}({w.handle}h) {{ {never}; }}",
            f"template <class T> void {name}({w.handle}h) {{ {never}; }}",
            f"struct {name} {{ void f({w.handle}h) {{ {never}; }} }};",
            f"[[maybe_unused]] static void {name}({w.handle}h) {{ {never}; }}",
        ]),
    ]  # fmt: skip
    w.body.append(f"auto unused{name} = [&] {{ {never}; }};")


def early_return(w: Writer):
    e, dead, function = w.endpoint(), w.unused("dead"), w.unused("f")
    name = w.names(e, 1)[0]
    never = e.literal(dead)
    w.top += [
        f"int {function}({w.handle}h, int n) {{",
        f"  if (n > 1) {{ {e.make(w.text(name))}; return 1; }}",
        f"  {never};",
        "  return 0;",
        f"  {never};",
        "}",
    ]
    w.body.append(f"{function}(h, 2);")


def switch(w: Writer):
    e, dead, value = w.endpoint(), w.unused("dead"), w.unused("n")
    names = w.names(e, 2)
    never = e.literal(dead)
    w.body += [
        f"int {value} = 1;",
        f"switch ({value}) {{",
        f"  case 0: {never}; break;",
        f"  case 1: {e.make(w.text(names[0]))}; [[fallthrough]];",
        f"  case 2: {{ {e.make(w.text(names[1]))}; break; }}",
        f"  default: {never};",
        "}",
    ]


def switch_of_enumerators(w: Writer):
    e, kind, function = w.endpoint(), w.unused("E"), w.unused("f")
    names = w.names(e, 2)
    w.top += [
        f"enum class {kind} {{ A, B, C }};",
        f"const char * {function}({kind} kind) {{",
        f'  switch (kind) {{ case {kind}::A: return "{names[0]}"; case {kind}::B: return "{names[1]}";',
        f'    default: return "dead{w.id}"; }}',
        "}",
    ]
    w.body.append(f"for (auto k : {{{kind}::A, {kind}::B}}) {{ {e.make(f'{function}(k)')}; }}")


def switch_in_a_loop(w: Writer):
    e, prefix = w.endpoint(), w.unused("t")
    for at in (0, 2):
        w.expect(e, f"{prefix}{at}")
    w.body += [
        "for (int i = 0; i < 3; i++) {",
        "  switch (i) { case 0: break; case 1: continue; default: if (i == 2) { break; } }",
        f"  {e.numbered(prefix, 'i')};",
        "}",
    ]


def counted_loops(w: Writer):
    e, prefix = w.endpoint(), w.unused("t")
    for at in range(3):
        w.expect(e, f"{prefix}{at}")
    made = e.numbered(prefix, "i")
    i = w.unused("i")
    w.body.append(
        w.random.choice([
            f"for (int i = 0; i < 3; ++i) {{ {made}; }}",
            f"{{ int i = 0; while (i < 3) {{ {made}; i++; }} }}",
            f"{{ int i = 0; do {{ {made}; }} while (++i < 3); }}",
            f"for (unsigned i = 0; ; i += 1) {{ if (i == 3) break; {made}; }}",
            f"for (int i = 5; i >= 0; i--) {{ if (i > 2) continue; {made}; }}",
            f"for (auto i : {{0, 1, 2}}) {{ {made}; }}",
            f"for (int i = 0, n{i} = 3; i != n{i}; i++) {{ {made}; }}",
            f"std::vector<int> {i}{{0, 1, 2}};\nfor (int i : {i}) {{ {made}; }}",
        ])
    )  # fmt: skip


def jumps(w: Writer):
    e, prefix, label = w.endpoint(), w.unused("t"), w.unused("label")
    count = w.unused("n")
    for at in range(2):
        w.expect(e, f"{prefix}{at}")
    w.body += [
        f"int {count} = 0;",
        f"{label}:",
        f"{e.numbered(prefix, count)};",
        f"if (++{count} < 2) goto {label};",
    ]


def exceptions(w: Writer):
    e, dead, function = w.endpoint(), w.unused("dead"), w.unused("f")
    names = w.names(e, 3)
    never = e.literal(dead)
    thrown = w.random.choice(['std::runtime_error("no")', 'std::out_of_range("no")'])
    w.top.append(f"void {function}(int n) {{ if (n > 0) throw {thrown}; }}")
    w.body += [
        f"try {{ {function}(0); {e.make(w.text(names[0]))}; {function}(1); {never}; }}",
        f"catch (const std::exception & error) {{ {e.make(w.text(names[1]))}; }}",
        f"{e.make(w.text(names[2]))};",
    ]


def conditional_expressions(w: Writer):
    e, dead, made = w.endpoint(), w.unused("dead"), w.unused("c")
    names = w.names(e, 3)
    never = e.literal(dead)
    w.body += [
        f"bool yes{made} = true;",
        f"auto {made} = yes{made} ? {e.make(w.text(names[0]))} : {never};",
        f"{e.type} also{made};",
        f"if (yes{made} && (also{made} = {e.make(w.text(names[1]))}, true)) {{ }}",
        f"if (auto it = {e.make(w.text(names[2]))}; yes{made}) {{ }} else {{ {never}; }}",
    ]


def macros(w: Writer):
    e, make, row = w.endpoint(), w.unused("MAKE"), w.unused("ROW")
    names = w.names(e, 4)
    head = names[2].rpartition("_")[0]
    w.top += [
        f"#define {make}(name) {e.make('name')}",
        f"#define {make}S(name) {e.make('#name')}",
        f"#define {row}(X) X({names[2]}) X({names[3]})",
        f"#define {make}J(a, b) a ## b",
    ]
    w.body += [
        f"{make}({w.text(names[0])});",
        f"{make}S({names[1]});",
        f"#define ONE{make}(name) {make}S(name);",
        f"{row}(ONE{make})",
        f"#undef ONE{make}",
        f"int {make}J({head}, n) = 0; (void){head}n;",
    ]


def recursion(w: Writer):
    e, prefix, function = w.endpoint(), w.unused("t"), w.unused("f")
    depth = w.random.randint(1, 5)
    for at in range(depth):
        w.expect(e, f"{prefix}{at}")
    w.top += [
        f"void {function}({w.handle}h, int n) {{",
        "  if (n < 0) return;",
        f"  {e.numbered(prefix, 'n')};",
        f"  {function}(h, n - 1);",
        "}",
    ]
    w.body.append(f"{function}(h, {depth - 1});")


def if_of_types(w: Writer):
    e, dead, function = w.endpoint(), w.unused("dead"), w.unused("f")
    names = w.names(e, 2)
    w.top += [
        f"template <class T> std::string {function}() {{",
        f'  if constexpr (std::is_same_v<T, int>) {{ return "{names[0]}"; }}',
        f'  else if constexpr (std::is_same<T, double>::value) {{ return "{names[1]}"; }}',
        f'  else {{ return "{dead}"; }}',
        "}",
    ]
    w.body += [f"{e.make(f'{function}<int>()')};", f"{e.make(f'{function}<double>()')};"]


CONTROL_FLOW = [
    *(plain, dead_branches, dead_functions, early_return, switch, switch_of_enumerators),
    *(switch_in_a_loop, counted_loops, jumps, exceptions, conditional_expressions, macros),
    *(recursion, if_of_types),
]
