#pragma once
/// Rubble: rigid-body physics by Augmented Vertex Block Descent. Includes the whole API.
#include <rubble/version.h>

#if defined(RUBBLE_CPP20)  // otherwise version.h gives one error in place of many
#include <rubble/arrays.h>
#include <rubble/debug_draw.h>
#include <rubble/deformables.h>
#include <rubble/error.h>
#include <rubble/events.h>
#include <rubble/ids.h>
#include <rubble/inputs.h>
#include <rubble/joints.h>
#include <rubble/log.h>
#include <rubble/material.h>
#include <rubble/math.h>
#include <rubble/mesh.h>
#include <rubble/params.h>
#include <rubble/query.h>
#include <rubble/report.h>
#include <rubble/result.h>
#include <rubble/rod.h>
#include <rubble/scene.h>
#include <rubble/streams.h>
#include <rubble/tasks.h>
#include <rubble/world.h>
#endif
