#include "convert/usd/stage.h"

#include <algorithm>
#include <map>
#include <set>
#include <sstream>

#include <rubble/error.h>

namespace rubble::usd {
namespace {

/// Adds what the stronger prim lacks.
void addWeaker(Prim& strong, Prim&& weak) {
  if (strong.type.empty()) strong.type = weak.type;
  if (strong.kind == Prim::Kind::Over) strong.kind = weak.kind;
  if (strong.line == 0) strong.file = weak.file, strong.line = weak.line;
  strong.active = strong.active && weak.active;
  for (std::string& schema : weak.schemas)
    if (!strong.hasSchema(schema)) strong.schemas.push_back(std::move(schema));
  for (Property& property : weak.properties) {
    const auto own = std::find_if(strong.properties.begin(), strong.properties.end(),
                                  [&](const Property& p) { return p.name == property.name; });
    if (own == strong.properties.end()) {
      strong.properties.push_back(std::move(property));
      continue;
    }
    if (own->value.empty()) own->value = std::move(property.value);
    if (own->targets.empty()) own->targets = std::move(property.targets);
    if (own->type.empty()) own->type = property.type;
  }
  const auto append = [](std::vector<Arc>& to, std::vector<Arc>& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  append(strong.references, weak.references), append(strong.inherits, weak.inherits);
  strong.selections.insert(weak.selections.begin(), weak.selections.end());
  for (auto& [set, choices] : weak.variants)
    for (auto& [choice, content] : choices) {
      auto& place = strong.variants[set][choice];
      if (place)
        addWeaker(*place, std::move(*content));
      else
        place = std::move(content);
    }
  // the children of the weaker prim come first, as in USD
  std::vector<std::unique_ptr<Prim>> children;
  for (auto& child : weak.children) {
    const auto own = std::find_if(strong.children.begin(), strong.children.end(),
                                  [&](const auto& each) { return each && each->name == child->name; });
    if (own != strong.children.end()) {
      addWeaker(**own, std::move(*child));
      child = std::move(*own);
    }
    children.push_back(std::move(child));
  }
  for (auto& child : strong.children)
    if (child) children.push_back(std::move(child));
  strong.children = std::move(children);
}

/// Targets below `from` become targets below `to`.
void moveTargets(Prim& prim, const std::string& from, const std::string& to) {
  for (Property& property : prim.properties)
    for (std::string& target : property.targets)
      if (target.starts_with(from) &&
          (target.size() == from.size() || target[from.size()] == '/' || target[from.size()] == '.'))
        target = to + target.substr(from.size());
  for (auto& child : prim.children) moveTargets(*child, from, to);
  for (auto& [set, choices] : prim.variants)
    for (auto& [choice, content] : choices) moveTargets(*content, from, to);
}

/// Relative targets become absolute.
void makeAbsolute(Prim& prim, const std::string& path) {
  for (Property& property : prim.properties)
    for (std::string& target : property.targets) {
      if (target.starts_with('/')) continue;
      std::string base = path, rest = target;
      while (rest.starts_with("../")) {
        base = base.substr(0, base.rfind('/')), rest = rest.substr(3);
        if (base.empty()) base = "/";
      }
      if (rest.starts_with("./")) rest = rest.substr(2);
      target = rest == ".."                  ? base.substr(0, base.rfind('/'))
               : rest.empty() || rest == "." ? base
                                             : joined(base, rest);
    }
  for (auto& child : prim.children) makeAbsolute(*child, joined(path, child->name));
  for (auto& [set, choices] : prim.variants)
    for (auto& [choice, content] : choices) makeAbsolute(*content, path);
}

class Composer {
 public:
  Composer(const Find& find, const Read& read, std::vector<Missing>& missing)
      : find_(find), read_(read), missing_(missing) {}

  Stage open(const std::string& bytes, const std::string& file) {
    Layer& layer = add(bytes, file, file);
    Stage out;
    if (!layer.upAxis.empty()) out.upAxis = layer.upAxis;
    if (layer.metersPerUnit > 0) out.metersPerUnit = layer.metersPerUnit;
    if (layer.kilogramsPerUnit > 0) out.kilogramsPerUnit = layer.kilogramsPerUnit;
    out.root = std::move(*layer.root.copy());
    compose(out.root, "/", layer, 0);
    return out;
  }

 private:
  /// A layer with its sublayers.
  Layer& load(const std::string& file, const std::string& who) {
    if (const auto known = layers_.find(file); known != layers_.end()) return *known->second;
    if (loading_.contains(file)) throw Error(who, "layers without a cycle", "\"" + file + "\"");
    return add(read_(file, who), file, who);
  }
  Layer& add(const std::string& bytes, const std::string& file, const std::string& who) {
    if (!loading_.insert(file).second) throw Error(who, "layers without a cycle", "\"" + file + "\"");
    auto layer = std::make_unique<Layer>(parse(bytes, file));
    makeAbsolute(layer->root, "/");
    for (const std::string& sub : layer->subLayers) {
      const std::string who = file + ": subLayers";
      std::string found;
      try {
        found = find_(sub, file, who);
      } catch (const Error& error) {
        missing_.push_back({file, 1, "/", error.what()});
        continue;
      }
      Layer& weaker = load(found, who);
      Prim content = std::move(*weaker.root.copy());
      addWeaker(layer->root, std::move(content));
      if (layer->defaultPrim.empty()) layer->defaultPrim = weaker.defaultPrim;
    }
    loading_.erase(file);
    return *(layers_[file] = std::move(layer));
  }

  static const Prim* at(const Layer& layer, const std::string& path) {
    const Prim* prim = &layer.root;
    std::istringstream names(path);
    for (std::string name; prim && std::getline(names, name, '/');)
      if (!name.empty()) prim = prim->child(name);
    return prim;
  }

  /// Composes the arcs of a prim and of all below it. Its specs are of `layer`, at `path` in the stage.
  void compose(Prim& prim, const std::string& path, const Layer& layer, int depth) {
    if (depth > kMostDepth) throw Error(layer.file + ": " + path, "at most 100 levels", "more");
    if (++prims_ > kMostPrims) throw Error(layer.file + ": " + path, "at most 500000 prims", "more");
    // variants may bring further arcs and variants
    for (int round = 0; round < kMostDepth; ++round) {
      if (!prim.inherits.empty()) {
        const std::vector<Arc> arcs = std::exchange(prim.inherits, {});
        for (const Arc& arc : arcs) follow(prim, path, layer, {"", arc.path, arc.line}, depth);
      } else if (!prim.variants.empty()) {
        auto sets = std::exchange(prim.variants, {});
        for (auto& [set, choices] : sets) {
          const auto selected = prim.selections.find(set);
          const auto content = selected == prim.selections.end() ? choices.end()
                                                                 : choices.find(selected->second);
          if (content != choices.end()) addWeaker(prim, std::move(*content->second));
        }
      } else if (!prim.references.empty()) {
        const std::vector<Arc> arcs = std::exchange(prim.references, {});
        for (const Arc& arc : arcs) follow(prim, path, layer, arc, depth);
      } else {
        break;
      }
    }
    for (auto& child : prim.children) compose(*child, joined(path, child->name), layer, depth + 1);
  }

  void follow(Prim& prim, const std::string& path, const Layer& layer, const Arc& arc, int depth) {
    const auto miss = [&](const std::string& why) { missing_.push_back({layer.file, arc.line, path, why}); };
    const Layer* from = &layer;
    const std::string who = layer.file + ": " + path + ": references";
    if (!arc.asset.empty()) {
      std::string file;
      try {
        file = find_(arc.asset, layer.file, who);
      } catch (const Error& error) {
        return miss(error.what());
      }
      from = &load(file, who);
    }
    std::string target = arc.path;
    if (target.empty() && !from->defaultPrim.empty())
      target = from->defaultPrim.starts_with('/') ? from->defaultPrim : "/" + from->defaultPrim;
    const Prim* const found = target.empty() ? nullptr : at(*from, target);
    if (!found) return miss("a prim " + (target.empty() ? "by default" : target) + " that is not there");
    const auto key = std::pair{from->file, target};
    if (std::find(open_.begin(), open_.end(), key) != open_.end())
      throw Error(who, "references without a cycle", target);
    if (static_cast<int>(open_.size()) > kMostDepth)
      throw Error(who, "at most 100 levels of references", "more");
    open_.push_back(key);
    std::unique_ptr<Prim> content = found->copy();
    for (const auto& [set, choice] : prim.selections) content->selections[set] = choice;
    compose(*content, target, *from, depth + 1);
    open_.pop_back();
    moveTargets(*content, target, path);
    content->kind = Prim::Kind::Over;
    if (found->kind == Prim::Kind::Def && prim.kind == Prim::Kind::Over) content->kind = Prim::Kind::Def;
    addWeaker(prim, std::move(*content));
  }

  const Find& find_;
  const Read& read_;
  std::vector<Missing>& missing_;
  std::map<std::string, std::unique_ptr<Layer>> layers_;
  std::set<std::string> loading_;
  std::vector<std::pair<std::string, std::string>> open_;
  std::size_t prims_ = 0;
};

}  // namespace

Stage openStage(const std::string& bytes, const std::string& file, const Find& find, const Read& read,
                std::vector<Missing>& missing) {
  return Composer(find, read, missing).open(bytes, file);
}

}  // namespace rubble::usd
