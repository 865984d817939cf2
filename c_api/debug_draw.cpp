#include <rubble/c/world.h>

#include "c_api/handles.h"
#include "io/definition_json.h"

using namespace rubble;
using namespace rubble::c;

namespace {

DebugDrawOptions drawOptionsOf(const std::string& text) {
  DebugDrawOptions out;
  io::readDefinition(text, "options", [&](const io::Node& node) {
    io::ObjectReader object(node, "an object with options of a debug drawing");
    if (!object.isObject()) return;
    object.read("surfaces", out.surfaces), object.read("edges", out.edges);
    object.read("contacts", out.contacts), object.read("joints", out.joints);
    object.read("bounds", out.bounds), object.read("names", out.names);
    object.read("force_scale", out.forceScale), object.read("plane_size", out.planeSize);
    constexpr int kFewest = 3;
    if (const auto found = object.get("segments"))
      out.segments = found->whole(kFewest, "a number of triangles per circle, 3 or more")
                         .value_or(out.segments);
    object.finish();
  });
  return out;
}

}  // namespace

extern "C" {

rb_status rb_world_debug_draw(rb_world* world, const char* options, rb_debug_draw* drawing) {
  return guarded([&] {
    need(drawing, "drawing");
    need(world, "world").drawing = debugDraw(worldOf(world), drawOptionsOf(textOr(options, "{}")));
    world->drawnLines.clear(), world->drawnTriangles.clear(), world->drawnTexts.clear();
    for (const DebugDraw::Line& line : world->drawing.lines) {
      rb_debug_line& out = world->drawnLines.emplace_back();
      store(line.from, out.from), store(line.to, out.to), out.color = line.color;
    }
    for (const DebugDraw::Triangle& triangle : world->drawing.triangles) {
      rb_debug_triangle& out = world->drawnTriangles.emplace_back();
      for (int k = 0; k < 3; ++k) store(triangle.corner[k], out.corners + 3 * k);
      out.color = triangle.color;
    }
    for (const DebugDraw::Text& text : world->drawing.texts) {
      rb_debug_text& out = world->drawnTexts.emplace_back();
      store(text.position, out.position), out.text = text.text.c_str(), out.color = text.color;
    }
    give(world->drawnLines, &drawing->lines, &drawing->line_count);
    give(world->drawnTriangles, &drawing->triangles, &drawing->triangle_count);
    give(world->drawnTexts, &drawing->texts, &drawing->text_count);
  });
}
}
