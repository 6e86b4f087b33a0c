"""What C++ functions and constructors get: `f({…})`, defaults in braces, delegation."""

import pytest
from ros1_runs import cpp, names

ADVERTISE = 'nh.advertise<std_msgs::Bool>("x", 1);'
CLASS = """namespace filters {
class Filter {
 public:
  Filter(const ros::NodeHandle& nh = {}, const ros::NodeHandle& own = { "~" })
    : nh_{ nh }, own_{ own, "part" } { setup(); }
 private:
  ros::NodeHandle nh_, own_;
  void setup() { nh_.advertise<std_msgs::Bool>("x", 1); own_.advertise<std_msgs::Bool>("y", 1); }
};
}"""
TABLE = """void all(ros::NodeHandle nh, std::map<std::string, int> sizes) {
  for (auto& [name, size] : sizes) nh.advertise<std_msgs::Bool>(name, size);
}"""


@pytest.mark.parametrize(
    ("parameter", "call", "name"),
    [
        ("const ros::NodeHandle& nh = {}", "f();", "x"),
        ('ros::NodeHandle nh = {"k"}', "f();", "k/x"),
        ('const ros::NodeHandle& nh = ros::NodeHandle("k")', "f();", "k/x"),
        ("const ros::NodeHandle& nh", 'f({"k"});', "k/x"),
        ("const ros::NodeHandle& nh", "f({});", "x"),
    ],
)
def test_a_node_handle(parameter, call, name):
    interface = cpp(call, top=f"void f({parameter}) {{ {ADVERTISE} }}")
    assert (names(interface), interface.unresolved) == ([name], ())


def test_defaults_of_a_constructor_whose_object_is_called_like_its_namespace():
    interface = cpp("filters::Filter filters{};", top=CLASS)
    assert (names(interface), interface.unresolved) == (["x", "n/part/y"], ())


def test_a_function_that_is_only_declared_may_write_to_what_it_gets_by_reference():
    top = "bool fill(const std::string& key, std::string& value);"
    interface = cpp('std::string s = "k"; fill("a", s); nh.advertise<std_msgs::Bool>(s, 1);', top)
    assert names(interface) == ["{s}"]


def test_a_function_that_is_only_declared_and_gets_a_node_handle_is_noted():
    interface = cpp("join(nh);", "void join(ros::NodeHandle& nh);")
    assert [note.what for note in interface.unresolved] == ["join()"]


def test_a_map():
    interface = cpp('all(nh, {{"a", 1}, {"b", 2}});', top=TABLE)
    assert (names(interface), interface.unresolved) == (["a", "b"], ())


DELEGATING = """namespace filters {
template<class T> class Filter {
 public:
  Filter(ros::NodeHandle nh, ros::NodeHandle own, std::string name);
  Filter(ros::NodeHandle nh, ros::NodeHandle own);
  ros::NodeHandle nh_, own_;
};
template<typename T> Filter<T>::Filter(ros::NodeHandle nh, ros::NodeHandle own, std::string name)
  : nh_(nh), own_(own) { own_.advertise<std_msgs::Bool>(name, 1); }
template<typename T> Filter<T>::Filter(ros::NodeHandle nh, ros::NodeHandle own)
  : %s(nh, own, "x") {}
}"""


@pytest.mark.parametrize("name", ["Filter", "Filter<T>", "Filter<T>::Filter", "filters::Filter<T>"])
def test_a_constructor_that_delegates_by_any_of_its_names(name):
    interface = cpp('ros::NodeHandle own("~"); filters::Filter<int> f(nh, own);', DELEGATING % name)
    assert (names(interface), interface.unresolved) == (["n/x"], ())


@pytest.mark.parametrize("base", ["Base", "Base::Base", "own::Base", "own::Base::Base"])
def test_a_base_is_called_by_any_of_its_names(base):
    top = """namespace own { struct Base { Base(ros::NodeHandle nh, std::string name) {
      nh.advertise<std_msgs::Bool>(name, 1); } };
    struct Part : public Base { Part(ros::NodeHandle nh) : %s(nh, "x") {} }; }"""
    assert names(cpp("own::Part part(nh);", top % base)) == ["x"]


def test_a_bound_method_that_is_pure_virtual_is_that_of_the_object():
    top = """struct Server { boost::function<void(std::string)> load;
      ros::NodeHandle nh;
      Server() : load(boost::bind(&Server::make, this, _1)) {}
      virtual void make(std::string name) = 0;
      void all() { load("x"); } };
    struct Mine : public Server {
      void make(std::string name) { nh.advertise<std_msgs::Bool>(name, 1); } };"""
    assert names(cpp("Mine mine; mine.all();", top)) == ["x"]


TRY_BLOCK = """struct Base { ros::NodeHandle nh; std::string name; Base(ros::NodeHandle given)
  try : nh(given, "k"), name("x") { nh.advertise<std_msgs::Bool>(name, 1); }
  catch (const std::exception& error) { throw; } };
template <class T> struct Part : Base { T size; Part(ros::NodeHandle given); };
template <class T> Part<T>::Part(ros::NodeHandle given) try : Base(given), size(1) {
  nh.advertise<std_msgs::Bool>("y", 1); } catch (...) {}"""


def test_a_constructor_whose_body_is_a_try_block():
    interface = cpp("Part<int> part(nh);", TRY_BLOCK)
    assert (names(interface), interface.unresolved) == (["k/x", "k/y"], ())
