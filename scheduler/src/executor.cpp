#include <stdexcept>
#include <string>

#include <oneapi/tbb/info.h>

#include <sweepgrid/scheduler/executor.hpp>
#include <sweepgrid/scheduler/floating_point_mode.hpp>

#include "arena_executor.hpp"

namespace sweepgrid {
namespace {

class SerialExecutor final : public Executor {
 public:
  [[nodiscard]] int concurrency() const override { return 1; }
  [[nodiscard]] int worker() const override { return 0; }

  void for_each(std::size_t count, const std::function<void(std::size_t)>& body) override {
    const FloatingPointMode mode;
    for (std::size_t i = 0; i != count; ++i) body(i);
  }

  void execute(const std::function<void()>& work) override {
    const FloatingPointMode mode;
    work();
  }
};

}  // namespace

std::shared_ptr<Executor> make_serial_executor() { return std::make_shared<SerialExecutor>(); }

std::shared_ptr<Executor> make_executor(int threads) {
  if (threads < 0) throw std::invalid_argument("threads must not be negative: " + std::to_string(threads));
  // oneTBB takes memory for each, used or not, and for more of them than this machine has it fails in its own ways.
  constexpr int kMostThreads = 65536;
  if (threads > kMostThreads) {
    throw std::invalid_argument("threads must not be above 65536: " + std::to_string(threads));
  }
  if (threads == 1) return make_serial_executor();
  if (threads == 0) threads = oneapi::tbb::info::default_concurrency();
  if (threads == 1) return make_serial_executor();
  return std::make_shared<ArenaExecutor>(threads);
}

}  // namespace sweepgrid
