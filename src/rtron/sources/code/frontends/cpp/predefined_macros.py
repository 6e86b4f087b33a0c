"""What is defined before a file begins, written as the preprocessor reads it.

It describes g++ on Linux with ROS Kinetic to Noetic, and gives words that the parser does not know
a form it does: Qt's (https://doc.qt.io/qt-5/signalsandslots.html), Boost.Foreach's, CUDA's, and
the registrations of plugins (ROS wiki: pluginlib, nodelet; gazebosim.org: plugins). Types of
messages that rosidl's macros give to C are texts.
"""

PREDEFINED_MACROS = """
#define __cplusplus 201402
#define __linux__ 1
#define __linux 1
#define __unix__ 1
#define __x86_64__ 1
#define __GNUC__ 7
#define __GNUC_MINOR__ 5
#define __LINE__ 0
#define __FILE__ ""
#define ROS_VERSION_MINIMUM(a, b, c) 1
#define ROS_VERSION_GE(a, b, c, d, e, f) 1
#define CV_MAJOR_VERSION 3
#define CV_VERSION_MAJOR 3
#define CV_MINOR_VERSION 2
#define CV_VERSION_MINOR 2
#define BOOST_VERSION 106501
#define GAZEBO_MAJOR_VERSION 9
#define QT_VERSION 0x050905
#define QT_VERSION_CHECK(a, b, c) ((a << 16) | (b << 8) | (c))
#define PCL_VERSION_COMPARE(operation, a, b, c) (10801 operation (a * 10000 + b * 100 + c))
#define EIGEN_VERSION_AT_LEAST(a, b, c) 1
#define RCLCPP_VERSION_GTE(a, b, c) 1
#define __attribute__(x)
#define __declspec(x)
#define __restrict__
#define __restrict
#define __inline__ inline
#define __inline inline
#define __forceinline inline
#define __extension__
#define __volatile__ volatile
#define __host__
#define __device__
#define __global__
#define __shared__
#define __constant__
#define __launch_bounds__(...)
#define BOOST_FOREACH(target, values) for (target : values)
#define BOOST_REVERSE_FOREACH(target, values) for (target : values)
#define Q_FOREACH(target, values) for (target : values)
#define Q_FOREVER for (;;)
#define Q_OBJECT
#define Q_GADGET
#define Q_DISABLE_COPY(x)
#define Q_PROPERTY(...)
#define Q_ENUMS(...)
#define Q_ENUM(x)
#define Q_FLAGS(...)
#define Q_INTERFACES(...)
#define Q_PLUGIN_METADATA(...)
#define Q_DECLARE_METATYPE(x)
#define Q_DECLARE_TYPEINFO(...)
#define Q_INVOKABLE
#define Q_SLOTS
#define Q_SIGNALS public
#define Q_SIGNAL
#define Q_SLOT
#define Q_EMIT
#define Q_DECL_OVERRIDE override
#define Q_DECL_FINAL final
#define SIGNAL(x) #x
#define SLOT(x) #x
#define POINT_CLOUD_REGISTER_POINT_STRUCT(...)
#define BOOST_OVERRIDE override
#define BOOST_NOEXCEPT noexcept
#define EIGEN_MAKE_ALIGNED_OPERATOR_NEW
#define EIGEN_STRONG_INLINE inline
#define EIGEN_ALIGN16
#define EIGEN_DEVICE_FUNC
#define EIGEN_UNUSED
#define PLUGINLIB_EXPORT_CLASS(type, base) using PLUGINLIB_EXPORT_CLASS = exported<type, base>;
#define PLUGINLIB_DECLARE_CLASS(pkg, name, type, base) PLUGINLIB_EXPORT_CLASS(type, base)
#define PLUGINLIB_REGISTER_CLASS(name, type, base) PLUGINLIB_EXPORT_CLASS(type, base)
#define CLASS_LOADER_REGISTER_CLASS(type, base) PLUGINLIB_EXPORT_CLASS(type, base)
#define RCLCPP_COMPONENTS_REGISTER_NODE(type) using PLUGINLIB_EXPORT_CLASS = exported<type>;
#define RCLCPP_USING_CUSTOM_TYPE_AS_ROS_MESSAGE_TYPE(t, m) using RCLCPP_ADAPTED = adapted<t, m>;
#define ROSIDL_GET_MSG_TYPE_SUPPORT(package, folder, name) #package "/" #folder "/" #name
#define ROSIDL_GET_SRV_TYPE_SUPPORT(package, folder, name) #package "/" #folder "/" #name
#define ROSIDL_GET_ACTION_TYPE_SUPPORT(package, name) #package "/action/" #name
#define BT_REGISTER_NODES(name) void BT_RegisterNodesFromPlugin(BT::BehaviorTreeFactory & name)
#define CreateRosNodePlugin(type, name) void BT_RegisterRosNodeFromPlugin( \
  BT::BehaviorTreeFactory & factory, const BT::RosNodeParams & params) \
  { factory.registerNodeType<type>(name, params); }
#define GZ_REGISTER_MODEL_PLUGIN(type) PLUGINLIB_EXPORT_CLASS(type, gazebo::ModelPlugin)
#define GZ_REGISTER_WORLD_PLUGIN(type) PLUGINLIB_EXPORT_CLASS(type, gazebo::WorldPlugin)
#define GZ_REGISTER_SENSOR_PLUGIN(type) PLUGINLIB_EXPORT_CLASS(type, gazebo::SensorPlugin)
#define GZ_REGISTER_SYSTEM_PLUGIN(type) PLUGINLIB_EXPORT_CLASS(type, gazebo::SystemPlugin)
#define GZ_REGISTER_VISUAL_PLUGIN(type) PLUGINLIB_EXPORT_CLASS(type, gazebo::VisualPlugin)
#define GZ_REGISTER_GUI_PLUGIN(type) PLUGINLIB_EXPORT_CLASS(type, gazebo::GUIPlugin)
"""

LOGGING_MACROS = "\n".join(
    f"#define RCLCPP_{level}{stream}{how}(...)"
    for level in ("DEBUG", "INFO", "WARN", "ERROR", "FATAL")
    for stream in ("", "_STREAM")
    for how in (
        *("", "_ONCE", "_EXPRESSION", "_FUNCTION", "_SKIPFIRST"),
        *("_THROTTLE", "_SKIPFIRST_THROTTLE"),
    )
)
"""What rclcpp's programs say, which joins no nodes (rclcpp/logging.hpp)."""

QT_MACROS = """
#define slots
#define signals public
#define emit
#define foreach(target, values) for (target : values)
#define forever for (;;)
"""

EXPORT_ALIAS = "PLUGINLIB_EXPORT_CLASS"
ADAPTER_ALIAS = "RCLCPP_ADAPTED"
