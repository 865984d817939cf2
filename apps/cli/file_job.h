#pragma once
#include <string>
#include <vector>

#include "io/scene_json.h"
#include "scenes/registry.h"

namespace rubble::cli {

/// A job from a scene file, watched by probes that measure what its verdict may name (docs/scene_format.md).
/// Throws Error with every fault of the file.
scenes::Job loadFileJob(const std::string& file);

/// A job from a scene that was read already.
scenes::Job jobOf(io::SceneFile scene);

/// The scene of a model file (docs/importing.md). What the import lost or approximated goes to standard
/// error. Throws Error if the model is invalid or this build cannot import.
io::SceneFile importScene(const std::string& file);

/// Every fault of a scene file, its text and its verdict. Throws Error if the file cannot be read at all.
std::vector<io::Fault> checkFile(const std::string& file, io::SceneFile& scene);

/// What an error says beside its path.
std::string messageOf(const Error& error);

/// Faults that prevent a world: shapes of the scene or of its events that cannot be cooked.
std::vector<io::Fault> worldFaults(const Scene& scene);

/// The file form of a job. Claims about what only the probes of its registry scene measure are left out.
io::SceneFile fileOf(const scenes::Job& job);

}  // namespace rubble::cli
