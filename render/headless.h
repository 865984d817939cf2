#pragma once
/// An OpenGL context without a window or a display.
#include <memory>
#include <string>

namespace rubble::render {

/// Makes a context (core, 4.3 or else 4.1) current on this thread for as long as it lives: on the GPU where
/// EGL offers one without a display, else on Mesa's software renderer. RUBBLE_GL=software asks for the
/// latter.
class HeadlessContext {
 public:
  /// Throws Error if there is none.
  HeadlessContext();
  ~HeadlessContext();
  HeadlessContext(const HeadlessContext&) = delete;
  HeadlessContext& operator=(const HeadlessContext&) = delete;

  /// What draws: "llvmpipe (LLVM 15.0.6, 256 bits)", "NVIDIA H200 ...".
  const std::string& renderer() const;
  bool isSoftware() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rubble::render
