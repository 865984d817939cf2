#include "apps/viewer/viewer.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

#include <epoxy/gl.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui/backends/imgui_impl_glfw.h>
#include <imgui/backends/imgui_impl_opengl3.h>
#include <imgui/imgui.h>

#include <rubble/error.h>

#include "apps/viewer/orbit.h"
#include "apps/viewer/panels.h"
#include "io/json_text.h"
#include "io/scene_json.h"
#include "render/stage.h"

namespace rubble::viewer {
namespace {

/// A press that moves less than this is a click [pixels].
constexpr double kClick = 4;
constexpr double kZoomStep = 1.12, kSpeedStep = 1.5;

class Window {
 public:
  Window(int width, int height) {
    if (!glfwInit()) throw Error("view", "a display (X11 or Wayland)", "none; 'rubble render' needs none");
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 1);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    handle_ = glfwCreateWindow(width, height, "Rubble", nullptr, nullptr);
    if (!handle_) {
      glfwTerminate();
      throw Error("view", "a window with OpenGL 4.1", "none");
    }
    glfwMakeContextCurrent(handle_);
    glfwSwapInterval(1);
  }
  ~Window() {
    glfwDestroyWindow(handle_);
    glfwTerminate();
  }
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;
  GLFWwindow* handle() const { return handle_; }

 private:
  GLFWwindow* handle_;
};

class Panels {
 public:
  explicit Panels(GLFWwindow* window) {
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    ImGui::StyleColorsLight();
    ImGui::GetStyle().WindowRounding = 6;
    ImGui::GetStyle().Colors[ImGuiCol_WindowBg].w = .88f;
    ImGui_ImplGlfw_InitForOpenGL(window, true);
    ImGui_ImplOpenGL3_Init("#version 410 core");
  }
  ~Panels() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
  }
  Panels(const Panels&) = delete;
  Panels& operator=(const Panels&) = delete;
};

class Viewer {
 public:
  explicit Viewer(const ViewerOptions& options) : options_(options), window_(options.width, options.height), player_(options.open) {
    glfwSetWindowUserPointer(window_.handle(), this);
    glfwSetKeyCallback(window_.handle(), [](GLFWwindow* w, int key, int, int action, int modifiers) {
      if (key == GLFW_KEY_Q && modifiers == GLFW_MOD_CONTROL)
        glfwSetWindowShouldClose(w, GLFW_TRUE);
      else if (action != GLFW_RELEASE)
        static_cast<Viewer*>(glfwGetWindowUserPointer(w))->key(key);
    });
    glfwSetCharCallback(window_.handle(),
                        [](GLFWwindow* w, unsigned letter) { static_cast<Viewer*>(glfwGetWindowUserPointer(w))->letter(letter); });
    glfwSetDropCallback(window_.handle(), [](GLFWwindow* w, int count, const char** files) {
      if (count > 0) static_cast<Viewer*>(glfwGetWindowUserPointer(w))->open(files[0]);
    });
    // Dear ImGui chains to the callbacks that were there before it.
    panels_ = std::make_unique<Panels>(window_.handle());
    player_.open(options.scene);
    begin();
  }

  void run() {
    double before = glfwGetTime();
    int frame = 0;
    while (!glfwWindowShouldClose(window_.handle()) && (options_.frames == 0 || frame < options_.frames)) {
      glfwPollEvents();
      const double now = glfwGetTime();
      player_.play(now - before);
      before = now;
      draw();
      ++frame;
      if (!options_.stateFile.empty()) writeState(frame);
    }
    if (!options_.screenshot.empty()) io::writePng(screen_, options_.screenshot);
  }

 private:
  void begin() {
    const scenes::Job& job = player_.job();
    const std::vector<io::PictureBody> bodies = io::pictureBodies(player_.world());
    io::PictureSettings settings;
    settings.width = options_.width;
    settings.height = options_.height;
    settings.fieldOfView = .5;
    io::frameBodies(io::pictureBodies(job.scene, true), job.scene.gravity, settings, {job.camera.target - job.camera.eye, .2});
    orbit_ = Orbit({settings.eye, settings.target, settings.up, settings.fieldOfView});
    stage_ = std::make_unique<render::Stage>(bodies, job.scene.gravity, orbit_.camera(), options_.width, options_.height);
    keys_.clear();
    desk_.selected.reset();
    pressed_ = false;
  }

  void open(const std::string& scene) {
    try {
      player_.open(scene);
      desk_.message.clear();
      begin();
    } catch (const Error& error) {
      desk_.message = error.what();
    }
  }

  void openNeighbour(int by) {
    const auto at = std::find(options_.scenes.begin(), options_.scenes.end(), player_.scene());
    if (at == options_.scenes.end()) return;
    const auto count = static_cast<int>(options_.scenes.size());
    const int index = (static_cast<int>(at - options_.scenes.begin()) + by + count) % count;
    open(options_.scenes[static_cast<std::size_t>(index)]);
  }

  void key(int key) {
    if (key == GLFW_KEY_ESCAPE) desk_.selected.reset(), desk_.showPicker = false;
    if (desk_.showPicker) {
      // Here and not from Dear ImGui, which does not see a key that goes down and up within one frame.
      desk_.takeChoice = desk_.takeChoice || key == GLFW_KEY_ENTER || key == GLFW_KEY_KP_ENTER;
      desk_.choice += key == GLFW_KEY_DOWN ? 1 : key == GLFW_KEY_UP ? -1 : 0;
    }
    if (ImGui::GetIO().WantTextInput || desk_.showPicker) return;
    switch (key) {
      case GLFW_KEY_SPACE:
        player_.paused = !player_.paused;
        break;
      case GLFW_KEY_N:
        player_.paused = true, player_.step();
        break;
      case GLFW_KEY_R:
        player_.restart(), begin();
        break;
      case GLFW_KEY_B:
        shoot();
        break;
      case GLFW_KEY_P:
        desk_.showPicker = desk_.focusPicker = true, openedPicker_ = true;
        break;
      case GLFW_KEY_PAGE_UP:
        openNeighbour(-1);
        break;
      case GLFW_KEY_PAGE_DOWN:
        openNeighbour(1);
        break;
      case GLFW_KEY_F:
        begin();
        break;
      case GLFW_KEY_C:
        desk_.colorBy = desk_.colorBy == io::ColorBy::Body ? io::ColorBy::Speed : io::ColorBy::Body;
        break;
      case GLFW_KEY_MINUS:
        player_.speed /= kSpeedStep;
        break;
      case GLFW_KEY_EQUAL:
        player_.speed *= kSpeedStep;
        break;
      default:
        break;
    }
  }

  void letter(unsigned letter) {
    if (letter == '?' && !ImGui::GetIO().WantTextInput) desk_.showHelp = !desk_.showHelp;
  }

  double aspect() const { return static_cast<double>(width_) / height_; }
  Vec3 rayAt(const ImVec2& mouse) const { return orbit_.ray(double{mouse.x} / width_, double{mouse.y} / height_, aspect()); }

  void shoot() {
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    player_.shoot(orbit_.camera().eye, rayAt(mouse), stage_->setting().bodySize);
  }

  void mouse() {
    const ImGuiIO& io = ImGui::GetIO();
    const double dx = double{io.MouseDelta.x} / height_, dy = double{-io.MouseDelta.y} / height_;
    const bool free = !io.WantCaptureMouse;
    if (free && io.MouseWheel != 0) orbit_.zoom(std::pow(kZoomStep, io.MouseWheel));
    if (free && ImGui::IsMouseClicked(0)) press(io.MousePos);
    if (pressed_ && ImGui::IsMouseDown(0)) {
      if (player_.held())
        pull(io.MousePos);
      else
        orbit_.turn(dx, dy);
    }
    if (pressed_ && ImGui::IsMouseReleased(0)) {
      pressed_ = false;
      player_.release();
      if (std::hypot(io.MousePos.x - pressedAt_.x, io.MousePos.y - pressedAt_.y) < kClick) desk_.selected = under_;
    }
    if (free && ImGui::IsMouseDown(1)) orbit_.turn(dx, dy);
    if (free && ImGui::IsMouseDown(2)) orbit_.pan(dx, dy);
  }

  void press(const ImVec2& at) {
    pressed_ = true;
    pressedAt_ = at;
    under_.reset();
    const int body = stage_->renderer().bodyAt(static_cast<int>(at.x), static_cast<int>(at.y));
    if (body < 0 || static_cast<std::size_t>(body) >= keys_.size()) return;
    under_ = player_.bodyWithKey(keys_[static_cast<std::size_t>(body)]);
    if (!under_) return;
    const Vec3 point = stage_->renderer().pointAt(static_cast<int>(at.x), static_cast<int>(at.y));
    const render::Camera camera = orbit_.camera();
    gripDepth_ = dot(point - camera.eye, normalize(camera.target - camera.eye));
    player_.grab(*under_, point);
  }

  /// The held point follows the mouse in the plane that faces the camera at the depth where it was taken.
  void pull(const ImVec2& at) {
    const render::Camera camera = orbit_.camera();
    const Vec3 ray = rayAt(at);
    player_.pull(camera.eye + ray * (gripDepth_ / dot(ray, normalize(camera.target - camera.eye))));
  }

  void draw() {
    glfwGetFramebufferSize(window_.handle(), &width_, &height_);
    width_ = std::max(width_, 1), height_ = std::max(height_, 1);
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    if (openedPicker_) {
      // The key that opens the picker is not part of the search.
      ImGui::GetIO().ClearInputCharacters();
      openedPicker_ = false;
    }
    ImGui::NewFrame();
    mouse();
    const std::string chosen = drawPanels(desk_, player_, options_.scenes);
    if (!chosen.empty()) open(chosen);
    const std::vector<io::PictureBody> bodies = io::pictureBodies(player_.world());
    keys_.clear();
    int selected = -1;
    for (const io::PictureBody& body : bodies) {
      if (desk_.selected && body.key == static_cast<std::uint32_t>(desk_.selected->index)) selected = static_cast<int>(keys_.size());
      keys_.push_back(body.key);
    }
    stage_->setBodies(bodies, desk_.colorBy);
    render::Renderer& renderer = stage_->renderer();
    renderer.resize(width_, height_);
    renderer.select(selected);
    renderer.draw(orbit_.camera(), stage_->setting(), {});
    renderer.show(0);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    ImGui::Render();
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    if (!options_.screenshot.empty()) capture();
    glfwSwapBuffers(window_.handle());
  }

  void capture() {
    screen_ = {width_, height_, {}};
    const std::size_t row = 3 * static_cast<std::size_t>(width_);
    std::vector<std::uint8_t> upward(row * static_cast<std::size_t>(height_));
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width_, height_, GL_RGB, GL_UNSIGNED_BYTE, upward.data());
    for (int y = height_ - 1; y >= 0; --y)
      screen_.rgb.insert(screen_.rgb.end(), upward.begin() + static_cast<std::ptrdiff_t>(row) * y,
                         upward.begin() + static_cast<std::ptrdiff_t>(row) * (y + 1));
  }

  void writeState(int frame) {
    nlohmann::ordered_json bodies = nlohmann::ordered_json::object();
    int shots = 0;
    for (const BodyId id : player_.world().bodies()) {
      const std::string& name = player_.world().definition(id).name;
      const Vec3 p = player_.world().state(id).position;
      shots += name == "shot";
      if (!name.empty()) bodies[name] = {p.x, p.y, p.z};
    }
    const Vec3 eye = orbit_.camera().eye;
    const bool hasSelected = desk_.selected && player_.world().alive(*desk_.selected);
    const std::string unfinished = options_.stateFile + ".new";
    io::writeText(unfinished, io::prettyJson({{"frame", frame},
                                              {"scene", player_.scene()},
                                              {"paused", player_.paused},
                                              {"steps", player_.world().stepCount()},
                                              {"speed", player_.speed},
                                              {"color_by", desk_.colorBy == io::ColorBy::Speed ? "speed" : "body"},
                                              {"help", desk_.showHelp},
                                              {"shots", shots},
                                              {"selected", hasSelected ? player_.world().definition(*desk_.selected).name : ""},
                                              {"eye", {eye.x, eye.y, eye.z}},
                                              {"held", player_.held().has_value()},
                                              {"bodies", bodies}}));
    std::filesystem::rename(unfinished, options_.stateFile);
  }

  ViewerOptions options_;
  Window window_;
  Player player_;
  std::unique_ptr<Panels> panels_;
  std::unique_ptr<render::Stage> stage_;
  Orbit orbit_;
  Desk desk_;
  std::vector<std::uint32_t> keys_;  ///< of the bodies as they are drawn
  int width_ = 1, height_ = 1;
  bool pressed_ = false, openedPicker_ = false;
  ImVec2 pressedAt_;
  std::optional<BodyId> under_;
  double gripDepth_ = 0;  ///< view depth of the held point [m]
  io::Image screen_;
};

}  // namespace

void runViewer(const ViewerOptions& options) { Viewer(options).run(); }

}  // namespace rubble::viewer
