#include "apps/cli/progress.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>

#include "apps/cli/system.h"
#include "platform/system.h"

namespace rubble::cli {
namespace {

constexpr int kBarWidth = 30;
/// Time between two drawings of the bar [s].
constexpr double kRedraw = .1;

std::string duration(double seconds) {
  const int whole = static_cast<int>(std::lround(seconds));
  return whole < 60 ? fmt::format("{} s", whole) : fmt::format("{}:{:02} min", whole / 60, whole % 60);
}
/// `ms`: of the last step; 0: it did not take one.
std::string speed(double ms, const char* after) {
  return ms > 0 ? fmt::format("{:.1f} ms/step{}", ms, after) : "";
}

}  // namespace

Progress::Progress(std::string title, int steps, bool quiet, std::string unit)
    : title_(std::move(title)),
      unit_(std::move(unit)),
      steps_(std::max(steps, 1)),
      quiet_(quiet),
      terminal_(platform::isTerminal(stderr)),
      startTime_(secondsNow()) {}

Progress::~Progress() {
  if (barIsOpen_) fmt::print(stderr, "\n");
}

void Progress::update(int done, double ms) {
  if (quiet_) return;
  terminal_ ? drawBar(done, ms) : printLine(done, ms);
}

void Progress::drawBar(int done, double ms) {
  const double now = secondsNow();
  if (done < steps_ && now - lastDrawn_ < kRedraw) return;
  lastDrawn_ = now;
  const int filled = std::min(kBarWidth, kBarWidth * done / steps_);
  std::string bar;
  for (int i = 0; i < kBarWidth; ++i) bar += i < filled ? "█" : "░";
  const double elapsed = now - startTime_;
  const double left = elapsed / done * (steps_ - done);
  fmt::print(stderr, "\r{} {} {} {}/{}  {}{}\x1b[K", title_, bar, unit_, done, steps_, speed(ms, "  "),
             done < steps_ ? duration(left) + " left" : duration(elapsed));
  std::fflush(stderr);
  barIsOpen_ = done < steps_;
  if (!barIsOpen_) fmt::print(stderr, "\n");
}

void Progress::printLine(int done, double ms) {
  const int tenths = 10 * done / steps_;
  if (tenths == tenthsPrinted_) return;
  tenthsPrinted_ = tenths;
  const double elapsed = secondsNow() - startTime_;
  fmt::print(stderr, "{}: {} {}/{}, {}{}, {} left\n", title_, unit_, done, steps_, speed(ms, ", "),
             duration(elapsed), duration(elapsed / done * (steps_ - done)));
}

}  // namespace rubble::cli
