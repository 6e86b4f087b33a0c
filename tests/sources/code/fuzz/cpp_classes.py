"""Constructs of C++ that are about classes: bases, members, operators, static objects."""

from cpp_programs import Writer


def virtual_methods(w: Writer):
    e, base = w.endpoint(), w.unused("B")
    names = w.names(e, 3)
    w.top += [
        f"struct {base} {{",
        f"  virtual ~{base}() = default;",
        f"  virtual void go({w.handle}h) {{ {w.dead(e)}; }}",
        f'  virtual std::string name() const {{ return "dead{w.id}n"; }}',
        f"  void both({w.handle}h) {{ go(h); {e.make('name()')}; }}",
        "};",
        f"struct One{base} final : public {base} {{",
        f"  void go({w.handle}h) override {{ {e.literal(names[0])}; }}",
        f'  std::string name() const override {{ return "{names[1]}"; }}',
        "};",
        f"struct Two{base} : {base} {{",
        f"  void go({w.handle}h) override {{ {e.literal(names[2])}; }}",
        "};",
        f"std::unique_ptr<{base}> make{base}(const std::string & kind) {{",
        f'  if (kind == "one") return std::make_unique<One{base}>();',
        f"  return std::unique_ptr<{base}>(new Two{base}());",
        "}",
    ]
    w.body += [
        f'std::unique_ptr<{base}> one{base} = make{base}("one");',
        f"one{base}->both(h);",
        f'{base} & two{base} = *make{base}("two").release();',
        f"two{base}.go(h);",
    ]


def objects_by_pointer(w: Writer):
    e, base = w.endpoint(), w.unused("B")
    names = w.names(e, 2)
    w.top += [
        f"struct {base} {{ virtual ~{base}() {{}} virtual void go() = 0; }};",
        f"class Own{base} : public {base} {{",
        f"  {w.library.member} h;",
        "  std::string name_;",
        "public:",
        f"  Own{base}({w.library.member} handle, std::string name) : h(handle), name_(std::move(name)) {{}}",
        f"  void go() override {{ {e.make('name_')}; }}",
        "};",
    ]
    w.body += [
        f"std::vector<std::shared_ptr<{base}>> all{base};",
        f'all{base}.push_back(std::make_shared<Own{base}>(h, "{names[0]}"));',
        f'all{base}.emplace_back(new Own{base}(h, "{names[1]}"));',
        f"for (auto & one : all{base}) one->go();",
    ]


def crtp(w: Writer):
    e, base = w.endpoint(), w.unused("B")
    names = w.names(e, 2)
    w.top += [
        f"template <class D> struct {base} {{",
        f"  void go({w.handle}h) {{ {e.make('static_cast<D *>(this)->name()')}; }}",
        f"  static void all({w.handle}h) {{ {e.make('D::NAME')}; }}",
        "};",
        f"struct D{base} : {base}<D{base}> {{",
        f'  static constexpr const char * NAME = "{names[1]}";',
        f'  std::string name() {{ return "{names[0]}"; }}',
        "};",
    ]
    w.body += [f"D{base} made{base};", f"made{base}.go(h);", f"D{base}::all(h);"]


def constructors(w: Writer):
    e, base = w.endpoint(), w.unused("B")
    names = w.names(e, 4)
    w.top += [
        f"class {base} {{",
        "public:",
        f"  {base}({w.handle}h, const std::string & name) : made_({e.make('name')}) {{}}",
        "protected:",
        f"  {e.type} made_;",
        "};",
        f"struct Of{base} : {base} {{",
        f'  Of{base}({w.handle}h) : Of{base}(h, "{names[0]}") {{ other = {e.make("text")}; }}',
        f'  Of{base}({w.handle}h, std::string name) : {base}(h, name), list{{"{names[2]}"}} {{}}',
        f'  std::string text = "{names[1]}";',
        "  std::vector<std::string> list;",
        f"  {e.type} other;",
        "};",
        f"struct Using{base} : {base} {{ using {base}::{base}; }};",
    ]
    w.body += [
        f"Of{base} made{base}(h);",
        f"for (auto & name : made{base}.list) {{ {e.make('name')}; }}",
        f'Using{base} also{base}(h, "{names[3]}");',
    ]


def lists_for_constructors(w: Writer):
    e, name = w.endpoint(), w.unused("L")
    names = w.names(e, 4)
    w.top += [
        f"struct {name} {{",
        f"  {name}(std::initializer_list<std::string> all) : all_(all) {{}}",
        f"  explicit {name}(int) {{}}",
        "  std::vector<std::string> all_;",
        f"  void go({w.handle}h) {{ for (auto & one : all_) {{ {e.make('one')}; }} }}",
        "};",
    ]
    w.body += [
        f"{name} a{name}{{{w.quoted(names[:2])}}};",
        f"{name} b{name} = {{{w.quoted(names[2:])}}};",
        f"a{name}.go(h);\nb{name}.go(h);",
    ]


def operators(w: Writer):
    e, name = w.endpoint(), w.unused("O")
    made = w.names(e, 6)
    w.top += [
        f"struct {name} {{",
        f"  {w.library.member} h;",
        f"  {e.type} last;",
        f"  void operator()(const std::string & name) {{ last = {e.make('name')}; }}",
        f"  {e.type} & operator[](const std::string & name) {{ last = {e.make('name')}; return last; }}",
        f"  {name} & operator<<(const std::string & name) {{ last = {e.make('name')}; return *this; }}",
        f"  {name} & operator+=(const std::string & name) {{ last = {e.make('name')}; return *this; }}",
        f"  bool operator!() {{ last = {e.literal(made[4])}; return false; }}",
        f"  {name} * operator->() {{ return this; }}",
        f"  void go(const std::string & name) {{ last = {e.make('name')}; }}",
        "};",
    ]
    w.body += [
        f"{name} o{name}{{h, {{}}}};",
        f'o{name}("{made[0]}");',
        f'o{name}["{made[1]}"];',
        f'o{name} << "{made[2]}";',
        f'o{name} += "{made[3]}";',
        f"if (!o{name}) {{ }}",
        f'o{name}->go("{made[5]}");',
    ]


def free_operators(w: Writer):
    e, name = w.endpoint(), w.unused("O")
    made = w.names(e, 3)
    w.top += [
        f"struct {name} {{ std::string name; }};",
        f"{e.type} operator|({w.handle}h, const {name} & o) {{ return {e.make('o.name')}; }}"
        if w.library.ros == 1
        else f"{e.type} operator|({name} o, {w.handle}h) {{ return {e.make('o.name')}; }}",
        f"struct C{name} {{",
        f"  {w.library.member} h;",
        f"  {e.type} operator*() {{ return {e.literal(made[1])}; }}",
        f"  operator bool() {{ {e.literal(made[2])}; return true; }}",
        "};",
    ]
    left = f'h | {name}{{"{made[0]}"}}' if w.library.ros == 1 else f'{name}{{"{made[0]}"}} | h'
    w.body += [
        f"auto made{name} = {left};",
        f"C{name} c{name}{{h}};",
        f"*c{name};",
        f"if (c{name}) {{ }}",
    ]


def friends(w: Writer):
    e, name = w.endpoint(), w.unused("A")
    made = w.names(e, 2)
    w.top += [
        f"class {name} {{",
        f'  std::string text = "{made[0]}";',
        f"  friend void setup({name} & a, {w.handle}h) {{ {e.make('a.text')}; }}",
        f"  friend struct F{name};",
        "};",
        f"struct F{name} {{ void go({w.handle}h) {{ {e.literal(made[1])}; }} }};",
    ]
    w.body += [f"{name} a{name};", f"setup(a{name}, h);", f"F{name}().go(h);"]


def static_objects(w: Writer):
    e, name = w.endpoint(), w.unused("S")
    made = w.names(e, 3)
    w.top += [
        f"struct {name} {{",
        "  static std::vector<std::string> names;",
        f'  static inline const std::string NAME = "{made[0]}";',
        f"  static {name} & instance() {{ static {name} one; return one; }}",
        f"  void go({w.handle}h) {{ for (auto & one : names) {{ {e.make('one')}; }} }}",
        "};",
        f'std::vector<std::string> {name}::names = {{"{made[1]}"}};',
        f"struct Register{name} {{",
        f"  explicit Register{name}(std::string one) {{ {name}::names.push_back(one); }}",
        "};",
        f'static Register{name} register{name}("{made[2]}");',
    ]
    w.body += [f"{e.make(f'{name}::NAME')};", f"{name}::instance().go(h);"]


def registered_factories(w: Writer):
    e, name = w.endpoint(), w.unused("R")
    made = w.names(e, 2)
    w.top += [
        f"using Make{name} = std::function<void({w.handle})>;",
        f"std::map<std::string, Make{name}> & all{name}() {{",
        f"  static std::map<std::string, Make{name}> all; return all;",
        "}",
        *(
            f'static const bool {key}{name} = all{name}().emplace("{key}", []({w.handle}h) '
            f"{{ {e.literal(one)}; }}).second;"
            for key, one in zip("ab", made, strict=True)
        ),
    ]
    w.body.append(f"for (auto & [key, call] : all{name}()) call(h);")


def static_locals(w: Writer):
    e, name = w.endpoint(), w.unused("f")
    prefix = w.unused("t")
    for at in (1, 2):
        w.expect(e, f"{prefix}{at}")
    w.top += [
        f"void {name}({w.handle}h) {{",
        "  static int count = 0;",
        "  ++count;",
        f"  {e.numbered(prefix, 'count')};",
        "}",
    ]
    w.body += [f"{name}(h);", f"{name}(h);"]


def pointers_to_members(w: Writer):
    e, name = w.endpoint(), w.unused("C")
    made = w.names(e, 3)
    w.top += [
        f"struct {name} {{",
        f"  {w.library.member} h;",
        f"  void one(const std::string & name) {{ {e.make('name')}; }}",
        "  std::string text;",
        f'  void all() {{ auto call = std::bind(&{name}::one, this, std::placeholders::_1); call("{made[0]}"); }}',
        "};",
    ]
    w.body += [
        f'{name} c{name}{{h, "{made[1]}"}};',
        f"c{name}.all();",
        f"{e.make(f'c{name}.text')};",
        f"auto call{name} = &{name}::one;",
        f'(c{name}.*call{name})("{made[2]}");',
    ]


def local_classes(w: Writer):
    e, name = w.endpoint(), w.unused("L")
    made = w.names(e, 2)
    w.body += [
        f"struct {name} {{",
        f"  {w.library.member} h;",
        f"  {e.type} go(std::string name) {{ return {e.make('name')}; }}",
        "};",
        f"{name} l{name}{{h}};",
        f'l{name}.go("{made[0]}");',
        f"auto again{name} = l{name};",
        f'again{name}.go("{made[1]}");',
    ]


def moved_objects(w: Writer):
    e, name = w.endpoint(), w.unused("M")
    made = w.names(e, 3)
    w.top += [
        f"struct {name} {{",
        f"  {w.library.member} h;",
        f"  explicit {name}({w.library.member} handle) : h(handle) {{}}",
        f"  void go(std::string name) {{ {e.make('name')}; }}",
        "};",
    ]
    w.body += [
        f"auto a{name} = std::make_unique<{name}>(h);",
        f"std::unique_ptr<{name}> b{name} = std::move(a{name});",
        f'b{name}->go("{made[0]}");',
        f"std::shared_ptr<{name}> c{name};",
        f"c{name}.reset(new {name}(h));",
        f'(*c{name}).go("{made[1]}");',
        f"auto d{name} = std::exchange(c{name}, nullptr);",
        f'd{name}->go("{made[2]}");',
    ]


def downcasts(w: Writer):
    e, name = w.endpoint(), w.unused("B")
    made = w.names(e, 1)
    w.top += [
        f"struct {name} {{ virtual ~{name}() = default; }};",
        f"struct A{name} : {name} {{ void go({w.handle}h) {{ {e.literal(made[0])}; }} }};",
        f"struct C{name} : {name} {{ void go({w.handle}h) {{ {w.dead(e)}; }} }};",
    ]
    w.body += [
        f"std::shared_ptr<{name}> b{name} = std::make_shared<A{name}>();",
        f"if (auto a = dynamic_cast<A{name} *>(b{name}.get())) a->go(h);",
        f"if (auto c = dynamic_cast<C{name} *>(b{name}.get())) c->go(h);",
    ]


def copied_objects(w: Writer):
    e, name = w.endpoint(), w.unused("B")
    made = w.names(e, 4)
    w.top += [
        f"struct {name} {{ std::string name; int count; }};",
        f'struct C{name} {{ C{name}() {{ name = "{made[3]}"; }} std::string name; }};',
        f"class Holds{name} {{",
        f"  {name} first_, second_;",
        f"  C{name} third_;",
        "public:",
        f"  Holds{name}(const {name} & given, C{name} other)",
        "  : first_(given), second_{given}, third_(other) {}",
        f"  void go({w.handle}h) {{ {e.make('first_.name')}; {e.make('third_.name')};",
        f"    {e.make(chr(34) + made[1] + chr(34) + ' + second_.name.substr(0, 0)')}; }}",
        "};",
    ]
    w.body += [
        f'{name} a{name}{{"{made[0]}", 1}};',
        f"C{name} c{name};",
        f'c{name}.name = "{made[2]}";',
        f"Holds{name} h{name}(a{name}, c{name});",
        f'a{name}.name = "dead{w.id}n";',
        f"h{name}.go(h);",
        f"C{name} d{name};",
        f"{e.make(f'd{name}.name')};",
    ]


CLASSES = [
    *(virtual_methods, objects_by_pointer, crtp, constructors, lists_for_constructors, operators),
    *(free_operators, friends, static_objects, registered_factories, static_locals),
    *(pointers_to_members, local_classes, moved_objects, downcasts, copied_objects),
]
