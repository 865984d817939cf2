#pragma once
/// The C API of Rubble. No exception crosses it. Definitions are JSON text with the keys of scene files
/// (docs/scene_format.md); state, forces, queries and results are plain structs and arrays.
#include <rubble/c/recording.h>
#include <rubble/c/scene.h>
#include <rubble/c/types.h>
#include <rubble/c/world.h>
#include <rubble/c/worlds.h>
