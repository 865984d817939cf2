#pragma once
/// Rubble: rigid-body physics by Augmented Vertex Block Descent. Includes the whole API.
#include <rubble/arrays.h>
#include <rubble/deformables.h>
#include <rubble/error.h>
#include <rubble/events.h>
#include <rubble/ids.h>
#include <rubble/inputs.h>
#include <rubble/log.h>
#include <rubble/material.h>
#include <rubble/math.h>
#include <rubble/mesh.h>
#include <rubble/params.h>
#include <rubble/query.h>
#include <rubble/report.h>
#include <rubble/rod.h>
#include <rubble/scene.h>
#include <rubble/world.h>
