#include <algorithm>
#include <chrono>
#include <ctime>
#include <numbers>

#include "apps/cli/render_job.h"
#include "apps/cli/render_view.h"
#include "apps/cli/statistics.h"

#if defined(RUBBLE_HAS_GL)
#include "render/headless.h"
#include "render/stage.h"
#endif

namespace rubble::cli {

#if defined(RUBBLE_HAS_GL)
RenderMeasure measureRender(const RenderOptions& options, int frames) {
  using Clock = std::chrono::steady_clock;
  render::HeadlessContext context;
  const std::unique_ptr<MomentSource> source = momentSource(options.job);
  const Moment start = source->start();
  const render::Camera camera = cameraOf(options.camera, *source, options.width, options.height, options.fieldOfView);
  render::Stage stage(start.bodies, source->gravity(), camera, options.width, options.height);
  render::Renderer& renderer = stage.renderer();
  render::Quality quality;
  quality.samples = std::max(1, options.samples);

  std::vector<render::Pose> poses;
  for (const io::PictureBody& body : start.bodies) {
    const render::Vec3f p(body.position - renderer.origin());
    const QuatT<float> q(body.orientation);
    poses.push_back({p.x, p.y, p.z, 0, q.v.x, q.v.y, q.v.z, q.s});
  }
  RenderMeasure result{context.renderer(), start.bodies.size(), frames, 0, 0, 0, 0, {}};
  const auto draw = [&](int frame) {
    renderer.bodies().setPoses(poses);
    renderer.draw(turned(camera, 2 * std::numbers::pi * frame / std::max(1, frames)), stage.setting(), quality);
    renderer.finish();
  };
  draw(0);  // shaders are compiled at their first use
  std::vector<double> ms;
  const std::clock_t cpuBegan = std::clock();
  for (int frame = 0; frame < frames; ++frame) {
    const Clock::time_point began = Clock::now();
    draw(frame);
    ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - began).count());
  }
  result.cpuMs = 1000. * static_cast<double>(std::clock() - cpuBegan) / CLOCKS_PER_SEC / frames;
  for (const double value : ms) result.meanMs += value / frames;
  std::sort(ms.begin(), ms.end());
  result.medianMs = ms[ms.size() / 2];
  result.p95Ms = ms[std::min(ms.size() - 1, ms.size() * 95 / 100)];
  renderer.measurePasses(true);
  draw(0);
  for (const render::PassTime& pass : renderer.passTimes()) result.passes.emplace_back(pass.name, pass.ms);
  return result;
}
#else
RenderMeasure measureRender(const RenderOptions&, int) {
  throw Error("--measure", "a build with libepoxy and EGL (Debian: apt-get install libepoxy-dev libegl-dev)", "one without");
}
#endif

}  // namespace rubble::cli
