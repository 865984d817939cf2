#pragma once
/// A stage: a layer with its sublayers, references, payloads, inherits and variants composed into one tree.
#include <functional>
#include <string>
#include <vector>

#include "convert/usd/layer.h"

namespace rubble::usd {

struct Stage {
  Prim root;
  std::string upAxis = "Y";
  double metersPerUnit = 0.01, kilogramsPerUnit = 1;
};

/// Something that the stage names and that is not there.
struct Missing {
  std::string file;
  int line;
  std::string prim, why;
};

/// The file of an asset that a layer names; throws Error if it may not be read. `who` is named in errors.
using Find = std::function<std::string(const std::string& asset, const std::string& layer,
                                       const std::string& who)>;

/// The content of a file that Find has named.
using Read = std::function<std::string(const std::string& file, const std::string& who)>;

/// Composes a file, of which `bytes` is the content. References and sublayers that cannot be found are listed
/// in `missing`. Throws Error for layers that are not well-formed, for arcs that form a cycle, and for more
/// than kMostPrims prims.
Stage openStage(const std::string& bytes, const std::string& file, const Find& find, const Read& read,
                std::vector<Missing>& missing);

}  // namespace rubble::usd
