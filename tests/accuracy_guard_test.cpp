// Runs that take all memory or all time, or that crash, are results.

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "accuracy/guarded_run.hpp"
#include "sanitized.hpp"

namespace sweepgrid::accuracy::accuracy_guard_test {
namespace {

constexpr std::uint64_t kMegabyte = std::uint64_t{1} << 20;

// Written to, so that it is more than a promise.
void hold(std::vector<std::vector<char>>& blocks, std::size_t bytes) { blocks.emplace_back(bytes, 'x'); }

TEST(GuardedRun, GivesBackWhatTheWorkReturns) {
  const std::string text(100000, 'x');  // more than a pipe holds
  const GuardedRun run = run_guarded({}, [&] { return text; });
  EXPECT_EQ(run.end, RunEnd::kDone);
  EXPECT_EQ(run.text, text);
  EXPECT_GT(run.peak_bytes, kMegabyte);
}

TEST(GuardedRun, WhatTheWorkChangesIsLost) {
  int number = 1;
  EXPECT_EQ(run_guarded({}, [&] { return std::to_string(++number); }).text, "2");
  EXPECT_EQ(number, 1);
}

TEST(GuardedRun, AMemoryHogIsOutOfMemory) {
  if (oracle::kSanitized && !oracle::kThreadSanitized) GTEST_SKIP() << "the sanitizer's allocator does not throw";
  const RunBudget budget{64 * kMegabyte, 60};
  const GuardedRun hog = run_guarded(budget, [] {
    std::vector<std::vector<char>> blocks;
    while (true) hold(blocks, kMegabyte);
    return std::string();
  });
  EXPECT_EQ(hog.end, RunEnd::kOutOfMemory);
  EXPECT_GT(hog.peak_bytes, 32 * kMegabyte);
  const GuardedRun modest = run_guarded(budget, [] {
    std::vector<std::vector<char>> blocks;
    for (int i = 0; i < 32; ++i) hold(blocks, kMegabyte);
    return std::to_string(blocks.size());
  });
  EXPECT_EQ(modest.end, RunEnd::kDone);
  EXPECT_EQ(modest.text, "32");
}

TEST(GuardedRun, AnEndlessLoopIsOutOfTime) {
  const GuardedRun run = run_guarded({64 * kMegabyte, 0.3}, [] {
    std::atomic<bool> over = false;
    while (!over) {
    }
    return std::string();
  });
  EXPECT_EQ(run.end, RunEnd::kOutOfTime);
  EXPECT_GE(run.seconds, 0.3);
  EXPECT_LT(run.seconds, 30);
}

TEST(GuardedRun, AProcessThatWaitsForEverIsOutOfTimeToo) {
  const GuardedRun run = run_guarded({64 * kMegabyte, 0.05}, [] {
    while (true) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return std::string();
  });
  EXPECT_EQ(run.end, RunEnd::kOutOfTime);
  EXPECT_GE(run.seconds, 0.3);
}

TEST(GuardedRun, AnExceptionIsAnErrorWithItsReason) {
  const GuardedRun run = run_guarded({}, []() -> std::string { throw std::invalid_argument("box of object 7"); });
  EXPECT_EQ(run.end, RunEnd::kError);
  EXPECT_EQ(run.text, "box of object 7");
}

TEST(GuardedRun, ACrashIsAResult) {
  const GuardedRun killed = run_guarded({}, [] {
    std::signal(SIGTERM, SIG_DFL);
    std::raise(SIGTERM);
    return std::string();
  });
  EXPECT_EQ(killed.end, RunEnd::kCrash);
  EXPECT_EQ(killed.text, "Terminated");
  const GuardedRun gone = run_guarded({}, []() -> std::string { _Exit(3); });
  EXPECT_EQ(gone.end, RunEnd::kCrash);
  EXPECT_EQ(gone.text, "exit status 3");
}

}  // namespace
}  // namespace sweepgrid::accuracy::accuracy_guard_test
