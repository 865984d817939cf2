#pragma once
/// Cameras by name, and the captions of films.
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/cli/render_source.h"
#include "render/camera.h"
#include "render/view_plan.h"

namespace rubble::cli {

/// Names that cameraOf takes.
const std::vector<std::string>& cameraNames();
/// What a camera is to show.
struct Sight {
  scenes::Camera own;  ///< of the scene; eye at target if it has none
  Vec3 gravity;        ///< [m/s2]
  std::vector<io::PictureBody> bodies;
  bool smashes = false;  ///< leave room for rubble
};
Sight sightOf(const scenes::Job& job);
/// A camera that shows all of it, in a picture of this size. "scene" is the scene's own. Throws Error for an
/// unknown name.
render::Camera cameraOf(const std::string& name, const Sight& sight, int width, int height,
                        double fieldOfView);
/// How a whole run is seen by a named camera: "scene" looks around walls that hide it, the others leave them
/// out. `eye`: where the camera is put instead.
render::ViewPlan planOf(const std::string& name, const MomentSource& source,
                        std::span<const std::vector<io::PictureBody>> moments, int width, int height,
                        double fieldOfView, const std::optional<Vec3>& eye = {});
/// The camera turned about the up axis through its target [rad].
render::Camera turned(const render::Camera& camera, double angle);

struct Caption {
  std::string title;               ///< bold
  std::vector<std::string> facts;  ///< one line, dots between them
};

/// "10,001"
std::string grouped(long long number);
/// Writes the caption onto the lower left of a picture, where the build has Cairo.
void drawCaption(io::Image& image, const Caption& caption);
/// Width of the line between two pictures [pixels].
inline constexpr int kDivider = 4;
/// Two pictures of one height beside each other with a thin line between them.
io::Image beside(const io::Image& left, const io::Image& right);

}  // namespace rubble::cli
