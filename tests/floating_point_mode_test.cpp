// Whatever mode a client's threads compute in, all work is done in the standard one, and the client's comes back.
#include <atomic>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include <sweepgrid/scheduler/floating_point_mode.hpp>
#include <sweepgrid/scheduler/recording_executor.hpp>
#include <sweepgrid/scheduler/stage_graph.hpp>

#include "client_mode.hpp"

namespace sweepgrid::floating_point_mode_test {
namespace {

using oracle::ClientMode;
using oracle::computes_as_standard;
using oracle::mode_register;

TEST(FloatingPointMode, IsTheStandardOneWhileItLives) {
  for (const ClientMode::Kind kind : ClientMode::kinds()) {
    const ClientMode client(kind);
    const std::uint64_t before = mode_register();
    EXPECT_EQ(computes_as_standard(), !kind.flush && kind.rounding == FE_TONEAREST);
    {
      const FloatingPointMode outer;
      EXPECT_TRUE(computes_as_standard());
      {
        const FloatingPointMode inner;
        EXPECT_TRUE(computes_as_standard());
      }
      EXPECT_TRUE(computes_as_standard());
    }
    EXPECT_EQ(mode_register(), before);
  }
}

#if defined(__x86_64__)
TEST(FloatingPointMode, TrapsNothingWhileItLives) {
  const unsigned before = _mm_getcsr();
  _mm_setcsr(0);  // all exceptions end the program
  float infinite = 0;
  {
    const FloatingPointMode mode;
    volatile float zero = 0;
    volatile float one = 1;
    infinite = one / zero;
  }
  EXPECT_EQ(_mm_getcsr(), 0U);
  _mm_setcsr(before);
  EXPECT_EQ(infinite, std::numeric_limits<float>::infinity());
}
#endif

class ModeOfWork : public testing::TestWithParam<int> {
 protected:
  std::shared_ptr<Executor> executor_ = make_executor(GetParam());
};

INSTANTIATE_TEST_SUITE_P(Threads, ModeOfWork, testing::Values(1, 2, 3),
                         [](const auto& test) { return std::to_string(test.param); });

TEST_P(ModeOfWork, IsStandardInEveryLoopAndTheCallersComesBack) {
  for (const ClientMode::Kind kind : ClientMode::kinds()) {
    const ClientMode client(kind);
    const std::uint64_t before = mode_register();
    for (const std::size_t count : {1, 2, 100}) {
      std::atomic<std::size_t> standard = 0;
      executor_->for_each(count, [&](std::size_t) { standard += computes_as_standard() ? 1 : 0; });
      EXPECT_EQ(standard, count);
      EXPECT_EQ(mode_register(), before);
    }
    bool standard = false;
    executor_->execute([&] { standard = computes_as_standard(); });
    EXPECT_TRUE(standard);
    EXPECT_THROW(executor_->for_each(100, [](std::size_t) { throw std::runtime_error("body"); }), std::runtime_error);
    EXPECT_EQ(mode_register(), before);
  }
}

/// A client's own executor: of the mode it knows nothing.
class PlainExecutor final : public Executor {
 public:
  explicit PlainExecutor(ClientMode::Kind kind) : kind_(kind) {}
  [[nodiscard]] int concurrency() const override { return 1; }
  [[nodiscard]] int worker() const override { return 0; }
  void for_each(std::size_t count, const std::function<void(std::size_t)>& body) override {
    std::thread([&] {
      const ClientMode mode(kind_);
      for (std::size_t i = 0; i != count; ++i) body(i);
    }).join();
  }
  void execute(const std::function<void()>& work) override { work(); }

 private:
  ClientMode::Kind kind_;
};

// Plans and tasks that run in the standard mode, of all that run.
std::pair<int, int> standard_in_graph(const std::shared_ptr<Executor>& executor) {
  std::atomic<int> standard = 0;
  std::atomic<int> all = 0;
  const auto look = [&] {
    standard += computes_as_standard() ? 1 : 0;
    ++all;
  };
  StageGraph graph(executor);
  StageGraph::StageId last = 0;
  for (int stage = 0; stage < 3; ++stage) {
    last = graph.add(
        "stage", stage == 0 ? std::vector<StageGraph::StageId>{} : std::vector{last},
        [&](std::vector<std::uint64_t>& costs) {
          look();
          costs.assign(40, 1);
        },
        [&](std::size_t) { look(); });
  }
  graph.run();
  return {standard, all};
}

TEST_P(ModeOfWork, IsStandardInEveryPlanAndTask) {
  for (const ClientMode::Kind kind : ClientMode::kinds()) {
    const ClientMode client(kind);
    const std::uint64_t before = mode_register();
    const std::pair<int, int> expected(3 * 41, 3 * 41);
    EXPECT_EQ(standard_in_graph(executor_), expected);
    EXPECT_EQ(standard_in_graph(std::make_shared<RecordingExecutor>(executor_, 4)), expected);
    EXPECT_EQ(standard_in_graph(std::make_shared<PlainExecutor>(kind)), expected);
    EXPECT_EQ(mode_register(), before);
  }
}

}  // namespace
}  // namespace sweepgrid::floating_point_mode_test
