#include <rubble/c/scene.h>

#include <rubble/mesh.h>

#include "c_api/handles.h"
#include "io/definition_json.h"
#include "io/json_reader.h"
#if defined(RUBBLE_HAS_CONVERT)
#include "convert/import.h"
#endif

using namespace rubble;
using namespace rubble::c;

namespace {

std::size_t sizeOf(const io::SceneFile& file, const std::string& list) {
  const Scene& scene = file.scene;
  if (list == "material_pairs") return scene.materialPairs.size();
  if (list == "bodies") return scene.bodies.size();
  if (list == "joints") return scene.joints.size();
  if (list == "deformables") return scene.deformables.size();
  if (list == "attachments") return scene.attachments.size();
  if (list == "exclusions") return scene.exclusions.size();
  if (list == "events") return scene.events.size();
  if (list == "sensors") return file.sensors.size();
  if (list == "actuators") return file.actuators.size();
  if (list == "looks") return file.appearance.looks.size();
  if (list == "cameras") return file.appearance.cameras.size();
  if (list == "lights") return file.appearance.lights.size();
  if (list == "verdict") return file.claims.size();
  throw Error("list", "a list of a scene, such as \"bodies\"", "\"" + list + "\"");
}

/// Checks by the engine itself, in addition to those of the reader.
void validateLast(const Scene& scene, const std::string& list, const std::string& path) {
  if (list == "material_pairs")
    validate(scene);
  else if (list == "bodies")
    validate(scene.bodies.back(), path);
  else if (list == "joints")
    validate(scene.joints.back(), path);
  else if (list == "deformables")
    validate(scene.deformables.back(), path);
}

/// Reads a value of a scene. Throws Error for the first fault.
template <class Read> void readInto(rb_scene& scene, const char* json, const std::string& path, Read&& read) {
  scene.faults.clear();
  const auto value = io::parseJson(textOr(json, ""), scene.faults);
  if (value) read(io::Node(value->root(), path, scene.faults));
  if (!scene.faults.empty()) throw io::errorOf(scene.faults.front());
}

std::unique_ptr<rb_scene> sceneOf(io::SceneFile file, const std::string& folder) {
  auto out = std::make_unique<rb_scene>(folder);
  out->file = std::move(file);
  out->reader.adopt(out->file);
  return out;
}

#if defined(RUBBLE_HAS_CONVERT)
convert::ImportOptions importOptions(const char* json, bool& strict) {
  convert::ImportOptions out;
  std::vector<io::Fault> faults;
  const auto value = io::parseJson(textOr(json, "{}"), faults);
  if (value) {
    io::ObjectReader object(io::Node(value->root(), "options", faults), "an object of options");
    object.read("strict", strict);
    object.read("key", out.key), object.read("srdf", out.srdf),
        object.read("floating_base", out.floatingBase);
    if (const auto folders = object.get("folders"))
      for (const io::Node& each : folders->elements("a list of folders"))
        out.folders.push_back(each.text().value_or(""));
    if (const auto packages = object.get("packages"))
      for (const io::JsonValue* const folder : packages->value().members())
        out.packages[std::string(folder->key())] = packages->member(*folder).text().value_or("");
    object.finish();
  }
  if (!faults.empty()) throw io::errorOf(faults.front());
  return out;
}
#endif

}  // namespace

extern "C" {

rb_status rb_scene_create(const char* folder, rb_scene** scene) {
  return guarded([&] { need(scene, "scene") = new rb_scene(textOr(folder, "")); });
}

rb_status rb_scene_parse(const char* json, const char* folder, rb_scene** scene) {
  return guarded([&] {
    const std::string where = textOr(folder, "");
    std::vector<io::Fault> faults;
    io::SceneFile file = io::parseScene(textOr(json, ""), faults, where);
    if (!faults.empty()) throwFaults(faults, "");
    need(scene, "scene") = sceneOf(std::move(file), where).release();
  });
}

rb_status rb_scene_read(const char* file, rb_scene** scene) {
  return guarded([&] {
    const std::string name = textOr(file, "");
    need(scene, "scene") = sceneOf(io::readScene(name), io::folderOf(name)).release();
  });
}

#if defined(RUBBLE_HAS_CONVERT)
rb_status rb_scene_import(const char* file, const char* options, rb_scene** scene, const char** report) {
  return guarded([&] {
    const std::string name = textOr(file, "");
    bool strict = false;
    convert::Import import = convert::importModel(name, importOptions(options, strict));
    if (report) *report = keepText(convert::jsonOf(import.report));
    if (strict && !import.report.exact())
      throw Error(name, "a model that is imported exactly", convert::textOf(import.report, false));
    need(scene, "scene") = sceneOf(std::move(import.file), io::folderOf(name)).release();
  });
}
#else
rb_status rb_scene_import(const char* file, const char*, rb_scene**, const char**) {
  return guarded([&] { throw Error(textOr(file, ""), "a build with pugixml", "one without"); });
}
#endif

void rb_scene_destroy(rb_scene* scene) { delete scene; }

rb_status rb_scene_set(rb_scene* scene, const char* key, const char* json) {
  return guarded([&] {
    const std::string name = textOr(key, "");
    rb_scene& into = need(scene, "scene");
    readInto(into, json, name, [&](const io::Node& node) { into.reader.set(into.file, name, node); });
  });
}

rb_status rb_scene_add(rb_scene* scene, const char* list, const char* json, int64_t* index) {
  return guarded([&] {
    const std::string name = textOr(list, "");
    rb_scene& into = need(scene, "scene");
    const std::size_t place = sizeOf(into.file, name);
    const std::string path = name + "[" + std::to_string(place) + "]";
    try {
      readInto(into, json, path, [&](const io::Node& node) { into.reader.add(into.file, name, node); });
      validateLast(into.file.scene, name, path);
    } catch (...) {
      if (sizeOf(into.file, name) > place) into.reader.dropLast(into.file, name);
      throw;
    }
    if (index) *index = static_cast<int64_t>(place);
  });
}

rb_status rb_scene_add_rod(rb_scene* scene, const char* json, int32_t parts[4]) {
  return guarded([&] {
    rb_scene& into = need(scene, "scene");
    const RodParts added = addRod(into.file.scene, io::parseRod(textOr(json, "")));
    into.reader.adopt(into.file);
    if (parts)
      parts[0] = added.firstBody, parts[1] = added.bodies, parts[2] = added.firstJoint,
      parts[3] = added.joints;
  });
}

rb_status rb_scene_count(const rb_scene* scene, const char* list, int64_t* count) {
  return guarded([&] {
    need(count, "count") = static_cast<int64_t>(sizeOf(need(scene, "scene").file, textOr(list, "")));
  });
}

rb_status rb_scene_text(const rb_scene* scene, const char** json) {
  return guarded([&] { need(json, "json") = keepText(io::toJson(need(scene, "scene").file)); });
}

rb_status rb_scene_write(const rb_scene* scene, const char* file) {
  return guarded([&] { io::writeText(textOr(file, ""), io::toJson(need(scene, "scene").file)); });
}

rb_status rb_shape_create(const char* json, rb_shape** shape) {
  return guarded([&] {
    Shape parsed = io::parseShape(textOr(json, ""));
    validate(parsed, "shape");
    need(shape, "shape") = new rb_shape{std::move(parsed)};
  });
}

void rb_shape_destroy(rb_shape* shape) { delete shape; }

rb_status rb_shape_mass(const rb_shape* shape, double density, rb_mass* mass) {
  return guarded([&] { need(mass, "mass") = toC(massProperties(need(shape, "shape").shape, density)); });
}

rb_status rb_tet_box(const double corner[3], const double size[3], const int32_t cells[3],
                     const char** json) {
  return guarded([&] {
    need(cells, "cells");
    need(json, "json") = keepText(
        io::toJson(Deformable(tetBox(vec(corner), vec(size), {cells[0], cells[1], cells[2]}))));
  });
}

rb_status rb_tet_ball(const double center[3], double radius, int32_t cells, const char** json) {
  return guarded(
      [&] { need(json, "json") = keepText(io::toJson(Deformable(tetBall(vec(center), radius, cells)))); });
}

rb_status rb_tet_solid(const double* vertices, int64_t vertex_count, const int32_t* triangles,
                       int64_t triangle_count, double cell, const char** json) {
  return guarded([&] {
    TriangleMesh mesh{vectorsOf(vertices, vertex_count), {}};
    if (triangle_count > 0) need(triangles, "triangles");
    for (int64_t k = 0; k < triangle_count; ++k, triangles += 3)
      mesh.triangles.push_back({triangles[0], triangles[1], triangles[2]});
    need(json, "json") = keepText(io::toJson(Deformable(tetSolidFromSurface(mesh, cell))));
  });
}

rb_status rb_cloth_sheet(const double corner[3], const double u[3], const double v[3], int32_t cells_u,
                         int32_t cells_v, const char** json) {
  return guarded([&] {
    need(json, "json") = keepText(
        io::toJson(Deformable(clothSheet(vec(corner), vec(u), vec(v), cells_u, cells_v))));
  });
}

rb_status rb_straight_cable(const double from[3], const double to[3], int32_t segments, const char** json) {
  return guarded([&] {
    need(json, "json") = keepText(io::toJson(Deformable(straightCable(vec(from), vec(to), segments))));
  });
}

rb_status rb_cable_along(const double* points, int64_t point_count, double segment, int32_t closed,
                         const char** json) {
  return guarded([&] {
    const CableDef cable = cableAlong(vectorsOf(points, point_count), segment, closed != 0);
    need(json, "json") = keepText(io::toJson(Deformable(cable)));
  });
}
}
