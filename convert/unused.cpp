#include "convert/unused.h"

namespace rubble::convert {
namespace {

class Sweep {
 public:
  Sweep(const Source& source, const Words& words, Report& report)
      : source_(source), words_(words), report_(report) {}

  void visit(const pugi::xml_node& node, bool inDefaults) {
    const std::string type = node.name();
    if (!source_.isUsed(node)) {
      if (type == "include") return;
      const auto reason = words_.elements.find(type);
      const bool known = reason != words_.elements.end();
      report_.note(known ? reason->second.effect : Effect::Lost, source_.place(node),
                   type + inQuotes(node.attribute("name").value()),
                   known ? reason->second.why : "an element that is not known here");
      return;
    }
    for (const pugi::xml_attribute& attribute : node.attributes())
      if (!source_.isUsed(attribute)) note(node, attribute.name(), inDefaults);
    // the content of a class was read with the class
    for (const pugi::xml_node& child : node.children())
      if (child.type() == pugi::node_element) visit(child, inDefaults || type == "default");
  }

 private:
  void note(const pugi::xml_node& node, const std::string& key, bool inDefaults) {
    const std::string type = node.name(), what = type + "." + key;
    const auto add = [&](const Reason& reason) {
      report_.note(reason.effect, source_.place(node), what, reason.why);
    };
    if (const auto found = words_.attributes.find(what); found != words_.attributes.end())
      return add(found->second);
    if (const auto found = words_.anywhere.find(key); found != words_.anywhere.end())
      return add(found->second);
    // what is left of elements of these kinds, and of their defaults, does not matter by itself
    if (const auto found = words_.elements.find(type); found != words_.elements.end())
      return add({Effect::None, found->second.why});
    if (inDefaults) return add({Effect::None, "a default that no element takes"});
    if (source_.knows(what))
      return add({Effect::None, "another attribute takes its place, or nothing needs it"});
    if (type == "option" || type == "flag") return add({Effect::None, "settings of the solver"});
    if (type == "compiler") return add({Effect::None, "settings of the compiler"});
    add({Effect::Lost, "an attribute that is not known here"});
  }

  const Source& source_;
  const Words& words_;
  Report& report_;
};

}  // namespace

void noteUnused(const Source& source, const Words& words, Report& report) {
  Sweep sweep(source, words, report);
  for (const pugi::xml_node& root : source.roots()) sweep.visit(root, false);
}

}  // namespace rubble::convert
