#pragma once
/// What this build of the library is and what it knows, for listings and bug reports.
#include <string>
#include <vector>

namespace rubble {

/// One thing that an author sets on a force or joint: its name in scene files, its unit ("1" for none) and
/// its meaning.
struct ForceField {
  std::string field;
  std::string unit;
  std::string doc;
};

/// One kind of force: contact, ball joint and so on.
struct ForceInfo {
  std::string name;
  std::string doc;
  int rows = 0;  ///< scalar constraint rows that one element adds to the solve
  std::vector<ForceField> fields;
};

/// Every force of the engine, contact first.
std::vector<ForceInfo> forceInfos();

/// A kind of deformable object: its name in scene files and what an author sets on it.
struct DeformableInfo {
  std::string name;
  std::string doc;
  std::vector<ForceField> fields;
};

/// Every kind; what they share is the first entry, "deformable", and attachments are the last one.
std::vector<DeformableInfo> deformableInfos();

struct BuildInfo {
  std::string version;                ///< "0.1.0"
  std::string commit;                 ///< of the sources, or "unknown"
  std::string compiler;               ///< name and version
  std::string precision;              ///< of the solver: "float" or "double"
  std::vector<std::string> features;  ///< optional parts that are in
};

BuildInfo buildInfo();

/// Whether the CUDA backend can run here, and on what, or why not: "on: NVIDIA H200, ...", "off: built
/// without CUDA", "off: no device found".
std::string cudaStatus();

}  // namespace rubble
