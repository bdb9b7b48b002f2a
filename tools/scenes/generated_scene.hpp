#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "scenes/generator_params.hpp"
#include "scenes/random_stream.hpp"
#include "scenes/scene_source.hpp"
#include "scenes/spin.hpp"

namespace sweepgrid {

/// The synthetic scenes: cubes placed at random in a world of given density; a fixed part of them moves on straight
/// lines, at constant speed and in a random direction of its own, and bounces off the walls; some are replaced by new
/// ones in every step. Parameters make them shake, turn, go to and fro, tie, flat, infinite or bad input. The same on
/// every machine: RandomStream, and of floating point only + - * / and sqrt.
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
    Vector low{};       // corner of its place, from the corner of the world
    Vector shift{};     // of the object from its place
    Vector velocity{};  // of moving slots
    std::uint64_t filled_in_step = 0;
    int reaches = 0;      // -1 or 1: to infinity on that side of `axis`
    bool covers = false;  // the whole world
  };

  void lay_out_world();
  void start(SceneStep& step);
  void replace_some(SceneStep& step);
  void move(SceneStep& step);
  void shake(SceneStep& step);
  void append(const Slot& slot, std::vector<SceneKey>& keys, std::vector<SceneBox>& boxes,
              std::vector<OrientedBox>& shapes) const;
  void tell_insert(const Slot& slot, SceneStep& step) const;
  void tell_update(const Slot& slot, SceneStep& step) const;

  void fill(Slot& slot);
  void place(Slot& slot);
  void cross(Slot& slot) const;
  void advance(Slot& slot) const;
  [[nodiscard]] Vector random_direction();
  [[nodiscard]] SceneBox box(const Slot& slot) const;
  [[nodiscard]] OrientedBox shape(const Slot& slot) const;
  // Makes bad input of it, sometimes.
  void spoil(SceneBox& box);

  GeneratorParams params_;
  SceneInfo info_;
  RandomStream random_;
  std::size_t dim_;
  std::size_t axis_;  // of layers, thin and infinite
  double offset_;     // of the world's corner from the origin
  Vector world_{};    // extent of the world
  std::vector<Vector> clump_centres_;
  std::vector<Slot> slots_;  // the first moving_count_ of them move, the last cover the world
  std::vector<Spin> spins_;  // by slot, where objects are oriented boxes; else empty
  std::size_t moving_count_ = 0;
  std::vector<std::uint32_t> deck_;  // slots, its front shuffled anew in each step
  SceneKey next_key_ = 0;
  std::uint64_t step_ = 0;
  bool started_ = false;
};

}  // namespace sweepgrid
