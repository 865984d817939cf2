#include "apps/viewer/window.h"

#include <algorithm>
#include <cstdlib>

#include <imgui/backends/imgui_impl_glfw.h>
#include <imgui/backends/imgui_impl_opengl3.h>
#include <imgui/imgui.h>

#include <rubble/error.h>

#include "render/gl.h"

namespace rubble::viewer {

Window::Window(int width, int height) {
  if (!glfwInit()) throw Error("view", "a display (X11 or Wayland)", "none; 'rubble render' needs none");
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  // Some drivers create exactly the requested version.
  for (const int minor : {render::gl::kComputeVersion % 10, 1}) {
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, minor);
    if (!handle_) handle_ = glfwCreateWindow(width, height, "Rubble", nullptr, nullptr);
  }
  if (!handle_) {
    glfwTerminate();
    throw Error("view", "a window with OpenGL 4.1", "none");
  }
  glfwMakeContextCurrent(handle_);
  glfwSwapInterval(1);
}

Window::~Window() {
  glfwDestroyWindow(handle_);
  glfwTerminate();
}

PanelContext::PanelContext(GLFWwindow* window) {
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;
  ImGui::StyleColorsLight();
  ImGui::GetStyle().WindowRounding = 6;
  ImGui::GetStyle().Colors[ImGuiCol_WindowBg].w = .88f;
  // of displays with more than 96 dots per inch; RUBBLE_UI_SCALE in its place
  float scale = 1, other = 1;
  glfwGetWindowContentScale(window, &scale, &other);
  if (const char* const given = std::getenv("RUBBLE_UI_SCALE")) scale = std::strtof(given, nullptr);
  scale = std::clamp(scale, 1.f, 4.f);
  ImGui::GetStyle().ScaleAllSizes(scale);
  ImGui::GetIO().FontGlobalScale = scale;
  ImGui_ImplGlfw_InitForOpenGL(window, true);
  ImGui_ImplOpenGL3_Init("#version 410 core");
}

PanelContext::~PanelContext() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
}

}  // namespace rubble::viewer
