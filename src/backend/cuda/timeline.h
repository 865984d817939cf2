#pragma once
/// Stage times of an enqueued step, measured by CUDA events. The step never waits for them.
#include <cstring>
#include <vector>

#include <rubble/report.h>

#include "backend/cuda/cuda_check.h"

namespace rubble {

class Timeline {
 public:
  Timeline() = default;
  ~Timeline() {
    for (cudaEvent_t event : events_) cudaEventDestroy(event);
  }
  Timeline(const Timeline&) = delete;
  Timeline& operator=(const Timeline&) = delete;

  void clear() { names_.clear(); }

  /// Starts stage `name`; nullptr ends the last one. While a graph is captured the event becomes a node of
  /// it.
  void mark(const char* name, cudaStream_t stream, bool captured) {
    if (names_.size() == events_.size()) {
      cudaEvent_t event;
      checkCuda(cudaEventCreate(&event), "cudaEventCreate");
      events_.push_back(event);
    }
    const unsigned flags = captured ? cudaEventRecordExternal : cudaEventRecordDefault;
    checkCuda(cudaEventRecordWithFlags(events_[names_.size()], stream, flags), "cudaEventRecord");
    names_.push_back(name);
  }

  /// Adds the times [ms] of the last run, which must have ended.
  void addTo(std::vector<StageTime>& times) const {
    for (std::size_t i = 0; i + 1 < names_.size(); ++i) {
      if (!names_[i]) continue;
      float ms = 0;
      checkCuda(cudaEventElapsedTime(&ms, events_[i], events_[i + 1]), "cudaEventElapsedTime");
      std::size_t k = 0;
      while (k < times.size() && times[k].name != names_[i]) ++k;
      if (k == times.size()) times.push_back({names_[i], 0});
      times[k].ms += static_cast<double>(ms);
    }
  }

 private:
  std::vector<cudaEvent_t> events_;
  std::vector<const char*> names_;
};

}  // namespace rubble
