#pragma once
/// The window and the context of Dear ImGui.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace rubble::viewer {

class Window {
 public:
  /// Throws Error without a display or OpenGL 4.1.
  Window(int width, int height);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;
  GLFWwindow* handle() const { return handle_; }

 private:
  GLFWwindow* handle_ = nullptr;
};

/// Dear ImGui chains to the callbacks that the window has before it.
class PanelContext {
 public:
  explicit PanelContext(GLFWwindow* window);
  ~PanelContext();
  PanelContext(const PanelContext&) = delete;
  PanelContext& operator=(const PanelContext&) = delete;
};

}  // namespace rubble::viewer
