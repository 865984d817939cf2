#pragma once
/// Times of the stages of a step. A stage lasts until the next one begins.
#include <algorithm>
#include <chrono>
#include <new>
#include <utility>
#include <vector>

#include <rubble/report.h>

namespace rubble::RUBBLE_CORE {

class StageClock {
 public:
  /// Ends the present stage. `name` is a literal.
  void enter(const char* name) {
    if (name == present_.name) return;
    const Clock::time_point now = Clock::now();
    end(now);
    begin_ = now;
    // Memory is taken here. A step does not fail for the want of its times.
    try {
      present_ = stageOf(name);
    } catch (const std::bad_alloc&) {
      present_ = {};
    }
  }
  /// Ends the present stage. Returns the times since the last call.
  std::vector<StageTime> take() noexcept {
    end(Clock::now());
    present_ = {};
    stages_.clear();
    return std::exchange(times_, {});
  }

 private:
  using Clock = std::chrono::steady_clock;
  struct Stage {
    const char* name = nullptr;  ///< null: none
    std::size_t index = 0;       ///< in the times
  };
  /// Stages are found by the address of their name. Other literals may have the same text.
  Stage stageOf(const char* name) {
    const auto known = std::ranges::find(stages_, name, &Stage::name);
    if (known != stages_.end()) return *known;
    const auto found = std::ranges::find(times_, name, &StageTime::name);
    const Stage stage{name, static_cast<std::size_t>(found - times_.begin())};
    if (found == times_.end()) times_.push_back({name, 0});
    stages_.push_back(stage);
    return stage;
  }
  void end(Clock::time_point now) {
    if (present_.name)
      times_[present_.index].ms += std::chrono::duration<double, std::milli>(now - begin_).count();
  }

  std::vector<Stage> stages_;
  std::vector<StageTime> times_;
  Stage present_;
  Clock::time_point begin_;
};

}  // namespace rubble::RUBBLE_CORE
