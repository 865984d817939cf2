#include "render/renderer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "render/lines.h"
#include "render/palette.h"
#include "render/screen_pass.h"
#include "render/surfaces.h"
#include "render/targets.h"

namespace rubble::render {
namespace {

/// Half the angle under which the sun is drawn [rad]: wider than the real one, for softer shadows.
constexpr float kSunSpread = .02f;
/// Reach of occlusion and radius of the shadow filter, over the half size of a typical body.
constexpr float kOcclusionReach = 12, kShadowSoftness = .10f;
/// Share of the distance to the nearest body at which the view begins.
constexpr float kNearShare = .5f;
constexpr int kCellsToScene = 12;
/// From so many samples on, occlusion needs no blur: the samples average its pattern.
constexpr int kSamplesWithoutBlur = 24;

/// Rows in the other order.
template <class T> std::vector<T> fromTheTop(const std::vector<T>& upward, std::size_t row) {
  std::vector<T> out;
  out.reserve(upward.size());
  for (auto end = upward.end(); end != upward.begin(); end -= static_cast<std::ptrdiff_t>(row))
    out.insert(out.end(), end - static_cast<std::ptrdiff_t>(row), end);
  return out;
}

/// Point `index` of the radical inverse sequence of a base, in [0, 1).
float radicalInverse(int index, int base) {
  float result = 0, part = 1;
  for (; index > 0; index /= base) {
    part /= static_cast<float>(base);
    result += part * static_cast<float>(index % base);
  }
  return result;
}

/// Unit vector towards a point of the sun's disc.
Vec3f sunPoint(const Vec3f& toSun, int sample, int samples) {
  if (samples == 1) return toSun;
  const Vec3f x = normalize(cross(std::fabs(toSun.x) < .9f ? Vec3f{1, 0, 0} : Vec3f{0, 1, 0}, toSun)),
              y = cross(toSun, x);
  const float r = kSunSpread * std::sqrt((static_cast<float>(sample) + .5f) / static_cast<float>(samples));
  const float angle = 2.399963f * static_cast<float>(sample);
  return normalize(toSun + x * (r * std::cos(angle)) + y * (r * std::sin(angle)));
}

}  // namespace

struct Renderer::Impl {
  int width, height;
  Vec3 origin;
  std::optional<Eye> lastEye;
  Bodies bodies;
  Surfaces surfaces;
  Lines lines;
  Bounds surfaceBounds;
  std::optional<Targets> targets;
  std::optional<ShadowTargets> shadows;
  bool many = false, transparent = false;
  int selected = -1;
  const std::vector<float> heatStops = render::heatStops();
  bool measure = false;
  std::vector<PassTime> times;
  std::chrono::steady_clock::time_point passBegan;

  const bool computes = gl::wantsCompute();
  ScreenPass material{"material.frag", computes, {"TWO_TARGETS"}}, occlusion{"occlusion.frag", computes},
      blur{"blur.frag", computes}, lightOne{"light.frag", computes, {"ONE_SAMPLE"}},
      lightMany{"light.frag", computes, {}, true}, displayOne{"display.frag", computes, {"ONE_SAMPLE"}},
      displayMany{"display.frag", computes};

  Impl(int width_, int height_) : width(width_), height(height_) {}

  void beginPasses() {
    times.clear();
    passBegan = std::chrono::steady_clock::now();
  }
  void endPass(const char* name) {
    if (!measure) return;
    glFinish();
    const auto now = std::chrono::steady_clock::now();
    const double ms = std::chrono::duration<double, std::milli>(now - passBegan).count();
    const auto known = std::find_if(times.begin(), times.end(),
                                    [&](const PassTime& t) { return t.name == name; });
    known == times.end() ? times.push_back({name, ms}) : void(known->ms += ms);
    passBegan = now;
  }

  void setView(gl::Program& program, const Eye& eye, float jitterX, float jitterY) {
    const Vec3f rightSpan = eye.right * eye.spanX, upSpan = eye.up * eye.spanY;
    program.use();
    program.set("eye", eye.position.x, eye.position.y, eye.position.z);
    program.set("forward", eye.forward.x, eye.forward.y, eye.forward.z);
    program.set("rightSpan", rightSpan.x, rightSpan.y, rightSpan.z);
    program.set("upSpan", upSpan.x, upSpan.y, upSpan.z);
    program.set("jitter", jitterX, jitterY);
    program.set("nearest", eye.nearest);
    program.set("pixelAngle", eye.pixelAngle);
  }

  /// Slot + 1 of what is seen at a pixel, or 0.
  std::uint32_t slotAt(int x, int y) const;
  void drawSample(const Eye& eye, const Setting& setting, const Quality& quality, int sample);
  std::vector<ShadowMap> drawShadows(const Eye& eye, const Vec3f& toSun, const Quality& quality);
  void drawBodies(const Eye& eye, float jitterX, float jitterY);
  void drawMaterial(const Eye& eye, const Setting& setting, float jitterX, float jitterY);
  void drawOcclusion(const Eye& eye, const Setting& setting, float jitterX, float jitterY, float turn,
                     bool blurred);
  void drawLight(const Eye& eye, const Setting& setting, const Quality& quality,
                 const std::vector<ShadowMap>& maps, const Vec3f& toSun, float jitterX, float jitterY,
                 float turn);
};

std::vector<ShadowMap> Renderer::Impl::drawShadows(const Eye& eye, const Vec3f& toSun,
                                                   const Quality& quality) {
  Bounds casters = bodies.core();
  casters.add(surfaceBounds);
  const std::vector<ShadowMap> maps = fitShadowMaps(eye, casters, toSun, quality.shadowSize,
                                                    quality.shadowMaps);
  glEnable(GL_DEPTH_TEST);
  // Bodies between the sun and the map are pressed onto its near side, where they still throw their shadow.
  glEnable(GL_DEPTH_CLAMP);
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(1.5f, 2);
  for (std::size_t i = 0; i < maps.size(); ++i) {
    shadows->targets[i].bind();
    glClear(GL_DEPTH_BUFFER_BIT);
    DrawView view{maps[i].toClip, toSun, true, maps[i].halfSpaces, maps[i].texel, false, maps[i].rays, 0};
    bodies.draw(view);
    surfaces.draw(view, bodies.surfaceSlot(0));
  }
  glDisable(GL_POLYGON_OFFSET_FILL);
  glDisable(GL_DEPTH_CLAMP);
  endPass("shadows");
  return maps;
}

void Renderer::Impl::drawBodies(const Eye& eye, float jitterX, float jitterY) {
  targets->bodies.bind();
  const GLuint none[4] = {0, 0, 0, 0};
  glClearBufferuiv(GL_COLOR, 0, none);
  glClear(GL_DEPTH_BUFFER_BIT);
  const DrawView view{eye.viewProjection(jitterX, jitterY),
                      eye.position,
                      false,
                      eye.halfSpaces(),
                      eye.pixelAngle,
                      true,
                      raysOf(eye, jitterX, jitterY, width, height),
                      eye.nearest};
  bodies.draw(view);
  surfaces.draw(view, bodies.surfaceSlot(0));
  endPass("bodies");
}

void Renderer::Impl::drawMaterial(const Eye& eye, const Setting& setting, float jitterX, float jitterY) {
  gl::Program& program = material.program();
  setView(program, eye, jitterX, jitterY);
  bodies.bindTables(0);
  targets->ids.bind(3);
  targets->depths.bind(4);
  program.set("poses", 0);
  program.set("looks", 1);
  program.set("seenBodies", 3);
  program.set("depths", 4);
  const double cell = std::pow(10., std::round(std::log10(setting.sceneSize / kCellsToScene)));
  program.setArray("heatStops", heatStops.data(), static_cast<int>(heatStops.size()));
  program.set("gridCell", static_cast<float>(cell));
  program.set("selected",
              selected < 0 ? 0 : static_cast<int>(bodies.slotOf(static_cast<std::size_t>(selected))) + 1);
  material.run(targets->material, {&targets->colors, &targets->normals});
  endPass("material");
}

void Renderer::Impl::drawOcclusion(const Eye& eye, const Setting& setting, float jitterX, float jitterY,
                                   float turn, bool blurred) {
  gl::Program& program = occlusion.program();
  setView(program, eye, jitterX, jitterY);
  targets->depths.bind(0);
  targets->normals.bind(1);
  program.set("depths", 0);
  program.set("shadedNormals", 1);
  program.set("pixelsAcross", static_cast<float>(width), static_cast<float>(height));
  program.set("radius", kOcclusionReach * static_cast<float>(setting.bodySize));
  program.set("turn", turn);
  occlusion.run(targets->occlusionTarget, {&targets->occlusion});
  if (blurred) {
    const float x = 1 / static_cast<float>(targets->occlusion.width()),
                y = 1 / static_cast<float>(targets->occlusion.height());
    blur.program().use();
    blur.program().set("occlusion", 0);
    targets->occlusion.bind(0);
    blur.program().set("direction", x, 0);
    blur.run(targets->blurTarget, {&targets->blurred});
    targets->blurred.bind(0);
    blur.program().set("direction", 0, y);
    blur.run(targets->occlusionTarget, {&targets->occlusion});
  }
  endPass("occlusion");
}

void Renderer::Impl::drawLight(const Eye& eye, const Setting& setting, const Quality& quality,
                               const std::vector<ShadowMap>& maps, const Vec3f& toSun, float jitterX,
                               float jitterY, float turn) {
  ScreenPass& pass = quality.samples > 1 ? lightMany : lightOne;
  gl::Program& light = pass.program();
  setView(light, eye, jitterX, jitterY);
  const gl::Texture* read[] = {&targets->colors, &targets->normals, &targets->depths, &targets->occlusion,
                               &shadows->maps};
  const char* names[] = {"colors", "shadedNormals", "depths", "occlusion", "shadowMaps"};
  for (int i = 0; i < 5; ++i) {
    read[i]->bind(i);
    light.set(names[i], i);
  }
  std::vector<float> matrices, texels;
  for (const ShadowMap& map : maps) {
    matrices.insert(matrices.end(), map.toTexture.columns.begin(), map.toTexture.columns.end());
    texels.push_back(map.texel);
  }
  const int count = static_cast<int>(maps.size());
  if (count > 0) {
    light.setMatrices("toShadow", matrices.data(), count);
    light.setArray("shadowTexel", texels.data(), count);
  }
  light.set("shadowMapCount", count);
  light.set("shadowTaps", quality.samples > 1 ? std::max(2, quality.shadowTaps / 4) : quality.shadowTaps);
  light.set("shadowSoftness",
            (quality.samples > 1 ? .3f : 1.f) * kShadowSoftness * static_cast<float>(setting.bodySize));
  light.set("toSun", toSun.x, toSun.y, toSun.z);
  light.set("sunlight", setting.sunlight.x, setting.sunlight.y, setting.sunlight.z);
  light.set("skylight", static_cast<float>(setting.skylight));
  std::vector<float> lamps;
  for (const Lamp& lamp : setting.lamps) {
    const Vec3f at(lamp.position - origin);
    lamps.insert(lamps.end(), {at.x, at.y, at.z, lamp.light.x, lamp.light.y, lamp.light.z});
  }
  light.set("lampCount", static_cast<int>(setting.lamps.size()));
  if (!lamps.empty()) light.setArray("lamps", lamps.data(), static_cast<int>(lamps.size()));
  const Vec3f up(setting.up);
  light.set("up", up.x, up.y, up.z);
  light.set("fadeDistance", static_cast<float>(setting.sceneSize));
  light.set("weight", 1 / static_cast<float>(quality.samples));
  const Vec3f background = setting.background.value_or(Vec3f{});
  light.set("background", background.x, background.y, background.z, setting.background ? 1.f : 0.f);
  light.set("transparent", setting.transparent ? 1 : 0);
  light.set("turn", turn);
  pass.run(targets->lightTarget, {&targets->light});
  endPass("light");
}

void Renderer::Impl::drawSample(const Eye& eye, const Setting& setting, const Quality& quality, int sample) {
  float jitterX = 0, jitterY = 0, turn = 0;
  if (quality.samples > 1) {
    // A tent filter of two pixels smooths edges.
    const auto tent = [](float u) { return u < .5f ? std::sqrt(2 * u) - 1 : 1 - std::sqrt(2 - 2 * u); };
    jitterX = tent(radicalInverse(sample + 1, 2)) * 2 / static_cast<float>(width);
    jitterY = tent(radicalInverse(sample + 1, 3)) * 2 / static_cast<float>(height);
    turn = radicalInverse(sample, 2);
  }
  const Vec3f toSun = sunPoint(Vec3f(normalize(setting.toSun)), sample, quality.samples);
  glDisable(GL_BLEND);
  const std::vector<ShadowMap> maps = drawShadows(eye, toSun, quality);
  glEnable(GL_DEPTH_TEST);
  drawBodies(eye, jitterX, jitterY);
  glDisable(GL_DEPTH_TEST);
  drawMaterial(eye, setting, jitterX, jitterY);
  drawOcclusion(eye, setting, jitterX, jitterY, turn, quality.samples < kSamplesWithoutBlur);
  drawLight(eye, setting, quality, maps, toSun, jitterX, jitterY, turn);
}

Renderer::Renderer(int width, int height) : impl_(std::make_unique<Impl>(width, height)) {}
Renderer::~Renderer() = default;

void Renderer::setOrigin(const Vec3& origin) { impl_->origin = origin; }
const Vec3& Renderer::origin() const { return impl_->origin; }
Bodies& Renderer::bodies() { return impl_->bodies; }

void Renderer::setSurfaces(std::span<const Surface> surfaces) {
  std::vector<BodyLook> looks;
  impl_->surfaceBounds = {};
  for (const Surface& surface : surfaces) {
    looks.push_back({kOwnMesh, {1, 1, 1}, 0, surface.color, surface.finish, !surface.heat.empty()});
    for (const Vec3f& vertex : surface.vertices) impl_->surfaceBounds.add(vertex);
  }
  impl_->bodies.setSurfaceLooks(looks);
  impl_->surfaces.set(surfaces);
}

void Renderer::setLines(std::span<const Line> lines) { impl_->lines.set(lines, impl_->origin); }

void Renderer::resize(int width, int height) {
  impl_->width = width;
  impl_->height = height;
}

void Renderer::draw(const Camera& camera, const Setting& setting, const Quality& quality) {
  Impl& r = *impl_;
  Eye eye(camera, r.origin, r.width, r.height);
  r.beginPasses();
  const bool many = quality.samples > 1;
  if (!r.targets || r.targets->width != r.width || r.targets->height != r.height || r.many != many) {
    r.targets.emplace(r.width, r.height, many);
    r.many = many;
  }
  if (!r.shadows || r.shadows->size != quality.shadowSize) r.shadows.emplace(quality.shadowSize);
  float nearest = r.bodies.nearestTo(eye.position, eye.halfSpaces());
  if (!r.surfaceBounds.empty()) nearest = std::min(nearest, distanceTo(r.surfaceBounds, eye.position));
  // View depth is less than distance towards the corners of the picture.
  const float corner = 1 / std::sqrt(1 + eye.spanX * eye.spanX + eye.spanY * eye.spanY);
  eye.nearest = std::clamp(kNearShare * corner * nearest, eye.nearest, 300 * eye.nearest);
  r.lastEye = eye;
  r.endPass("view");

  if (many) {
    r.targets->lightTarget.bind();
    glClearColor(0, 0, 0, 0);
    glClear(GL_COLOR_BUFFER_BIT);
  }
  for (int sample = 0; sample < quality.samples; ++sample) r.drawSample(eye, setting, quality, sample);

  ScreenPass& pass = many ? r.displayMany : r.displayOne;
  gl::Program& display = pass.program();
  display.use();
  r.targets->light.bind(0);
  display.set("lights", 0);
  display.set("texel", 1 / static_cast<float>(r.width), 1 / static_cast<float>(r.height));
  if (many) display.set("transparent", setting.transparent ? 1 : 0);
  r.transparent = setting.transparent && many;
  pass.run(r.targets->pictureTarget, {&r.targets->picture});
  r.targets->pictureTarget.bind();
  r.lines.draw(eye, r.targets->depths);
  r.endPass("display");
  gl::check("draw");
}

void Renderer::finish() const { glFinish(); }

io::Image Renderer::read() const {
  const int width = impl_->width, height = impl_->height;
  io::Image image{width, height, {}};
  glBindFramebuffer(GL_READ_FRAMEBUFFER, impl_->targets->pictureTarget.id());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  const auto bytes = [&](GLenum format, std::size_t each) {
    std::vector<std::uint8_t> upward(each * static_cast<std::size_t>(width) *
                                     static_cast<std::size_t>(height));
    glReadPixels(0, 0, width, height, format, GL_UNSIGNED_BYTE, upward.data());
    return fromTheTop(upward, each * static_cast<std::size_t>(width));
  };
  image.rgb = bytes(GL_RGB, 3);
  if (impl_->transparent) image.alpha = bytes(GL_ALPHA, 1);
  return image;
}

std::vector<float> Renderer::readDepths() const {
  const int width = impl_->width, height = impl_->height;
  std::vector<float> upward(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  glBindFramebuffer(GL_READ_FRAMEBUFFER, impl_->targets->bodies.id());
  glReadPixels(0, 0, width, height, GL_DEPTH_COMPONENT, GL_FLOAT, upward.data());
  for (float& depth : upward)
    depth = depth >= 1 ? std::numeric_limits<float>::infinity() : impl_->lastEye->nearest / (1 - depth);
  return fromTheTop(upward, static_cast<std::size_t>(width));
}

std::vector<float> Renderer::readNormals() const {
  const int width = impl_->width, height = impl_->height;
  std::vector<float> upward(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  glBindFramebuffer(GL_READ_FRAMEBUFFER, impl_->targets->material.id());
  glReadBuffer(GL_COLOR_ATTACHMENT1);
  glReadPixels(0, 0, width, height, GL_RGB, GL_FLOAT, upward.data());
  glReadBuffer(GL_COLOR_ATTACHMENT0);
  return fromTheTop(upward, 3 * static_cast<std::size_t>(width));
}

void Renderer::show(unsigned framebuffer, int left) const {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, impl_->targets->pictureTarget.id());
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer);
  glBlitFramebuffer(0, 0, impl_->width, impl_->height, left, 0, left + impl_->width, impl_->height,
                    GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

std::uint32_t Renderer::Impl::slotAt(int x, int y) const {
  if (!targets || x < 0 || y < 0 || x >= width || y >= height) return 0;
  GLuint seen[2] = {0, 0};
  glBindFramebuffer(GL_READ_FRAMEBUFFER, targets->bodies.id());
  glReadPixels(x, height - 1 - y, 1, 1, GL_RG_INTEGER, GL_UNSIGNED_INT, seen);
  return seen[0];
}

int Renderer::bodyAt(int x, int y) const {
  const std::uint32_t seen = impl_->slotAt(x, y);
  return seen == 0 ? -1 : impl_->bodies.bodyOfSlot(seen - 1);
}

int Renderer::surfaceAt(int x, int y) const {
  const std::uint32_t seen = impl_->slotAt(x, y), first = impl_->bodies.surfaceSlot(0);
  return seen == 0 || seen - 1 < first ? -1 : static_cast<int>(seen - 1 - first);
}

std::vector<int> Renderer::readBodies() const {
  const int width = impl_->width, height = impl_->height;
  std::vector<GLuint> seen(2 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  glBindFramebuffer(GL_READ_FRAMEBUFFER, impl_->targets->bodies.id());
  glReadPixels(0, 0, width, height, GL_RG_INTEGER, GL_UNSIGNED_INT, seen.data());
  const std::uint32_t first = impl_->bodies.surfaceSlot(0);
  std::vector<int> upward;
  for (std::size_t i = 0; i < seen.size(); i += 2)
    upward.push_back(seen[i] == 0           ? -1
                     : seen[i] - 1 >= first ? -2 - static_cast<int>(seen[i] - 1 - first)
                                            : impl_->bodies.bodyOfSlot(seen[i] - 1));
  return fromTheTop(upward, static_cast<std::size_t>(width));
}

Vec3 Renderer::pointAt(int x, int y) const {
  GLfloat depth = 1;
  glBindFramebuffer(GL_READ_FRAMEBUFFER, impl_->targets->bodies.id());
  glReadPixels(x, impl_->height - 1 - y, 1, 1, GL_DEPTH_COMPONENT, GL_FLOAT, &depth);
  const auto across = static_cast<float>(2 * x + 1) / static_cast<float>(impl_->width) - 1;
  const auto up = 1 - static_cast<float>(2 * y + 1) / static_cast<float>(impl_->height);
  return impl_->origin +
         Vec3(impl_->lastEye->at(across, up, impl_->lastEye->nearest / std::max(1 - depth, 1e-7f)));
}

void Renderer::select(int body) { impl_->selected = body; }
void Renderer::measurePasses(bool on) { impl_->measure = on; }
const std::vector<PassTime>& Renderer::passTimes() const { return impl_->times; }

}  // namespace rubble::render
