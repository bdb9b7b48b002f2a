// Gives bad boxes to every call: each has to be refused, and to change nothing. Then looks what the client's own use of
// Box makes of them.
#include <bit>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include <sweepgrid/engine/engine.hpp>

#include "../client_mode.hpp"

namespace {

template <class Scalar>
struct Trial {
  using Engine = sweepgrid::Engine<Scalar, 3>;
  using Box = typename Engine::BoxType;
  using Bits = std::conditional_t<sizeof(Scalar) == 4, std::uint32_t, std::uint64_t>;

  int tried = 0;
  int refused = 0;
  int changed = 0;

  template <class Call>
  void refuse(Engine& engine, const Call& call) {
    const std::uint64_t mode = sweepgrid::oracle::mode_register();
    const std::size_t size = engine.size();
    ++tried;
    try {
      call();
    } catch (const std::invalid_argument&) {
      ++refused;
    }
    if (engine.size() != size || sweepgrid::oracle::mode_register() != mode) ++changed;
  }

  static std::vector<Box> bad_boxes() {
    // By bits: the compiler may take it that there is no NaN.
    constexpr Bits kExponent = std::bit_cast<Bits>(std::numeric_limits<Scalar>::infinity());
    constexpr Bits kSign = Bits{1} << (8 * sizeof(Bits) - 1);
    std::vector<Box> boxes;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const Bits nan : {kExponent + 1, kExponent | kExponent >> 1, kSign | (kExponent + 1)}) {
        for (const bool at_max : {false, true}) {
          Box box({0, 0, 0}, {1, 1, 1});
          (at_max ? box.max : box.min)[axis] = std::bit_cast<Scalar>(nan);
          boxes.push_back(box);
        }
      }
      Box box({0, 0, 0}, {1, 1, 1});
      box.min[axis] = std::bit_cast<Scalar>(Bits{300});
      box.max[axis] = std::bit_cast<Scalar>(Bits{100});
      boxes.push_back(box);
      box.min[axis] = 3, box.max[axis] = 1;
      boxes.push_back(box);
    }
    return boxes;
  }

  void run() {
    for (const int threads : {1, 2}) {
      for (const bool margins : {false, true}) {
        sweepgrid::Config config;
        config.threads = threads;
        config.parallel_from = 0;
        if (margins) config.envelope.emplace().margin = 0.5;
        Engine engine(config);
        const Box good({0, 0, 0}, {1, 1, 1});
        const sweepgrid::Handle handle = engine.insert(1, good);
        for (const Box& bad : bad_boxes()) {
          const std::vector<std::uint64_t> keys = {5, 6};
          const std::vector<Box> boxes = {good, bad};
          const std::vector<sweepgrid::Handle> handles = {handle, handle};
          refuse(engine, [&] { engine.insert(2, bad); });
          refuse(engine, [&] { engine.insert(keys, boxes); });
          refuse(engine, [&] { engine.update(handle, bad); });
          refuse(engine, [&] { engine.update(std::uint64_t{1}, bad); });
          refuse(engine, [&] { engine.update(handles, boxes); });
          ++tried;
          refused += bad.valid() ? 0 : 1;
        }
        engine.insert(2, good);
        engine.step();
        engine.validate();
        if (engine.pairs().size() != 1) ++changed;
      }
    }
  }
};

template <class Scalar>
bool try_all(const char* scalar) {
  Trial<Scalar> trial;
  trial.run();
  std::printf("%s: refused %d of %d, changed by %d\n", scalar, trial.refused, trial.tried, trial.changed);
  return trial.refused == trial.tried && trial.changed == 0;
}

}  // namespace

int main() {
  const bool right = try_all<float>("float");
  return try_all<double>("double") && right ? 0 : 1;
}
