#pragma once
#include <memory>
#include <string>
#include <vector>

#include "io/scene_json.h"
#include "scenes/registry.h"

namespace rubble::cli {

/// One thing that can be measured of a body or joint by name: "crate.height_m".
struct NamedMetric {
  const char* quantity;
  const char* doc;
};
const std::vector<NamedMetric>& bodyMetrics();
const std::vector<NamedMetric>& jointMetrics();
/// Names of what is measured of the whole scene; `smashes` adds what is measured after a smash.
std::vector<std::string> sceneMetrics(bool smashes);

/// Measures the "name.quantity" metrics that the claims of a file name, at the end of the run.
std::unique_ptr<scenes::Probe> namedProbe(const std::vector<io::FileClaim>& claims);

/// The fault of the metric of a claim, or "".
std::string metricFault(const io::SceneFile& file, const std::string& metric);

}  // namespace rubble::cli
