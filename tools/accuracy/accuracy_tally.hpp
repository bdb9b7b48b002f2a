#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <unordered_map>
#include <vector>

#include "accuracy/scene_pair.hpp"

namespace sweepgrid::accuracy {

/// How many steps too late (positive) or too early (negative) events were, with the number of events for each.
struct DelayCounts {
  std::map<std::int64_t, std::uint64_t> events;  ///< by delay

  [[nodiscard]] std::uint64_t count() const;
  [[nodiscard]] std::uint64_t off_time() const;  ///< of them, those whose delay is not 0
  /// Mean of the delays' magnitudes; 0 without events.
  [[nodiscard]] double mean() const;
  /// The delay of the greatest magnitude; of two, the late one. 0 without events.
  [[nodiscard]] std::int64_t most() const;

  friend bool operator==(const DelayCounts&, const DelayCounts&) = default;
};

/// What a method's pairs are worth beside a truth. Pairs are counted once in every step in which they are there.
struct Accuracy {
  std::uint64_t steps = 0;
  std::uint64_t true_pairs = 0;
  std::uint64_t reported_pairs = 0;
  std::uint64_t missed_pairs = 0;  ///< true, not reported
  std::uint64_t extra_pairs = 0;   ///< reported, not true

  /// A contact is a stay of a pair: the steps from its begin to its end. A reported contact answers a true one when
  /// they are there in the same step, and each has one answer at most: the first.
  std::uint64_t true_contacts = 0;
  std::uint64_t reported_contacts = 0;
  std::uint64_t answered_contacts = 0;
  DelayCounts begins;  ///< of answered contacts
  DelayCounts ends;    ///< of answered contacts whose both ends were seen

  /// Begins of a pair that had begun, and ended, within the last `flicker_steps` steps.
  std::uint64_t true_flicker = 0;
  std::uint64_t reported_flicker = 0;

  /// Part of the true pairs that was reported, and part of the reported that was true; 1 where there are none.
  [[nodiscard]] double recall() const;
  [[nodiscard]] double precision() const;
  [[nodiscard]] bool exact() const { return missed_pairs == 0 && extra_pairs == 0; }

  friend bool operator==(const Accuracy&, const Accuracy&) = default;
};

/// Compares, step by step, what a method reports with what is true.
class AccuracyTally {
 public:
  explicit AccuracyTally(std::uint64_t flicker_steps = 5) : flicker_steps_(flicker_steps) {}

  /// The next step's pairs; both lists sorted and without duplicates. O(pairs).
  void step(const std::vector<ScenePair>& truth, const std::vector<ScenePair>& reported);

  [[nodiscard]] const Accuracy& result() const { return result_; }

 private:
  struct PairHash {
    std::size_t operator()(const ScenePair& pair) const {
      return static_cast<std::size_t>((pair.first * 0x9e3779b97f4a7c15U) ^ (pair.second + (pair.first << 17)));
    }
  };
  // The present stay of a pair on one side, or the latest.
  struct Stay {
    bool there = false;
    bool ever = false;
    bool answered = false;
    std::uint64_t begin = 0;
  };
  // Both sides of a pair, and the ends of the two stays that answer each other: one such couple at most is open.
  struct History {
    Stay truth;
    Stay reported;
    bool open = false;
    std::optional<std::uint64_t> truth_end;
    std::optional<std::uint64_t> reported_end;
  };

  void begin(Stay& stay, std::uint64_t& contacts, std::uint64_t& flicker) const;
  void end(History& history, Stay& stay, std::optional<std::uint64_t>& its_end);
  void relate(History& history);
  void forget_old();

  std::uint64_t flicker_steps_;
  std::uint64_t step_ = 0;
  std::vector<ScenePair> last_truth_;
  std::vector<ScenePair> last_reported_;
  std::unordered_map<ScenePair, History, PairHash> histories_;
  Accuracy result_;
};

/// The pairs that a method's events lead to.
class PairsOfEvents {
 public:
  /// Applies the ends, then the begins; both sorted. Returns all pairs, sorted.
  const std::vector<ScenePair>& step(const Events<SceneKey>& events);

 private:
  std::vector<ScenePair> pairs_;
};

}  // namespace sweepgrid::accuracy
