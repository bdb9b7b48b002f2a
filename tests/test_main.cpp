// main() of a test program: PROGRAM [options of GoogleTest] [NAME...] runs the cases that stand in the files NAME.cpp
// or NAME_test.cpp; without a name, all of them. So many files can share a program and be tests of their own.
#include <cstdio>
#include <set>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

namespace {

// tests/grid_spec_test.cpp -> grid_spec
std::string name_of(std::string_view file) {
  file.remove_prefix(file.rfind('/') + 1);
  file = file.substr(0, file.rfind(".cpp"));
  return std::string(file.substr(0, file.rfind("_test")));
}

// The filter that selects the cases of these files. Empty: a name without any case.
std::string filter_of(const std::set<std::string>& names) {
  std::string filter;
  std::set<std::string> found;
  const testing::UnitTest& all = *testing::UnitTest::GetInstance();
  for (int s = 0; s < all.total_test_suite_count(); ++s) {
    const testing::TestSuite& suite = *all.GetTestSuite(s);
    for (int c = 0; c < suite.total_test_count(); ++c) {
      const std::string name = name_of(suite.GetTestInfo(c)->file());
      if (names.count(name) == 0) continue;
      found.insert(name);
      filter += std::string(suite.name()) + '.' + suite.GetTestInfo(c)->name() + ':';
    }
  }
  return found == names ? filter : "";
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  if (argc > 1) {
    const std::string filter = filter_of({argv + 1, argv + argc});
    if (filter.empty()) {
      std::fprintf(stderr, "%s: one of these files has no test case here\n", argv[0]);
      return 2;
    }
    testing::GTEST_FLAG(filter) = filter;
  }
  return RUN_ALL_TESTS();
}
