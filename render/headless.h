#pragma once
/// An OpenGL context without a window or a display.
#include <memory>
#include <string>

namespace rubble::render {

/// What is current on this thread, and is so again when this ends.
class KeptContext {
 public:
  KeptContext();
  ~KeptContext();
  KeptContext(const KeptContext&) = delete;
  KeptContext& operator=(const KeptContext&) = delete;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A context (core, 4.3 or else 4.1): on the GPU where EGL offers one without a display, else on Mesa's
/// software renderer. RUBBLE_GL=software asks for the latter. It is current on the thread that makes it.
class HeadlessContext {
 public:
  /// Throws Error if there is none.
  HeadlessContext();
  /// Where it is current on this thread, none is afterwards.
  ~HeadlessContext();
  HeadlessContext(const HeadlessContext&) = delete;
  HeadlessContext& operator=(const HeadlessContext&) = delete;

  /// What draws: "llvmpipe (LLVM 15.0.6, 256 bits)", "NVIDIA H200 ...".
  const std::string& renderer() const;
  bool isSoftware() const;
  /// Makes it current on this thread. Throws Error while it is so on another one.
  void makeCurrent() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rubble::render
