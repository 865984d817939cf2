#pragma once
/// Errors as results, for programs without exceptions (-fno-exceptions). Rubble itself is built with them.
#include <concepts>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include <rubble/error.h>

namespace rubble {

/// An Error as data. `message` is its what(), the other three are as in Error.
struct Failure {
  std::string message, path, expected, found;
};

/// A value, or the failure of the call that should have made it.
template <class T> class Result {
 public:
  Result(T value) : value_(std::move(value)) {}
  Result(Failure failure) : failure_(std::move(failure)) {}

  explicit operator bool() const { return value_.has_value(); }
  /// Only of a result that holds a value.
  T& operator*() { return *value_; }
  const T& operator*() const { return *value_; }
  T* operator->() { return &*value_; }
  const T* operator->() const { return &*value_; }
  /// Empty strings if there is a value.
  const Failure& failure() const { return failure_; }

 private:
  std::optional<T> value_;
  Failure failure_;
};

/// Runs call(context) and returns the failure if it threw, of any type.
std::optional<Failure> catchFailure(void (*call)(void*), void* context) noexcept;

/// Calls f() and returns its value, or its failure: attempt([&] { return World(scene); }). Of a function
/// without a value the value is `true`. Make one call of the library in f: where it throws, objects that f
/// itself holds are not destroyed in a program without exceptions.
template <std::invocable F> auto attempt(F&& f) {
  using Value = std::invoke_result_t<F>;
  using Kept = std::conditional_t<std::is_void_v<Value>, bool, Value>;
  struct Context {
    F& f;
    std::optional<Kept> value;
  } context{f, {}};
  std::optional<Failure> failure = catchFailure(
      [](void* at) {
        auto& to = *static_cast<Context*>(at);
        if constexpr (std::is_void_v<Value>)
          to.f(), to.value = true;
        else
          to.value.emplace(to.f());
      },
      &context);
  return failure ? Result<Kept>(std::move(*failure)) : Result<Kept>(std::move(*context.value));
}

}  // namespace rubble
