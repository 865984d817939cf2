#pragma once
#include <string>

namespace rubble::test {

/// Uses the library in code that is compiled with -fno-exceptions, and says what came of it.
std::string withoutExceptions();

}  // namespace rubble::test
