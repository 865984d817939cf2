#pragma once
/// What the C library of the system is good for as a reference.

namespace rubble::test {

/// Are its sines and cosines exact to the last place? On Windows they reduce angles by 66 bits of pi.
#if defined(_WIN32)
inline constexpr bool kReducesAngles = false;
#else
inline constexpr bool kReducesAngles = true;
#endif

}  // namespace rubble::test
