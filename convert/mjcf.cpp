#include "convert/mjcf_reader.h"

namespace rubble::convert {

Model MjcfReader::read(pugi::xml_node root) {
  source_.use(root);
  model_.name = Tag(source_, root).text("model").value_or("MuJoCo model");
  // settings hold for the whole file, wherever they stand
  const std::vector<pugi::xml_node> sections = source_.children(root);
  const auto each = [&](const std::string& name, const auto& reader) {
    for (const pugi::xml_node& section : sections)
      if (name == section.name()) {
        source_.use(section);
        reader(section);
      }
  };
  each("compiler", [&](pugi::xml_node node) { readCompiler(node); });
  each("option", [&](pugi::xml_node node) { readOption(node); });
  each("default", [&](pugi::xml_node node) { readDefaults(node, "", 0); });
  each("asset", [&](pugi::xml_node node) { readAssets(node); });
  each("extension", [&](pugi::xml_node node) { readExtension(node); });
  each("worldbody", [&](pugi::xml_node node) { readWorld(node); });
  finishCables();
  if (model_.links.empty()) throw Error(source_.path(root) + ".worldbody", "a <worldbody>", "none");
  for (std::size_t i = 0; i < model_.links.size(); ++i)
    finishMass(model_.links[i], hasInertial_[i], geomMass_[i]);
  scaleTotalMass();
  finishViews();
  finishSpringDampers();
  each("tendon", [&](pugi::xml_node node) {
    for (const pugi::xml_node& child : source_.children(node)) readTendon(tagOfKind(child, "tendon"));
  });
  each("contact", [&](pugi::xml_node node) { readContact(node); });
  each("equality", [&](pugi::xml_node node) { readEquality(node); });
  if (level_ == 0) finishPairs(), finishLoops();
  each("keyframe", [&](pugi::xml_node node) { readKeyframes(node); });
  if (level_ == 0 && !options_.key.empty() && !foundKey_)
    throw Error("--key", "the name or index of a keyframe of the model", "\"" + options_.key + "\"");
  each("actuator", [&](pugi::xml_node node) {
    for (const pugi::xml_node& child : source_.children(node)) readActuator(actuatorOf(child));
  });
  noteFurtherControls();
  each("sensor", [&](pugi::xml_node node) {
    for (const pugi::xml_node& child : source_.children(node)) readSensor(Tag(source_, child));
  });
  if (level_ == 0) finishSensors();
  return std::move(model_);
}

Model readMjcf(Source& source, pugi::xml_node root, const ImportOptions& options, Report& report) {
  Model model = MjcfReader(source, options, report).read(root);
  noteUnusedMjcf(source, report);
  return model;
}

}  // namespace rubble::convert
