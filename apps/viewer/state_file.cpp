#include "apps/viewer/state_file.h"

#include "apps/viewer/recording_session.h"
#include "io/json_text.h"
#include "io/picture_values.h"
#include "io/scene_json.h"

namespace rubble::viewer {
namespace {

using Json = nlohmann::ordered_json;

/// Bodies of the registry's largest scenes have no names: those of few are listed.
constexpr std::size_t kMostListed = 64;

Json pointJson(const Vec3& p) { return {p.x, p.y, p.z}; }

void addLive(Json& state, Player& player, const UiState& uiState) {
  World& world = player.world();
  Json bodies = Json::object(), vertices = Json::object();
  const std::vector<BodyId> ids = world.bodies();
  for (std::size_t i = 0; i < ids.size() && i < kMostListed; ++i)
    if (const std::string& name = world.definition(ids[i]).name; !name.empty())
      bodies[name] = pointJson(world.state(ids[i]).position);
  int shots = 0, dropped = 0;
  for (const auto& [name, place] : bodies.items())
    shots += name.rfind("shot ", 0) == 0, dropped += name.rfind("dropped ", 0) == 0;
  for (const DeformableId id : world.deformables()) {
    Vec3 low = world.positions(id).front(), high = low;
    for (const Vec3& p : world.positions(id))
      for (int k = 0; k < 3; ++k) low[k] = std::min(low[k], p[k]), high[k] = std::max(high[k], p[k]);
    vertices[std::to_string(id.index)] = {pointJson(low), pointJson(high)};
  }
  const Selection& s = uiState.selection;
  state["backend"] = player.backend();
  state["bodies"] = bodies;
  state["objects"] = vertices;
  state["shots"] = shots;
  state["dropped"] = dropped;
  state["selected"] = s.body && world.alive(*s.body) ? world.definition(*s.body).name : "";
  state["selected_joint"] = s.joint && world.alive(*s.joint) ? world.definition(*s.joint).name : "";
  state["selected_vertex"] = s.object ? s.vertex : -1;
  state["branch"] = player.history().branch().name;
  state["branches"] = player.history().branches().size();
  state["moments"] = player.history().branch().checkpoints.size();
  state["hash"] = std::to_string(world.hash());
  state["iterations"] = world.params().iterations;
  state["plotted_steps"] = player.records().size();
  state["plotted_iterations"] = uiState.iterations.size();
}

}  // namespace

std::string stateText(int frame, Session& session, const std::string& scene, const UiState& uiState,
                      const Orbit& orbit, bool holds) {
  Json overlays = Json::array();
  if (uiState.overlays.contacts) overlays.push_back("contacts");
  if (uiState.overlays.forces) overlays.push_back("forces");
  if (uiState.overlays.joints) overlays.push_back("joints");
  if (uiState.overlays.bounds) overlays.push_back("bounds");
  Json state = {{"frame", frame},
                {"scene", scene},
                {"title", session.title()},
                {"sides", session.sides()},
                {"paused", session.paused},
                {"steps", session.now()},
                {"last", session.last()},
                {"speed", session.speed},
                {"color_by", io::quantity(uiState.colorBy).key},
                {"full_value", uiState.fullValue},
                {"overlays", overlays},
                {"help", uiState.showHelp},
                {"plots", uiState.showPlots},
                {"settings", uiState.showSettings},
                {"thumbnails", uiState.thumbnails.drawn()},
                {"message", uiState.message},
                {"eye", pointJson(orbit.camera().eye)},
                {"held", holds},
                {"recording", session.live() == nullptr}};
  if (session.live()) addLive(state, *session.live(), uiState);
  return io::prettyJson(state);
}

}  // namespace rubble::viewer
