#pragma once
#include <functional>
#include <string_view>

namespace rubble {

/// Called with the names of stage and kernel before each kernel of a step, and with "between steps" at its
/// end.
using KernelObserver = std::function<void(std::string_view stage, std::string_view kernel)>;

}  // namespace rubble
