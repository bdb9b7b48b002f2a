#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "scenes/generator_params.hpp"
#include "scenes/random_stream.hpp"
#include "scenes/scene_source.hpp"

namespace sweepgrid {

/// The synthetic scenes: cubes placed at random in a world of given density; a fixed part of them moves on straight
/// lines, at constant speed and in a random direction of its own, and bounces off the walls; some are replaced by new
/// ones in every step. The same on every machine: RandomStream, and of floating point only + - * / and sqrt.
class GeneratedScene : public SceneSource {
 public:
  /// `name`: the text that asked for it.
  GeneratedScene(std::string name, const GeneratorParams& params);

  [[nodiscard]] const SceneInfo& info() const override { return info_; }
  bool next(SceneStep& step) override;

 private:
  using Vector = std::array<double, 3>;

  // A place for an object. It keeps its width, motion and speed when another object takes it over.
  struct Slot {
    SceneKey key = 0;
    double width = 0;
    Vector low{};       // corner of the box
    Vector velocity{};  // of moving slots
    std::uint64_t filled_in_step = 0;
  };

  void lay_out_world();
  void start(SceneStep& step);
  void replace_some(SceneStep& step);
  void move(SceneStep& step);

  void fill(Slot& slot);
  void place(Slot& slot);
  void advance(Slot& slot) const;
  [[nodiscard]] Vector random_direction();
  [[nodiscard]] SceneBox box(const Slot& slot) const;

  GeneratorParams params_;
  SceneInfo info_;
  RandomStream random_;
  std::size_t dim_;
  Vector world_{};  // the world is [0, world_]
  std::vector<Vector> clump_centres_;
  std::vector<Slot> slots_;  // the first moving_count_ of them move
  std::size_t moving_count_ = 0;
  std::vector<std::uint32_t> deck_;  // slots, its front shuffled anew in each step
  SceneKey next_key_ = 0;
  std::uint64_t step_ = 0;
  bool started_ = false;
};

}  // namespace sweepgrid
