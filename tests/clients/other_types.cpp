// What is not compiled ahead: a client's own key type, scalars and numbers of axes. Pairs are those of brute force.
#include <compare>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>

#include <sweepgrid/engine/keyed_engine.inl.hpp>

#include "scene.hpp"

namespace {

/// A key that can be copied, hashed and compared, and no more: it has no default and no assignment.
class Name {
 public:
  explicit Name(std::uint64_t number) : number_(number), text_(std::make_shared<std::string>(std::to_string(number))) {}
  Name(const Name&) = default;
  Name& operator=(const Name&) = delete;
  ~Name() = default;

  [[nodiscard]] std::uint64_t number() const { return number_; }
  friend bool operator==(const Name& a, const Name& b) { return *a.text_ == *b.text_; }

 private:
  std::uint64_t number_;
  std::shared_ptr<std::string> text_;
};

struct HashOfName {
  std::size_t operator()(const Name& name) const { return std::hash<std::uint64_t>()(name.number() / 3); }
};

struct OrderOfNames {
  bool operator()(const Name& a, const Name& b) const { return a.number() < b.number(); }
};

template <class Scalar, int Dim>
bool play(const char* what) {
  using Engine = sweepgrid::Engine<Scalar, Dim, Name, HashOfName, OrderOfNames>;
  int wrong = 0;
  for (const int threads : {1, 3}) {
    sweepgrid::Config config;
    config.threads = threads;
    config.parallel_from = 0;
    Engine engine(config);
    clients::Scene<Scalar, Dim> scene({"moving", 100, 30, clients::Unit::kQuarter, 80, 10, true}, 5);
    std::uint64_t next = 0;
    for (int step = 0; step < scene.regime().steps; ++step) {
      for (auto at = scene.objects.begin(); at != scene.objects.end();) {
        if (scene.random().below(8) == 0) {
          engine.erase(Name(at->first));
          at = scene.objects.erase(at);
          continue;
        }
        at->second = scene.near(at->second);
        engine.update(Name(at->first), scene.box(at->second));
        ++at;
      }
      for (; scene.objects.size() < 80; ++next) {
        const auto steps = scene.place();
        scene.objects.emplace(next, steps);
        engine.insert(Name(next), scene.box(steps));
      }
      engine.step();
      engine.validate();
      const auto pairs = engine.pairs();
      const auto expected = scene.pairs();
      const bool right = std::equal(
          pairs.begin(), pairs.end(), expected.begin(), expected.end(),
          [](const auto& a, const auto& b) { return a.first.number() == b.first && a.second.number() == b.second; });
      wrong += right && !pairs.empty() ? 0 : 1;
    }
  }
  std::printf("%s: %d steps with wrong pairs\n", what, wrong);
  return wrong == 0;
}

}  // namespace

int main() {
  bool right = play<float, 3>("float, 3 axes");
  right &= play<double, 4>("double, 4 axes");
  right &= play<float, 1>("float, 1 axis");
  right &= play<std::int64_t, 2>("int64, 2 axes");
  return right ? 0 : 1;
}
