#pragma once
/// Properties of this build and its force types, for listings and bug reports.
#include <string>
#include <vector>

namespace rubble {

/// An authored field of a force or joint: keyword in scene files, unit ("1" for none) and meaning.
struct ForceField {
  std::string field;
  std::string unit;
  std::string doc;
};

/// A force type: contact, ball joint and so on.
struct ForceInfo {
  std::string name;
  std::string doc;
  int rows = 0;  ///< scalar constraint rows per element
  std::vector<ForceField> fields;
  int axes = 0;              ///< entries of JointDef::axes that a joint type has
  bool frameBodies = false;  ///< may its axes lie in frame bodies?
};

/// All force types of the engine, contact first.
std::vector<ForceInfo> forceInfos();

/// A kind of deformable object: keyword in scene files and authored fields.
struct DeformableInfo {
  std::string name;
  std::string doc;
  std::vector<ForceField> fields;
};

/// All kinds of deformable objects. The first entry, "deformable", has the fields that all kinds share;
/// attachments are the last entry.
std::vector<DeformableInfo> deformableInfos();

struct BuildInfo {
  std::string version;                ///< "0.1.0"
  std::string commit;                 ///< git commit of the sources, or "unknown"
  std::string compiler;               ///< name and version
  std::string precision;              ///< of the solver: "float" or "double"
  std::vector<std::string> features;  ///< optional parts that are compiled in
};

BuildInfo buildInfo();

/// Names of the instruction sets that steps on a CPU are compiled for and that this processor has: "baseline"
/// (that of the build), then "avx2". The last one runs unless WorldOptions::instructionSet names another.
std::vector<std::string> instructionSets();

/// Availability of the CUDA backend on this machine, with the device or the reason: "on: NVIDIA H200, ...",
/// "off: built without CUDA", "off: no device found".
std::string cudaStatus();

}  // namespace rubble
