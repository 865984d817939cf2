/// Default classes: an attribute that an element lacks comes from its class, then from the parents of the
/// class.
#include <algorithm>

#include "convert/mjcf_reader.h"

namespace rubble::convert {
namespace {

const std::vector<std::string> kActuators{"general",     "motor",   "position", "velocity", "intvelocity",
                                          "orientation", "pid",     "damper",   "cylinder", "muscle",
                                          "adhesion",    "dcmotor", "plugin"};

}  // namespace

void MjcfReader::readDefaults(pugi::xml_node node, const std::string& parent, int depth) {
  const Tag tag(source_, node);
  std::string name = tag.text("class").value_or("");
  if (name.empty()) {
    if (depth > 0) tag.fail("class", "the name of the class", "none");
    name = "main";
  }
  if (depth == 0) defaults_.main = name;
  const auto known = defaults_.parent.find(name);
  if (known != defaults_.parent.end() && known->second != parent)
    tag.fail("class", "a class with one parent", "\"" + name + "\" again");
  defaults_.parent[name] = parent;
  for (const pugi::xml_node& child : source_.children(node)) {
    if (std::string_view(child.name()) == "default") {
      readDefaults(child, name, depth + 1);
      continue;
    }
    source_.use(child);
    defaults_.nodes[name].push_back(child);
  }
}

std::vector<pugi::xml_node> MjcfReader::defaultsOf(const std::string& className,
                                                   const std::vector<std::string>& types) const {
  std::vector<pugi::xml_node> out;
  for (std::string at = className; !at.empty();) {
    if (const auto found = defaults_.nodes.find(at); found != defaults_.nodes.end())
      // of several elements of one class the last one counts
      for (auto node = found->second.rbegin(); node != found->second.rend(); ++node)
        if (std::find(types.begin(), types.end(), node->name()) != types.end()) out.push_back(*node);
    const auto parent = defaults_.parent.find(at);
    at = parent == defaults_.parent.end() ? "" : parent->second;
  }
  return out;
}

std::string MjcfReader::classOf(const pugi::xml_node& node, const std::string& childClass) const {
  const pugi::xml_attribute own = node.attribute("class");
  if (own) source_.use(own);
  source_.know(std::string(node.name()) + ".class");
  const std::string name = own ? own.value() : !childClass.empty() ? childClass : defaults_.main;
  if (name != defaults_.main && !defaults_.parent.contains(name))
    throw Error(source_.path(node) + ".class", "the name of a default class", "\"" + name + "\"");
  return name;
}

Tag MjcfReader::tagOf(pugi::xml_node node, const std::string& childClass) {
  return {source_, node, defaultsOf(classOf(node, childClass), {node.name()})};
}

Tag MjcfReader::tagOfKind(pugi::xml_node node, const char* kind) {
  return {source_, node, defaultsOf(classOf(node, ""), {kind})};
}

Tag MjcfReader::actuatorOf(pugi::xml_node node) {
  return {source_, node, defaultsOf(classOf(node, ""), kActuators)};
}

}  // namespace rubble::convert
