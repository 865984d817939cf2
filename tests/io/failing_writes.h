#pragma once
/// Every write to a file is counted, and can be made to fail as on a full disk.
namespace rubble::test {

/// While it lives, writes of this program to files fail: the `first`-th from now on (from 0), of which half
/// is written, and with `lasting` all after it.
class FailingWrites {
 public:
  FailingWrites(long first, bool lasting);
  ~FailingWrites();
  FailingWrites(const FailingWrites&) = delete;
  FailingWrites& operator=(const FailingWrites&) = delete;
  /// Has any failed?
  bool hasFailed() const;
};

/// False with a sanitizer, which has functions of its own: nothing fails then.
bool writesFail();

}  // namespace rubble::test
