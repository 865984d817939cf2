#pragma once
/// What writers leave in a folder where a write or an allocation of them fails.
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <new>
#include <string>

#include <rubble/error.h>

#include "tests/backend/counted_memory.h"
#include "tests/io/failing_writes.h"
#include "tests/support/files.h"

namespace rubble::test {

using Folder = std::map<std::string, std::string>;

/// The files of a folder, and what they have.
inline Folder contentsOf(const std::filesystem::path& folder) {
  Folder out;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    out[entry.path().filename().string()] = contentOf(entry.path());
  return out;
}

/// Calls write() while its n-th write or allocation fails. Did one?
template <class Failing, class Write> bool failsAt(long n, bool lasting, bool& threw, Write&& write) {
  const Failing failing(n, lasting);
  threw = false;
  try {
    write();
  } catch (const Error&) {
    threw = true;
  } catch (const std::bad_alloc&) {
    threw = true;
  }
  return failing.hasFailed();
}

/// A file is written in full, or with an error not at all. `write(file)`: to a new or an earlier file, and to
/// others of its folder at most if `isOne` is false.
template <class Failing>
void expectWholeOrAsBefore(const std::string& name, const std::function<void(const std::string&)>& write,
                           bool isOne = true) {
  constexpr long kMost = 20000;
  Folder whole;
  {
    const TemporaryFolder folder;
    write((folder.path / name).string());
    whole = contentsOf(folder.path);
  }
  for (const bool isThere : {false, true})
    for (const bool lasting : {false, true})
      for (long n = 0; n < kMost; ++n) {
        const TemporaryFolder folder;
        const std::string file = (folder.path / name).string();
        if (isThere) std::ofstream(file) << "before";
        const Folder before = contentsOf(folder.path);
        bool threw = false;
        const bool failed = failsAt<Failing>(n, lasting, threw, [&] { write(file); });
        const Folder after = contentsOf(folder.path);
        if (!threw) {
          EXPECT_EQ(after == whole, true) << name << " " << n;
        } else if (isOne) {
          EXPECT_EQ(after == before, true) << name << " " << n;
        } else {
          // each of several files by itself
          for (const auto& [one, content] : after)
            EXPECT_TRUE((whole.contains(one) && whole.at(one) == content) ||
                        (before.contains(one) && before.at(one) == content))
                << one << " " << n;
        }
        if (!failed || testing::Test::HasFailure()) break;
        ASSERT_LT(n, kMost - 1) << name;
      }
}

}  // namespace rubble::test
