/* A relay as one writes it in C on rcl, one topic to another, until its process is ended. */
#include <rcl/rcl.h>

#define TRY(call) do { rcl_ret_t code = (call); if (code != RCL_RET_OK) return code; } while (0)

/* Return rcl's error code if it cannot relay. */
int relay(const rosidl_message_type_support_t *type, const char *from, const char *to, size_t depth) {
  rcl_allocator_t allocator = rcl_get_default_allocator();
  rcl_init_options_t init = rcl_get_zero_initialized_init_options();
  rcl_context_t context = rcl_get_zero_initialized_context();
  rcl_node_t node = rcl_get_zero_initialized_node();
  rcl_subscription_t input = rcl_get_zero_initialized_subscription();
  rcl_publisher_t output = rcl_get_zero_initialized_publisher();
  rcl_wait_set_t wait_set = rcl_get_zero_initialized_wait_set();
  rcl_serialized_message_t message = rmw_get_zero_initialized_serialized_message();
  rcl_node_options_t node_options = rcl_node_get_default_options();
  rcl_subscription_options_t input_options = rcl_subscription_get_default_options();
  rcl_publisher_options_t output_options = rcl_publisher_get_default_options();

  node_options.enable_rosout = false;
  input_options.qos.depth = output_options.qos.depth = depth;
  TRY(rcl_init_options_init(&init, allocator));
  TRY(rcl_init(0, NULL, &init, &context));
  TRY(rcl_node_init(&node, "bench_c_relay", "", &context, &node_options));
  TRY(rcl_subscription_init(&input, &node, type, from, &input_options));
  TRY(rcl_publisher_init(&output, &node, type, to, &output_options));
  TRY(rcl_wait_set_init(&wait_set, 1, 0, 0, 0, 0, 0, &context, allocator));
  TRY(rmw_serialized_message_init(&message, 0, &allocator));
  for (;;) {
    TRY(rcl_wait_set_clear(&wait_set));
    TRY(rcl_wait_set_add_subscription(&wait_set, &input, NULL));
    TRY(rcl_wait(&wait_set, -1));
    while (rcl_take_serialized_message(&input, &message, NULL, NULL) == RCL_RET_OK)
      TRY(rcl_publish_serialized_message(&output, &message, NULL));
  }
}
