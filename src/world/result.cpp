#include <rubble/result.h>

namespace rubble {

std::optional<Failure> catchFailure(void (*call)(void*), void* context) noexcept {
  try {
    call(context);
    return {};
  } catch (const Error& error) {
    return Failure{error.what(), error.path(), error.expected(), error.found()};
  } catch (const std::exception& error) {
    return Failure{error.what(), "", "", ""};
  } catch (...) {
    return Failure{"an exception of an unknown type", "", "", ""};
  }
}

}  // namespace rubble
