#pragma once
/// Tests that need a device.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include <rubble/info.h>
#include <rubble/rubble.h>

namespace rubble::test {

inline bool hasCuda() {
  const std::vector<std::string> names = backends();
  return std::find(names.begin(), names.end(), "cuda") != names.end();
}

inline bool isStrict() {
  return std::ranges::any_of(buildInfo().features,
                             [](const std::string& f) { return f.find("strict") != std::string::npos; });
}

/// These tests need a device and are skipped without one.
class CudaTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!hasCuda()) GTEST_SKIP() << "CUDA is " << cudaStatus();
  }
};

}  // namespace rubble::test
