"""What stands in braces becomes what it is assigned to, returned as, or put into."""

import pytest
import ros1_runs
import ros2_runs

ROS1 = 'nh.advertise<std_msgs::Bool>("{}", 1)'
ROS2 = 'create_publisher<std_msgs::msg::Bool>("{}", 1)'
LED = """
enum Led { POWER, USER };
struct Light {
  rclcpp::Publisher<std_msgs::msg::Bool>::SharedPtr made;
  explicit Light(int color) {}
  void make(rclcpp::Node * node, std::string topic) {
    made = node->create_publisher<std_msgs::msg::Bool>(topic, 1); }
};
struct Pair { rclcpp::Publisher<std_msgs::msg::Bool>::SharedPtr made; int n; };
"""
EACH = "for (auto & name : names) { nh.advertise<std_msgs::Bool>(name, 1); }"
BOTH = "for (auto & [key, name] : names) { nh.advertise<std_msgs::Bool>(name, 1); }"


def test_a_map_of_pointers_is_a_map_behind_the_assignment():
    members = "std::map<Led, std::shared_ptr<Light>> leds_;"
    body = """
    leds_ = { {Led::POWER, std::make_shared<Light>(1)}, {Led::USER, std::make_shared<Light>(2)}, };
    leds_[Led::POWER]->make(this, "power");
    leds_[USER]->make(this, "user");
    """
    found = ros2_runs.cpp(body, top=LED, members=members)
    assert (ros2_runs.names(found), found.unresolved) == (["/ns/power", "/ns/user"], ())


def test_endpoints_in_the_braces_are_found_and_what_they_make_is_iterated():
    members = "std::map<std::string, Pair> pairs_; Pair one_;"
    body = f"""
    pairs_ = {{{{"a", {{{ROS2.format("x")}, 1}}}}, {{"b", Pair{{{ROS2.format("y")}, 2}}}}}};
    one_ = {{.made = {ROS2.format("z")}, .n = 3}};
    for (auto & [key, pair] : pairs_) {{
      create_publisher<std_msgs::msg::Bool>(key + std::to_string(pair.n), 1); }}
    create_publisher<std_msgs::msg::Bool>("n" + std::to_string(one_.n), 1);
    """
    found = ros2_runs.names(ros2_runs.cpp(body, top=LED, members=members))
    assert found == [f"/ns/{name}" for name in ("x", "y", "z", "a1", "b2", "n3")]


@pytest.mark.parametrize(
    "text",
    [
        'std::vector<std::string> names; names = {"a", "b"};' + EACH,
        'std::array<std::string, 2> names; names = {"a", "b"};' + EACH,
        'std::array<std::string, 2> names{{"a", "b"}};' + EACH,
        'std::array<std::string, 2> names{"a", "b"};' + EACH,
        'std::map<int, std::string> names; names = {{1, "a"}, {2, "b"}};' + BOTH,
        'std::vector<std::pair<int, std::string>> names; names = {{1, "a"}, {2, "b"}};' + BOTH,
        'std::map<int, std::string> names; names[1] = {"a"}; names.insert({2, "b"});' + BOTH,
        'std::multimap<int, std::string> names{{1, "a"}, {1, "b"}};' + BOTH,
        'S s; s = {1, {"a", "b"}}; auto & names = s.names;' + EACH,
        'S s{.names = {"a", "b"}}; auto & names = s.names;' + EACH,
        'std::vector<S> all; all.push_back({1, {"a", "b"}}); auto & names = all[0].names;' + EACH,
        "auto names = returned();" + EACH,
        'L list{"a", "b"}; auto & names = list.all;' + EACH,
        'L list = {"a", "b"}; auto & names = list.all;' + EACH,
        'std::set<std::string> names = {"a", "b"}; names = names;' + EACH,
        'std::vector<std::vector<std::string>> v = {{"a", "b"}}; auto & names = v[0];' + EACH,
    ],
)
def test_names_in_braces(text):
    top = """
    struct S { int n; std::vector<std::string> names; };
    struct L { std::vector<std::string> all;
      L(std::initializer_list<std::string> given) : all(given) {} explicit L(int) {} };
    std::vector<std::string> returned() { return {"a", "b"}; }
    """
    found = ros1_runs.cpp(text, top)
    assert (ros1_runs.names(found), found.unresolved) == (["a", "b"], ())


def test_numbers_in_braces_are_items_and_in_parentheses_a_size():
    loop = 'for (auto n : {}) {{ nh.advertise<std_msgs::Bool>("n" + std::to_string(n), 1); }}'
    braces = "std::vector<int> v{1, 2};" + loop.format("v")
    assert ros1_runs.names(ros1_runs.cpp(braces)) == ["n1", "n2"]
    size = "std::vector<int> v(3, 2);" + loop.format("v")
    assert ros1_runs.names(ros1_runs.cpp(size)) == ["n2"]


def test_each_item_of_an_array_is_an_object_of_its_own():
    top = "struct S { std::string name; };"
    for made in ("S all[2];", "std::vector<S> all(2);", "std::vector<S> all; all.resize(2);"):
        body = made + ' all[0].name = "a"; all[1].name = "b"; '
        body += "for (auto & one : all) { nh.advertise<std_msgs::Bool>(one.name, 1); }"
        assert ros1_runs.names(ros1_runs.cpp(body, top)) == ["a", "b"], made


def test_a_class_of_a_function_is_known_in_it():
    body = f"struct S {{ ros::Publisher p; }}; S s{{{ROS1.format('x')}}}; s.p.publish(1);"
    assert ros1_runs.names(ros1_runs.cpp(body)) == ["x"]


def test_enumerators_of_a_header_that_is_not_there_are_keys_by_their_names():
    members = "std::map<Kind, std::shared_ptr<Light>> lights_;"
    body = """
    lights_ = {{Kind::A, std::make_shared<Light>(1)}, {Kind::B, std::make_shared<Light>(2)}};
    lights_[Kind::A]->make(this, "a");
    lights_[Kind::B]->make(this, "b");
    for (auto & [kind, light] : lights_) { light->make(this, "all"); }
    """
    found = ros2_runs.cpp(body, top=LED, members=members)
    assert (ros2_runs.names(found), found.unresolved) == (["/ns/a", "/ns/b", "/ns/all"], ())
