// What a client does in its first hour: objects in, a step, events out, threads or not.
#include <cstdint>
#include <cstdio>
#include <string>

#include <sweepgrid/engine/engine.hpp>

namespace {

using Engine = sweepgrid::Engine<double, 3, std::string>;

Engine::BoxType cube(double corner) { return {{corner, corner, corner}, {corner + 1, corner + 1, corner + 1}}; }

bool events_are_right(int threads) {
  sweepgrid::Config config;
  config.threads = threads;
  Engine engine(config);
  const auto rock = engine.insert("rock", cube(0));
  engine.insert("paper", cube(0.5));
  engine.insert("scissors", cube(10));

  const sweepgrid::Events<std::string> first = engine.step();
  engine.update(rock, cube(9.5));
  const sweepgrid::Events<std::string> second = engine.step();

  const sweepgrid::Events<std::string> expected_first{{}, {{"paper", "rock"}}};
  const sweepgrid::Events<std::string> expected_second{{{"paper", "rock"}}, {{"rock", "scissors"}}};
  return first == expected_first && second == expected_second;
}

}  // namespace

int main() {
  for (const int threads : {1, 2, 8}) {
    if (!events_are_right(threads)) {
      std::fprintf(stderr, "wrong events with %d threads\n", threads);
      return 1;
    }
  }
  return 0;
}
