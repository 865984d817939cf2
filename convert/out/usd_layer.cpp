#include "convert/out/usd_layer.h"

#include <algorithm>
#include <cctype>

namespace rubble::convert {

int UsdLayer::prim(int parent, const std::string& name, const std::string& type) {
  const int number = static_cast<int>(prims_.size());
  prims_.push_back({name, type, parent, {}, {}, {}});
  (parent < 0 ? top_ : prims_[static_cast<std::size_t>(parent)].children).push_back(number);
  return number;
}

std::string UsdLayer::freeName(int parent, const std::string& wanted) const {
  std::string name;
  for (const char c : wanted) name += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  if (name.empty() || std::isdigit(static_cast<unsigned char>(name[0]))) name = "_" + name;
  const std::vector<int>& siblings = parent < 0 ? top_ : prims_[static_cast<std::size_t>(parent)].children;
  const auto isTaken = [&](const std::string& one) {
    return std::any_of(siblings.begin(), siblings.end(),
                       [&](int s) { return prims_[static_cast<std::size_t>(s)].name == one; });
  };
  std::string free = name;
  for (int k = 2; isTaken(free); ++k) free = name + "_" + std::to_string(k);
  return free;
}

std::string UsdLayer::pathOf(int prim) const {
  const Prim& p = prims_[static_cast<std::size_t>(prim)];
  return (p.parent < 0 ? "" : pathOf(p.parent)) + "/" + p.name;
}

int UsdLayer::attribute(int prim, const std::string& type, const std::string& name,
                        const std::string& interpolation, bool uniform) {
  const int number = static_cast<int>(attributes_.size());
  attributes_.push_back({type, name, interpolation, uniform});
  prims_[static_cast<std::size_t>(prim)].attributes.push_back(number);
  return number;
}

void UsdLayer::relate(int prim, const std::string& name, const std::vector<int>& targets) {
  prims_[static_cast<std::size_t>(prim)].relations.push_back({name, targets});
}

}  // namespace rubble::convert
