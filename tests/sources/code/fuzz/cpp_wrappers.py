"""What a piece of a program may stand within: each takes its body and leaves another one."""

from textwrap import indent

from cpp_programs import Writer


def _block(w: Writer) -> str:
    return indent("\n".join(w.body), "  ")


def lambda_called(w: Writer):
    w.body = ["[&] {", _block(w), "}();"]


def generic_lambda(w: Writer):
    w.body = ["[](auto && given) {", f"  {w.handle}h = given;", _block(w), "}(h);"]


def branch(w: Writer):
    never = w.endpoint().make(f'"dead{w.id}b"')
    w.body = [f"if ({w.id} >= 0) {{", _block(w), f"}} else {{ {never}; }}"]


def loop(w: Writer):
    heads = ("for (int once = 0; once < 1; ++once)", "for (auto once : {1})")
    w.body = [f"{w.random.choice(heads)} {{ (void)once;", _block(w), "}"]


def loop_of_one_round(w: Writer):
    w.body = ["do {", _block(w), "} while (false);"]


def handler(w: Writer):
    w.body = ["try {", _block(w), "} catch (...) { throw; }"]


def case(w: Writer):
    w.body = [f"switch ({w.id}) {{ case {w.id}: {{", _block(w), "  break; } case -1: break; }"]


def function(w: Writer):
    name = w.unused("w")
    w.top += [f"void {name}({w.handle}h) {{", _block(w), "}"]
    w.body = [f"{name}(h);"]


def function_template(w: Writer):
    name = w.unused("w")
    w.top += [f"template <class T> void {name}({w.handle}h, T) {{", _block(w), "}"]
    w.body = [f"{name}(h, {w.random.choice(['1', '1.5', 'std::string()'])});"]


def function_of_a_namespace(w: Writer):
    name = w.unused("w")
    w.top += [f"namespace a{name}::b {{ void {name}({w.handle}h) {{", _block(w), "} }"]
    w.body = w.random.choice(
        [[f"a{name}::b::{name}(h);"], [f"{{ using a{name}::b::{name}; {name}(h); }}"],
         [f"{{ namespace n{name} = a{name}::b; n{name}::{name}(h); }}"]]
    )  # fmt: skip


def function_that_calls_itself(w: Writer):
    name = w.unused("w")
    start = f"  if (n > 0) {{ {name}(h, n - 1); return; }}"
    w.top += [f"void {name}({w.handle}h, int n) {{", start, _block(w), "}"]
    w.body = [f"{name}(h, 1);"]


def method(w: Writer):
    name = w.unused("W")
    const = w.random.choice(["", "virtual ", "inline "])
    w.top += [
        f"struct {name} {{",
        f"  {w.library.member} h_;",
        f"  explicit {name}({w.library.member} given) : h_(given) {{}}",
        f"  {const}void go() {{",
        f"  {w.handle}h = h_;",
        _block(w),
        "  }",
        "};",
    ]
    w.body = w.random.choice(
        [[f"{name} {name}_(h);", f"{name}_.go();"], [f"std::make_shared<{name}>(h)->go();"],
         [f"{name}(h).go();"], [f"auto {name}_ = std::bind(&{name}::go, {name}(h));", f"{name}_();"]]
    )  # fmt: skip


def method_of_a_base(w: Writer):
    name = w.unused("W")
    w.top += [
        f"struct {name} {{ virtual ~{name}() {{}} virtual void go({w.handle}) = 0; }};",
        f"struct D{name} : {name} {{ void go({w.handle}h) override; }};",
        f"void D{name}::go({w.handle}h) {{",
        _block(w),
        "}",
    ]
    w.body = [f"std::unique_ptr<{name}> {name}_(new D{name});", f"{name}_->go(h);"]


def constructor(w: Writer):
    name = w.unused("W")
    w.top += [f"struct {name} {{ explicit {name}({w.handle}h) {{", _block(w), "} };"]
    w.body = w.random.choice(
        [[f"{name} {name}_(h);"], [f"{name} {name}_{{h}};"], [f"auto * {name}_ = new {name}(h); (void){name}_;"],
         [f"std::vector<{name}> {name}_; {name}_.emplace_back(h);"], [f"std::optional<{name}> {name}_({name}{{h}});"]]
    )  # fmt: skip


def functor(w: Writer):
    name = w.unused("W")
    w.top += [f"struct {name} {{ void operator()({w.handle}h) const {{", _block(w), "} };"]
    w.body = w.random.choice(
        [[f"{name}()(h);"], [f"{name} {name}_; {name}_(h);"], [f"std::function<void({w.handle})> {name}_ = {name}(); {name}_(h);"]]
    )  # fmt: skip


def static_method(w: Writer):
    name = w.unused("W")
    w.top += [
        f"template <int N> struct {name} {{ static void go({w.handle}h) {{",
        _block(w),
        "} };",
    ]
    w.body = [f"{name}<1>::go(h);"]


def stored_function(w: Writer):
    name = w.unused("w")
    w.body = w.random.choice(
        [[f"std::function<void()> {name} = [&] {{", _block(w), "};", f"if ({name}) {name}();"],
         [f"std::vector<std::function<void({w.handle})>> {name};", f"{name}.push_back([]({w.handle}h) {{",
          _block(w), "});", f"for (auto & call : {name}) call(h);"],
         [f"auto {name} = [](auto && call) {{ return [call] {{ call(); }}; }}([&] {{", _block(w), "});", f"{name}();"]]
    )  # fmt: skip


def thread(w: Writer):
    name = w.unused("w")
    w.body = w.random.choice(
        [["std::thread([&] {", _block(w), "}).join();"],
         [f"std::thread {name}([&] {{", _block(w), "});", f"{name}.join();"],
         ["std::async(std::launch::async, [&] {", _block(w), "}).get();"]]
    )  # fmt: skip


def static_once(w: Writer):
    name = w.unused("w")
    w.body = [
        f"static const bool {name} = [&] {{",
        _block(w),
        "  return true;",
        "}();",
        f"(void){name};",
    ]


def handed_over(w: Writer):
    name = w.unused("w")
    w.top += [
        w.random.choice([
            f"template <class F> void {name}(F f) {{ f(); }}",
            f"void {name}(std::function<void()> f = nullptr) {{ if (f) {{ f(); }} }}",
            f"template <class F, class... A> void {name}(F && f, A &&... a) {{ std::forward<F>(f)(std::forward<A>(a)...); }}",
        ])
    ]  # fmt: skip
    w.body = [f"{name}([&] {{", _block(w), "});"]


WRAPPERS = [
    *(lambda_called, generic_lambda, branch, loop, loop_of_one_round, handler, case, function),
    *(function_template, function_of_a_namespace, function_that_calls_itself, method),
    *(method_of_a_base, constructor, functor, static_method, stored_function, thread, static_once),
    handed_over,
]
