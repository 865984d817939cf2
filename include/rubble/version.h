#pragma once
/// Version of the headers, and the language that they need.

#define RUBBLE_VERSION_MAJOR 0
#define RUBBLE_VERSION_MINOR 1
#define RUBBLE_VERSION_PATCH 0
#define RUBBLE_VERSION_TEXT "0.1.0"
/// 10000 major + 100 minor + patch, for #if. buildInfo().version is that of the library.
#define RUBBLE_VERSION (10000 * RUBBLE_VERSION_MAJOR + 100 * RUBBLE_VERSION_MINOR + RUBBLE_VERSION_PATCH)

#if defined(_MSVC_LANG) ? _MSVC_LANG < 202002L : __cplusplus < 202002L
#error \
    "Rubble needs C++20: compile with -std=c++20 (MSVC: /std:c++20), or link the CMake target rubble::rubble"
#else
#define RUBBLE_CPP20 1
#endif
