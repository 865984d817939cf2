#pragma once
/// Types that a program adds to the lists (docs/extending.md). Its header RUBBLE_EXTENSION declares them and
/// defines RUBBLE_EXTRA_JOINTS as ", TheirKind", and RUBBLE_EXTRA_ELEMENTS and RUBBLE_EXTRA_SHAPES likewise.
#ifdef RUBBLE_EXTENSION
#include RUBBLE_EXTENSION
#endif
#ifndef RUBBLE_EXTRA_JOINTS
#define RUBBLE_EXTRA_JOINTS
#endif
#ifndef RUBBLE_EXTRA_ELEMENTS
#define RUBBLE_EXTRA_ELEMENTS
#endif
#ifndef RUBBLE_EXTRA_SHAPES
#define RUBBLE_EXTRA_SHAPES
#endif
