#pragma once
/// The log of a world. The library writes to no stream: it returns reports, throws errors, and calls this.
#include <functional>
#include <string_view>

namespace rubble {

enum class LogLevel {
  Info,     ///< tables that grew, joints that broke
  Warning,  ///< results that are worse than they should be, such as quarantined bodies
};

/// Receives a line, without a line break. World::step() and Worlds::step() call it at their end, on the
/// thread that called them. What it throws leaves step() after the step was taken. It must not call a world.
using LogSink = std::function<void(LogLevel level, std::string_view line)>;

}  // namespace rubble
