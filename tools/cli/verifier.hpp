#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <sweepgrid/engine/events.hpp>

#include "cli/overlap_oracle.hpp"
#include "scenes/scene_source.hpp"
#include "setup/guarantee.hpp"

namespace sweepgrid {

/// What a verification found. The counts of errors are those of the first step that has one; it ends there. What a
/// promise allows, extra pairs or missing ones, too, is no error, and counted over all steps.
struct Verification {
  Guarantee promised = Guarantee::kExact;  ///< the least of all steps
  std::uint64_t steps = 0;                 ///< found right, the start not counted
  std::uint64_t pairs = 0;                 ///< overlapping pairs compared, over all steps
  std::uint64_t missing = 0;               ///< overlap, but the events do not lead to it
  std::uint64_t extra = 0;                 ///< do not overlap, but the events lead to it
  std::uint64_t duplicate = 0;             ///< a pair twice in one list of events
  std::uint64_t spurious = 0;              ///< a begin of a pair that was there, an end of one that was not
  std::uint64_t misordered = 0;            ///< events out of order, or a pair whose first key is not the lower one
  std::string first_error;                 ///< step, pair and boxes; empty when all is right

  [[nodiscard]] bool ok() const { return first_error.empty(); }
};

/// Holds the events of each step against the OverlapOracle.
class Verifier {
 public:
  /// The boxes with which the pairs are promised; for exact ones often those that the engine got, in the engine's
  /// precision. Then: what the engine said of it. False when the promise is not kept; nothing more may be checked then.
  bool check_step(const SceneStep& ops, const Events<SceneKey>& events, Guarantee promised = Guarantee::kExact);

  /// Compares a list of all pairs, such as that of Engine::pairs(), with what the events lead to.
  bool check_pairs(const std::vector<ScenePair>& pairs);

  [[nodiscard]] const Verification& result() const { return result_; }

  /// Pairs after the latest step.
  [[nodiscard]] std::size_t pair_count() const { return current_.size(); }

 private:
  void check_list(std::string_view name, const std::vector<ScenePair>& list);
  // What the events make of `current_`, noting what they should not hold.
  void apply_events(const SceneStep& ops, const Events<SceneKey>& events);
  void compare_with_oracle(Guarantee promised);
  void note(std::uint64_t& counter, const ScenePair& pair, std::string_view what);

  OverlapOracle oracle_;
  std::vector<ScenePair> expected_;  // the oracle's, sorted
  std::vector<ScenePair> current_;   // what the events of all steps lead to, sorted
  std::uint64_t step_ = 0;
  bool started_ = false;
  Verification result_;
};

}  // namespace sweepgrid
