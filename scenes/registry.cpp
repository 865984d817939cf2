#include "registry.h"

#include <algorithm>
#include <cmath>

#include "build.h"
#include "families.h"
#include "near_names.h"
#include "probes.h"

namespace rubble::scenes {
namespace {

std::vector<Spec> makeRegistry() {
  std::vector<Spec> all;
  for (auto* family :
       {&pileSpecs,          &wallSpecs,        &pyramidSpecs,     &towerSpecs,     &removalSpecs,
        &fastSpecs,          &bodySpecs,        &chainSpecs,       &ropeSpecs,      &frictionSpecs,
        &frictionLimitSpecs, &siloSpecs,        &rollingSpecs,     &fineStackSpecs, &structureSpecs,
        &jengaSpecs,         &shapeRestSpecs,   &shapeMotionSpecs, &basicSpecs,     &bounceSpecs,
        &scaleSpecs,         &jointAxisSpecs,   &machineSpecs,     &gearSpecs,      &topSpecs,
        &robotSpecs,         &ragdollSpecs,     &cableSpecs,       &springSpecs,    &paperSpecs,
        &softSolidSpecs,     &softSheetSpecs,   &softContactSpecs, &softDentSpecs,  &softClaySpecs,
        &softPressureSpecs,  &softMachineSpecs, &rodSpecs,         &softPlateSpecs, &softGrainSpecs,
        &mixedSpecs,         &softStringSpecs,  &driverSpecs})
    for (Spec& spec : family()) all.push_back(std::move(spec));
  return all;
}

}  // namespace

Verdict judge(const std::vector<Claim>& claims, const Metrics& metrics) {
  Verdict verdict;
  for (const Claim& claim : claims) {
    ClaimResult result{claim, std::numeric_limits<double>::quiet_NaN(), false};
    if (const auto found = metrics.find(claim.metric); found != metrics.end()) {
      result.value = found->second;
      result.holds = std::isfinite(result.value) && result.value >= claim.min && result.value <= claim.max;
    }
    verdict.holds = verdict.holds && result.holds;
    verdict.results.push_back(std::move(result));
  }
  return verdict;
}

const std::vector<Spec>& registry() {
  static const std::vector<Spec> specs = makeRegistry();
  return specs;
}

const Spec& find(const std::string& name) {
  for (const Spec& spec : registry())
    if (spec.name == name) return spec;
  std::vector<std::string> names;
  for (const Spec& spec : registry()) names.push_back(spec.name);
  throw Error("scene", nearNames(name, names, "rubble info scenes"), "\"" + name + "\"");
}

Job prepare(const Spec& spec, const Arguments& arguments) {
  const Arguments resolved = resolve(spec, arguments);
  Job job;
  job.scene = spec.build(resolved);
  job.scene.name = spec.name;
  job.scene.description = spec.doc;
  job.claims = spec.claims(resolved);
  job.camera = spec.camera(resolved, job.scene);
  if (spec.driver) job.drive = spec.driver(resolved, job.scene);
  job.steps = spec.steps;
  job.iterations = spec.iterations;
  job.substeps = spec.substeps;
  // Arguments may leave the smash out.
  const bool smashes = std::any_of(job.scene.events.begin(), job.scene.events.end(),
                                   [&](const Event& e) { return e.step == spec.smashStep; });
  job.sleeping = spec.sleeping, job.events = spec.events;
  job.smashStep = smashes ? spec.smashStep : -1;
  job.probes = spec.probes(resolved, job.scene);
  job.probes.push_back(qualityProbe(smashes ? spec.smashStep * job.dt : kNoBound));
  return job;
}

}  // namespace rubble::scenes
