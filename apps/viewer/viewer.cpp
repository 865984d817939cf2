#include "apps/viewer/viewer.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

#include <epoxy/gl.h>

#include <imgui/backends/imgui_impl_glfw.h>
#include <imgui/backends/imgui_impl_opengl3.h>
#include <imgui/imgui.h>

#include <rubble/error.h>

#include "apps/viewer/dragger.h"
#include "apps/viewer/recording_session.h"
#include "apps/viewer/scene_view.h"
#include "apps/viewer/state_file.h"
#include "apps/viewer/window.h"
#include "io/picture_values.h"
#include "io/scene_json.h"

namespace rubble::viewer {
namespace {

/// A press that moves less than this is a click [pixels].
constexpr double kClick = 4;
constexpr double kZoomStep = 1.12, kSpeedStep = 1.5;

class Viewer {
 public:
  static Viewer* viewerOf(GLFWwindow* window) {
    return static_cast<Viewer*>(glfwGetWindowUserPointer(window));
  }

  explicit Viewer(const ViewerOptions& options) : options_(options), window_(options.width, options.height) {
    glfwSetWindowUserPointer(window_.handle(), this);
    glfwSetKeyCallback(window_.handle(), [](GLFWwindow* w, int key, int, int action, int modifiers) {
      if (key == GLFW_KEY_Q && modifiers == GLFW_MOD_CONTROL)
        glfwSetWindowShouldClose(w, GLFW_TRUE);
      else if (action != GLFW_RELEASE)
        viewerOf(w)->guarded([&] { viewerOf(w)->key(key, (modifiers & GLFW_MOD_SHIFT) != 0); });
    });
    glfwSetCharCallback(window_.handle(),
                        [](GLFWwindow* w, unsigned letter) { viewerOf(w)->letter(letter); });
    glfwSetDropCallback(window_.handle(), [](GLFWwindow* w, int count, const char** files) {
      if (count > 0) viewerOf(w)->open({files[0], {}, ""});
    });
    panels_ = std::make_unique<PanelContext>(window_.handle());
    session_ = sessionOf(options.first);
    request_ = options.first;
    view_.begin(*session_, options.width, options.height);
  }

  void run() {
    double before = glfwGetTime();
    int frame = 0;
    while (!glfwWindowShouldClose(window_.handle()) && (options_.frames == 0 || frame < options_.frames)) {
      glfwPollEvents();
      const double now = glfwGetTime();
      guarded([&] { session_->play(now - before); });
      before = now;
      draw();
      ++frame;
      if (!options_.stateFile.empty())
        io::writeText(options_.stateFile,
                      stateText(frame, *session_, request_.scene, uiState_, view_.orbit, dragger_.holds()));
    }
    if (!options_.screenshot.empty()) io::writePng(screen_, options_.screenshot);
  }

 private:
  /// An error pauses the session and is shown in the window.
  template <class Work> void guarded(Work&& work) {
    try {
      work();
    } catch (const Error& error) {
      uiState_.message = error.what();
      session_->paused = true;
    }
  }

  std::unique_ptr<Session> sessionOf(const Request& request) const {
    if (std::filesystem::path(request.scene).extension() == ".rubble")
      return std::make_unique<RecordingSession>(request.scene);
    return std::make_unique<Player>(options_.open, request, options_.sides);
  }

  /// Opens another session. If that fails, the present one stays and the window shows the error.
  void open(const Request& request) {
    guarded([&] {
      std::unique_ptr<Session> next = sessionOf(request);
      const bool sameScene = request.scene == request_.scene;
      next->speed = session_->speed;
      next->paused = sameScene && session_->paused;
      dragger_.forget();
      session_ = std::move(next);
      request_ = request;
      uiState_.message.clear();
      uiState_.selection = {};
      uiState_.iterations.clear();
      uiState_.iterationsOf = -1;
      if (!session_->live() && !io::knownWithoutWorld(uiState_.colorBy)) uiState_.colorBy = io::ColorBy::Body;
      const Orbit orbit = view_.orbit;
      view_.begin(*session_, width_, height_);
      if (sameScene) view_.orbit = orbit;
    });
  }

  void openNeighbor(int by) {
    const auto at = std::find(options_.scenes.begin(), options_.scenes.end(), request_.scene);
    const auto count = static_cast<int>(options_.scenes.size());
    if (count == 0) return;
    const int from = at == options_.scenes.end() ? (by > 0 ? -1 : 0)
                                                 : static_cast<int>(at - options_.scenes.begin());
    open({options_.scenes[static_cast<std::size_t>((from + by + count) % count)], {}, request_.backend});
  }

  void nextColor(int by) {
    const int count = static_cast<int>(io::quantities().size());
    do uiState_.colorBy = static_cast<io::ColorBy>((static_cast<int>(uiState_.colorBy) + by + count) % count);
    while (!session_->live() && !io::knownWithoutWorld(uiState_.colorBy));
  }

  void nextJoint(Player& player) {
    const std::vector<JointId> joints = player.world().joints();
    if (joints.empty()) return;
    auto at = uiState_.selection.joint ? std::find(joints.begin(), joints.end(), *uiState_.selection.joint)
                                       : joints.end();
    if (at != joints.end()) ++at;
    uiState_.selection = {std::nullopt, at == joints.end() ? joints.front() : *at, std::nullopt, -1};
  }

  void seek(std::int64_t step) {
    if (session_->live()) dragger_.forget();
    session_->paused = true;
    session_->seek(step);
  }

  void key(int key, bool shift) {
    if (key == GLFW_KEY_ESCAPE) uiState_.selection = {}, uiState_.showPicker = false;
    if (uiState_.showPicker) {
      // Here and not from Dear ImGui, which does not see a key that goes down and up within one frame.
      uiState_.takeChoice = uiState_.takeChoice || key == GLFW_KEY_ENTER || key == GLFW_KEY_KP_ENTER;
      uiState_.choice += key == GLFW_KEY_DOWN ? 1 : key == GLFW_KEY_UP ? -1 : 0;
    }
    if (ImGui::GetIO().WantTextInput || uiState_.showPicker) return;
    switch (key) {
      case GLFW_KEY_SPACE:
        session_->paused = !session_->paused;
        return;
      case GLFW_KEY_N:
      case GLFW_KEY_RIGHT:
        session_->paused = true, session_->step();
        return;
      case GLFW_KEY_LEFT:
        return seek(session_->now() - 1);
      case GLFW_KEY_HOME:
        return seek(0);
      case GLFW_KEY_END:
        return seek(session_->last());
      case GLFW_KEY_R:
        return open(request_);
      case GLFW_KEY_P:
        uiState_.showPicker = uiState_.focusPicker = true, openedPicker_ = true;
        return;
      case GLFW_KEY_PAGE_UP:
        return openNeighbor(-1);
      case GLFW_KEY_PAGE_DOWN:
        return openNeighbor(1);
      case GLFW_KEY_F:
        return view_.frame(*session_, uiState_.selection);
      case GLFW_KEY_C:
        return nextColor(shift ? -1 : 1);
      case GLFW_KEY_MINUS:
        session_->speed /= kSpeedStep;
        return;
      case GLFW_KEY_EQUAL:
        session_->speed *= kSpeedStep;
        return;
      default:
        break;
    }
    if (session_->live()) liveKey(key, *session_->live());
  }

  void liveKey(int key, Player& player) {
    const ImVec2 at = ImGui::GetIO().MousePos;
    switch (key) {
      case GLFW_KEY_B:
        shoot(player, view_.orbit.camera().eye, view_.ray(double{at.x}, double{at.y}), view_.bodySize());
        return;
      case GLFW_KEY_X: {
        const PickResult picked = view_.pick(*session_, double{at.x}, double{at.y});
        dropBox(player, picked.something ? picked.point : view_.orbit.camera().target, view_.bodySize());
        return;
      }
      case GLFW_KEY_1:
        uiState_.overlays.contacts = !uiState_.overlays.contacts;
        return;
      case GLFW_KEY_2:
        uiState_.overlays.forces = !uiState_.overlays.forces;
        return;
      case GLFW_KEY_3:
        uiState_.overlays.joints = !uiState_.overlays.joints;
        return;
      case GLFW_KEY_4:
        uiState_.overlays.bounds = !uiState_.overlays.bounds;
        return;
      case GLFW_KEY_G:
        uiState_.showPlots = !uiState_.showPlots;
        return;
      case GLFW_KEY_T:
        uiState_.showSettings = !uiState_.showSettings;
        return;
      case GLFW_KEY_J:
        return nextJoint(player);
      default:
        return;
    }
  }

  void letter(unsigned letter) {
    if (letter == '?' && !ImGui::GetIO().WantTextInput) uiState_.showHelp = !uiState_.showHelp;
  }

  void mouse() {
    const ImGuiIO& io = ImGui::GetIO();
    const double dx = double{io.MouseDelta.x} / height_, dy = double{-io.MouseDelta.y} / height_;
    const double x = double{io.MousePos.x}, y = double{io.MousePos.y};
    const bool free = !io.WantCaptureMouse;
    if (free && io.MouseWheel != 0) view_.orbit.zoom(std::pow(kZoomStep, double{io.MouseWheel}));
    if (free && ImGui::IsMouseClicked(0)) press(x, y);
    if (pressed_ && ImGui::IsMouseDown(0)) {
      if (dragger_.holds())
        dragger_.pull(*session_->live(), view_.pointAt(x, y, gripDepth_));
      else
        view_.orbit.turn(dx, dy);
    }
    if (pressed_ && ImGui::IsMouseReleased(0)) {
      pressed_ = false;
      if (session_->live()) dragger_.release(*session_->live());
      if (std::hypot(x - pressedX_, y - pressedY_) < kClick) click(x, y);
    }
    if (free && ImGui::IsMouseDown(1)) view_.orbit.turn(dx, dy);
    if (free && ImGui::IsMouseDown(2)) view_.orbit.pan(dx, dy);
  }

  void press(double x, double y) {
    pressed_ = true;
    pressedX_ = x, pressedY_ = y;
    const PickResult picked = view_.pick(*session_, x, y);
    under_ = picked.what;
    Player* player = session_->live();
    if (!player || !under_.any()) return;
    gripDepth_ = view_.depthOf(picked.point);
    if (under_.body)
      dragger_.take(*player, *under_.body, picked.point);
    else if (dragger_.take(*player, *under_.object, under_.vertex))
      gripDepth_ = view_.depthOf(
          player->world().positions(*under_.object)[static_cast<std::size_t>(under_.vertex)]);
  }

  void click(double x, double y) {
    uiState_.selection = under_;
    if (!session_->live() || !uiState_.overlays.joints) return;
    if (const auto joint = view_.jointAt(*session_->live(), x, y))
      uiState_.selection = {std::nullopt, joint, std::nullopt, -1};
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
    guarded([&] { mouse(); });
    guarded([&] { drawPanels(uiState_, *session_, options_.scenes); });
    ImGui::Render();
    if (uiState_.wanted) {
      const Request wanted = *uiState_.wanted;
      uiState_.wanted.reset();
      open(wanted);
    }
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glClearColor(1, 1, 1, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    guarded([&] { view_.draw(*session_, uiState_, width_, height_); });
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
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

  ViewerOptions options_;
  Window window_;
  std::unique_ptr<PanelContext> panels_;
  std::unique_ptr<Session> session_;
  Request request_;
  SceneView view_;
  Dragger dragger_;
  UiState uiState_;
  int width_ = 1, height_ = 1;
  bool pressed_ = false, openedPicker_ = false;
  double pressedX_ = 0, pressedY_ = 0;  ///< [pixels]
  Selection under_;                     ///< the press
  double gripDepth_ = 0;                ///< view depth of the held point [m]
  io::Image screen_;
};

}  // namespace

void runViewer(const ViewerOptions& options) { Viewer(options).run(); }

}  // namespace rubble::viewer
