#pragma once

#include <algorithm>
#include <bit>
#include <limits>
#include <span>
#include <type_traits>

#include <sweepgrid/engine/scene_sweep.hpp>
#include <sweepgrid/sap/ordered_box.hpp>
#include <sweepgrid/sap/prefetch.hpp>

namespace sweepgrid {

namespace scene_sweep {

/// Sweeps after which rows are fitted anew: soon after a fit that could not know how crowded the scene is.
inline constexpr std::size_t kFirstFitSweeps = 2;
inline constexpr std::size_t kFitSweeps = 128;
/// So many times as many meetings as usual, or entries, show that the scene is another one by now.
inline constexpr double kManyMeetings = 8;
inline constexpr double kManyEntries = 2;
/// Smaller scenes sweep themselves in less time than it would take to look at them first.
inline constexpr std::size_t kGlancedAt = 1024;
/// Entries that a worker's cache holds with all that a part needs.
inline constexpr std::size_t kPartEntries = 16384;

}  // namespace scene_sweep

// ---- fitting rows

// Calls `use` with the object's box, if it had one before the step or has one after it.
template <class Scalar, int Dim>
template <class Use>
void SceneSweep<Scalar, Dim>::with_box(Side side, ObjectId object, Use&& use) const {
  const std::uint8_t state = objects_.state(object);
  if (state == 0 || (state & (side == Side::kBefore ? Objects::kInserted : Objects::kErased)) != 0) return;
  const Record& record = objects_.record(object);
  use(values_of(side == Side::kBefore && (state & Objects::kQueued) != 0 ? record.before : record.box));
}

template <class Scalar, int Dim>
auto SceneSweep<Scalar, Dim>::fitted(Side side) const -> Bins {
  std::array<ObjectId, Bins::Scene::kSample> chosen;
  std::array<std::array<Value, 2 * Dim>, Bins::Scene::kSample> sample;
  std::size_t sampled = 0;
  for (const ObjectId object : objects_.sample(chosen)) {
    with_box(side, object, [&](const auto& box) { sample[sampled++] = box; });
  }
  const std::span<const std::array<Value, 2 * Dim>> found(sample);
  typename Bins::Scene scene(found.first(sampled));
  for (ObjectId object = 0; object < objects_.bound(); ++object) {
    with_box(side, object, [&](const auto& box) { scene.add(box.data()); });
  }
  return Bins::fit(scene, crowding_);
}

template <class Scalar, int Dim>
void SceneSweep<Scalar, Dim>::fit() {
  rows_ = fitted(Side::kAfter);
  steps_left_ = steps_left_ == 0 && fitted_objects_ != 0 ? scene_sweep::kFitSweeps : scene_sweep::kFirstFitSweeps;
  fitted_objects_ = objects_.size();
  usual_entries_ = usual_meetings_ = 0;
}

// Judged by who of a few objects would meet whom.
template <class Scalar, int Dim>
bool SceneSweep<Scalar, Dim>::crowded(Side side) const {
  constexpr std::size_t kGlances = 64;
  constexpr std::size_t kTooFew = 8;  // may be chance
  struct Seen {
    std::uint32_t row;
    std::int32_t low;
    std::int32_t high;
  };
  const std::uint64_t bound = objects_.bound();
  if (objects_.size() < scene_sweep::kGlancedAt) return false;
  std::array<Seen, kGlances> seen;
  std::size_t count = 0;
  for (std::uint64_t i = 0; i < kGlances; ++i) {
    with_box(side, static_cast<ObjectId>(Objects::any_of_run(i, kGlances, bound)), [&](const auto& box) {
      const auto span = rows_.span(box.data(), box.data());
      const int along = rows_.cut().along;
      seen[count++] = {rows_.first_row(span), span.low[along], span.high[along]};
    });
  }
  const auto by_place = [](const Seen& a, const Seen& b) { return a.row != b.row ? a.row < b.row : a.low < b.low; };
  std::sort(seen.begin(), seen.begin() + static_cast<std::ptrdiff_t>(count), by_place);
  std::size_t meetings = 0;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = i + 1; k < count && seen[k].row == seen[i].row && seen[k].low <= seen[i].high; ++k) ++meetings;
  }
  if (meetings < kTooFew) return false;
  const double scale = static_cast<double>(objects_.size()) / static_cast<double>(count);
  return static_cast<double>(meetings) * scale * scale >
         scene_sweep::kManyMeetings * std::max(usual_meetings_, rows_.expected_meetings() * crowding_);
}

// Boxes have left the place for which rows were fitted, or have grown out of them: one cut cannot do justice to all
// that they were and all that they are.
template <class Scalar, int Dim>
void SceneSweep<Scalar, Dim>::part_sides() {
  rows_before_ = fitted(Side::kBefore);
  fit();
  apart_ = true;
}

template <class Scalar, int Dim>
auto SceneSweep<Scalar, Dim>::values_of(const BoxType& box) -> std::array<Value, 2 * Dim> {
  std::array<Value, 2 * Dim> values;
  for (int axis = 0; axis < Dim; ++axis) {
    values[axis] = static_cast<Value>(box.min[axis]);
    values[Dim + axis] = static_cast<Value>(box.max[axis]);
  }
  return values;
}

// ---- bin: objects into rows, by block

template <class Scalar, int Dim>
void SceneSweep<Scalar, Dim>::plan_bin(std::size_t workers, std::vector<std::uint64_t>& costs) {
  const std::size_t objects = objects_.size();
  apart_ = false;
  most_entries_ = kEndless;
  if (steps_left_ == 0 || objects > 2 * fitted_objects_ || 2 * objects < fitted_objects_) {
    fit();
    if (crowded(Side::kBefore)) part_sides();
  } else if (crowded(Side::kAfter) || crowded(Side::kBefore)) {
    part_sides();
  } else {
    const double usual = std::max(usual_entries_, rows_.expected_entries());
    most_entries_ = static_cast<std::size_t>(scene_sweep::kManyEntries * usual) + 4096;
  }
  --steps_left_;
  start_bins(workers, costs);
  scratch_.restart();
  while (scratch_.size() < workers) scratch_.add();
}

template <class Scalar, int Dim>
void SceneSweep<Scalar, Dim>::start_bins(std::size_t workers, std::vector<std::uint64_t>& costs) {
  const std::size_t wanted = std::max(objects_.size() / scene_sweep::kPartEntries, workers == 1 ? 1 : 4 * workers);
  part_shift_ = std::bit_width((rows_.rows() - 1) / wanted);
  const auto parts_of = [&](const Bins& rows) { return ((rows.rows() - 1) >> part_shift_) + 1; };
  parts_after_ = parts_of(rows_);
  const std::size_t parts = parts_after_ + (apart_ ? parts_of(rows_before_) : 0);
  const std::size_t granules = objects_.granules();
  const std::size_t blocks = workers == 1 ? 1 : std::min<std::size_t>((granules + 3) / 4, 3 * workers);
  bins_.restart();
  for (std::size_t b = 0; b < blocks; ++b) {
    Bin& bin = bins_.add();
    bin.parts.resize(parts);
    bin.restart();
    bin.first_granule = static_cast<std::uint32_t>(b * granules / blocks);
    bin.last_granule = static_cast<std::uint32_t>((b + 1) * granules / blocks);
    costs.push_back(bin.last_granule - bin.first_granule);
  }
  sweeps_.restart();
}

/// Puts a block of objects into rows, as many at once as the kernel takes.
template <class Scalar, int Dim>
class SceneSweep<Scalar, Dim>::Binner {
 public:
  Binner(const SceneSweep& sweep, Bin& bin, Scratch& scratch)
      : rows_(sweep.rows_),
        rows_before_(sweep.rows_before_),
        apart_(sweep.apart_),
        parts_after_(sweep.parts_after_),
        part_shift_(sweep.part_shift_),
        most_entries_(sweep.most_entries_),
        bin_(bin),
        batch_(scratch.batch) {}

  // Sees to it that the record holds what the object was before the step and what it is after it.
  void add(ObjectId object, std::uint8_t state, Record& record) {
    const std::uint8_t queued = state & Objects::kQueued;
    bool was = true;
    bool is = true;
    if (queued == Objects::kUpdated) [[likely]] {
      ++bin_.counters.updates;
    } else if (queued == 0) {
      if (!Objects::same_bits(record.before, record.box)) record.before = record.box;
    } else {
      was = (queued & Objects::kInserted) == 0;
      is = (queued & Objects::kErased) == 0;
      if (!is) bin_.retired.items.push_back(object);
      if (!was && !is) return;
      ++(is ? bin_.counters.inserts : bin_.counters.erases);
    }
    batch_.objects[count_] = object;
    if constexpr (kDirect) {
      // Nothing else is to be read of the side that there is not.
      if (!was) record.before.min[0] = kNone;
      if (!is) record.box.min[0] = kNone;
      batch_.boxes[count_++] = values(record);
    } else {
      Value* const both = batch_.copies + kValues * count_;
      for (int axis = 0; axis < Dim; ++axis) {
        both[axis] = static_cast<Value>(record.box.min[axis]);
        both[Dim + axis] = static_cast<Value>(record.box.max[axis]);
        both[kOld + axis] = static_cast<Value>(record.before.min[axis]);
        both[kOld + Dim + axis] = static_cast<Value>(record.before.max[axis]);
      }
      if (!was) both[kOld] = kNone;
      if (!is) both[0] = kNone;
      batch_.boxes[count_++] = both;
    }
    if (count_ == Kernel::kPlaced) flush();
  }

  void flush() {
    if (apart_) return put_sides();
    const std::size_t far =
        Kernel::place(batch_.boxes, batch_.objects, count_, rows_.cut(), batch_.entries, batch_.far);
    const auto& entries = batch_.entries;
    auto* const parts = bin_.parts.data();
    const std::uint32_t in_part = (1U << part_shift_) - 1;
    const std::uint32_t bins = rows_.bins();
    constexpr std::uint32_t kMark = kDirect ? 0 : sweep_tasks::marks::kCopied;
    if (kDirect && bin_.parts.size() == 1) {  // nothing to be told apart
      auto& items = parts[0].entries.items;
      const std::size_t before = items.size();
      items.resize(before + entries.count);
      sweep_tasks::Entry* const to = items.data() + before;
      for (std::size_t i = 0; i < entries.count; ++i) {
        to[i] = {entries.row[i] * bins + entries.bin[i], entries.object[i], entries.reach[i]};
      }
    } else {
      for (std::size_t i = 0; i < entries.count; ++i) {
        auto& part = parts[entries.row[i] >> part_shift_];
        part.entries.items.push_back(
            {(entries.row[i] & in_part) * bins + entries.bin[i], entries.object[i], entries.reach[i] | kMark});
        if constexpr (!kDirect) copy_into(part, batch_.boxes[place_of(entries.object[i])]);
      }
    }
    entries_ += entries.count;
    for (std::size_t i = 0; i < far; ++i) put_far(batch_.objects[batch_.far[i]], batch_.boxes[batch_.far[i]]);
    bin_.overflown = entries_ > most_entries_;
    count_ = 0;
  }

 private:
  using Kernel = RowSweep<Value, Dim>;
  static constexpr Value kNone = std::numeric_limits<Value>::quiet_NaN();

  // Among those that are placed at once, which stand in the order of ids.
  [[nodiscard]] std::size_t place_of(ObjectId object) const {
    return static_cast<std::size_t>(std::lower_bound(batch_.objects, batch_.objects + count_, object) - batch_.objects);
  }
  static void copy_into(sweep_tasks::Arrivals<Value>& part, const Value* both) {
    part.copies.items.insert(part.copies.items.end(), both, both + kValues);
  }

  // An object whose boxes are far apart would be in all rows between them: they are members of their own.
  void put_far(ObjectId object, const Value* both) {
    if (!has_side(both + kOld)) return put(rows_, object, both, both, 0, both);
    if (!has_side(both)) return put(rows_, object, both + kOld, both + kOld, 0, both);
    bool apart = false;
    for (int axis = 0; axis < Dim; ++axis) {
      apart = apart || both[axis] > both[kOld + Dim + axis] || both[kOld + axis] > both[Dim + axis];
    }
    if (!apart) return put(rows_, object, both, both + kOld, 0, both);
    put_side(rows_, object, both, 0);
    put_side(rows_, object, both, kOld);
  }

  void put_sides() {
    for (std::uint32_t i = 0; i < count_; ++i) {
      const Value* const both = batch_.boxes[i];
      if (has_side(both)) put_side(rows_, batch_.objects[i], both, 0);
      if (has_side(both + kOld)) put_side(rows_before_, batch_.objects[i], both, kOld);
    }
    count_ = 0;
  }

  static bool has_side(const Value* side) { return side[0] == side[0]; }  // not NaN

  // `side`: 0 or kOld.
  void put_side(const Bins& rows, ObjectId object, const Value* both, std::size_t side) {
    std::array<Value, kValues> half;
    std::copy_n(both, kValues, half.begin());
    half[kOld - side] = kNone;
    const Value* const box = half.data() + side;
    put(rows, object, box, box,
        sweep_tasks::marks::kCopied | (side == 0 ? sweep_tasks::marks::kBorn : sweep_tasks::marks::kGone), half.data());
  }

  void put(const Bins& rows, ObjectId object, const Value* a, const Value* b, std::uint32_t marks, const Value* both) {
    if constexpr (!kDirect) marks |= sweep_tasks::marks::kCopied;
    const auto span = rows.span(a, b);
    const int along = rows.cut().along;
    const auto low = static_cast<std::uint32_t>(span.low[along]);
    const std::uint32_t reach = static_cast<std::uint32_t>(span.high[along]) << row_marks::kBits | marks;
    const std::uint32_t in_part = (1U << part_shift_) - 1;
    entries_ += rows.rows_of(span);
    if (entries_ > most_entries_) return;
    const auto parts = bin_.parts.begin() + (&rows == &rows_ ? 0 : static_cast<std::ptrdiff_t>(parts_after_));
    rows.for_each_row(span, [&](std::uint32_t row, std::uint32_t earlier) {
      auto& part = parts[row >> part_shift_];
      part.entries.items.push_back({(row & in_part) * rows.bins() + low, object, reach | earlier});
      if ((marks & sweep_tasks::marks::kCopied) != 0) copy_into(part, both);
    });
  }

  const Bins& rows_;
  const Bins& rows_before_;
  bool apart_;
  std::size_t parts_after_;
  int part_shift_;
  std::size_t most_entries_;
  std::size_t entries_ = 0;
  Bin& bin_;
  typename Scratch::Batch& batch_;
  std::uint32_t count_ = 0;
};

template <class Scalar, int Dim>
void SceneSweep<Scalar, Dim>::bin(std::size_t block, std::size_t worker) {
  Bin& bin = bins_[block];
  Binner binner(*this, bin, scratch_[worker]);
  for (std::uint32_t granule = bin.first_granule; granule < bin.last_granule && !bin.overflown; ++granule) {
    const ObjectId first = granule * Objects::kGranule;
    const std::uint32_t count = std::min(objects_.bound() - first, Objects::kGranule);
    // A granule is contiguous.
    const std::uint8_t* const states = &objects_.state(first);
    Record* const records = &objects_.record(first);
    for (std::uint32_t i = 0; i < count; ++i) {
      if (states[i] != 0) binner.add(first + i, states[i], records[i]);
    }
  }
  binner.flush();
  if (bin.overflown) return;
  for (const auto& part : bin.parts) bin.counters.cell_ops += part.entries.items.size();
}

// There are far more entries than usual.
template <class Scalar, int Dim>
void SceneSweep<Scalar, Dim>::bin_anew(std::size_t worker) {
  part_sides();
  most_entries_ = kEndless;
  std::vector<std::uint64_t> unused;
  start_bins(scratch_.size(), unused);
  for (std::size_t block = 0; block < bins_.size(); ++block) bin(block, worker);
}

// ---- sweep: rows to events, by part

template <class Scalar, int Dim>
void SceneSweep<Scalar, Dim>::plan_sweep(std::size_t worker, std::vector<std::uint64_t>& costs) {
  const auto entries = [this] {
    std::uint64_t total = 0;
    for (const Bin& bin : bins_) total += bin.overflown ? most_entries_ + 1 : bin.counters.cell_ops;
    return total;
  };
  // Judged by the sum, which does not depend on how objects are cut into blocks.
  if (entries() > most_entries_) bin_anew(worker);
  budget_.charge(entries() * kEntryBytes);
  for (std::size_t part = 0; part < bins_[0].parts.size(); ++part) {
    std::uint64_t cost = 1;
    for (const Bin& bin : bins_) cost += bin.parts[part].entries.items.size();
    sweeps_.add().restart();
    costs.push_back(cost);
  }
}

// The members of a part by bin. Returns how many there are.
template <class Scalar, int Dim>
std::size_t SceneSweep<Scalar, Dim>::sort(std::size_t part, Scratch& scratch) const {
  std::vector<std::uint32_t>& bins = scratch.bins.items;
  bins.assign((std::size_t{rows_of(part).bins()} << part_shift_) + 1, 0);
  std::size_t total = 0;
  for (const Bin& bin : bins_) {
    for (const auto& entry : bin.parts[part].entries.items) ++bins[entry.bin + 1];
    total += bin.parts[part].entries.items.size();
  }
  for (std::size_t i = 1; i < bins.size(); ++i) bins[i] += bins[i - 1];
  scratch.members.items.resize(total + RowSweep<Value, Dim>::kPadding);
  std::fill_n(scratch.members.items.begin() + static_cast<std::ptrdiff_t>(total), RowSweep<Value, Dim>::kPadding,
              Member{kBoxOfNobody<Value>.data(), 0, 0});
  Member* const members = scratch.members.items.data();
  for (const Bin& bin : bins_) {
    const Value* copy = bin.parts[part].copies.items.data();
    for (const auto& entry : bin.parts[part].entries.items) {
      Member& member = members[bins[entry.bin]++];
      member.object = entry.object;
      member.reach = entry.reach;
      if (!kDirect || (entry.reach & sweep_tasks::marks::kCopied) != 0) [[unlikely]] {
        member.box = copy;
        copy += kValues;
      } else {
        member.box = values(objects_.record(entry.object));
      }
    }
  }
  return total;
}

/// Turns what a row finds into events.
template <class Scalar, int Dim>
class SceneSweep<Scalar, Dim>::Sink final : public SweepSink {
 public:
  Sink(const SceneSweep& sweep, std::span<const Member> members, Sweep& found)
      : sweep_(sweep), members_(members), found_(found) {}

  void take(std::span<const SweepHit> hits) override {
    const std::size_t before = found_.begins.items.size() + found_.ends.items.size();
    for (const SweepHit& hit : hits) {
      const Member& a = members_[hit.member];
      for (unsigned lanes = hit.changed; lanes != 0; lanes &= lanes - 1) {
        const int lane = std::countr_zero(lanes);
        const Member& b = members_[hit.first + static_cast<unsigned>(lane)];
        if ((a.reach & b.reach & row_marks::kEarlier) != 0) continue;  // another row reports it
        bool begins = (hit.overlap >> lane & 1) != 0;
        const std::uint32_t halves = (a.reach | b.reach) & (sweep_tasks::marks::kGone | sweep_tasks::marks::kBorn);
        if (kSweepsRounded<Scalar> || halves != 0) [[unlikely]] {
          const auto [was, is] = sweep_.overlaps(a.object, b.object);
          if (was == is || (halves & (is ? sweep_tasks::marks::kGone : sweep_tasks::marks::kBorn)) != 0) continue;
          begins = is;
        }
        (begins ? found_.begins : found_.ends).items.emplace_back(a.object, b.object);
      }
    }
    const std::size_t after = found_.begins.items.size() + found_.ends.items.size();
    sweep_.budget_.charge((after - before) * sweep_.event_bytes_);
  }

 private:
  const SceneSweep& sweep_;
  std::span<const Member> members_;
  Sweep& found_;
};

// Before and after the step, by the exact boxes.
template <class Scalar, int Dim>
auto SceneSweep<Scalar, Dim>::overlaps(ObjectId a, ObjectId b) const -> WasIs {
  using Ordered = OrderedBox<Scalar, Dim>;
  const Record& first = objects_.record(a);
  const Record& second = objects_.record(b);
  const std::uint8_t states = objects_.state(a) | objects_.state(b);
  return {(states & Objects::kInserted) == 0 && Ordered(first.before).overlaps(Ordered(second.before)),
          (states & Objects::kErased) == 0 && Ordered(first.box).overlaps(Ordered(second.box))};
}

template <class Scalar, int Dim>
void SceneSweep<Scalar, Dim>::sweep(std::size_t part, std::size_t worker) {
  Scratch& scratch = scratch_[worker];
  Sweep& found = sweeps_[part];
  const std::size_t total = sort(part, scratch);
  const std::span<const Member> members(scratch.members.items.data(), total);
  const std::uint32_t* bins = scratch.bins.items.data();
  const std::uint32_t in_row = rows_of(part).bins();
  std::uint32_t first = 0;
  for (std::size_t row = 0; first < total; ++row, bins += in_row) {
    const std::uint32_t end = bins[in_row - 1];
    const std::size_t ahead = std::min<std::size_t>(total, std::size_t{end} + (end - first) + 8);
    for (std::size_t next = end; next < ahead; ++next) prefetch(members[next].box);
    if (end - first > 1) {
      Sink sink(*this, members.subspan(first, end - first), found);
      found.meetings += RowSweep<Value, Dim>::sweep(&members[first], end - first, bins, first, kSweepsRounded<Scalar>,
                                                    scratch.sweep, sink);
    }
    first = end;
  }
}

// ---- after the stages

template <class Scalar, int Dim>
void SceneSweep<Scalar, Dim>::reserve() {
  std::size_t retired = 0;
  for (const Bin& bin : bins_) retired += bin.retired.items.size();
  objects_.reserve_free(retired);
}

template <class Scalar, int Dim>
StepCounters SceneSweep<Scalar, Dim>::commit() noexcept {
  StepCounters counters;
  counters.cells_drained = rows_.rows() + (apart_ ? rows_before_.rows() : 0);
  for (Bin& bin : bins_) counters += bin.counters;
  std::uint64_t meetings = 0;
  for (Sweep& sweep : sweeps_) meetings += sweep.meetings;
  counters.cells.box_tests = 2 * meetings;
  for (std::uint32_t granule = 0; granule < objects_.granules(); ++granule) objects_.settle(granule);
  for (Bin& bin : bins_) {
    for (const ObjectId object : bin.retired.items) objects_.retire(object);
    objects_.free_ids(bin.retired.items);
    bin.note_step();
    bin.restart();  // lest a step that fails frees ids again
  }
  objects_.nothing_queued();
  const auto entries = static_cast<double>(counters.cell_ops);
  if (!apart_) {
    crowding_ = rows_.crowding(entries, static_cast<double>(meetings));
    if (usual_entries_ == 0) {
      usual_entries_ = entries;
      usual_meetings_ = static_cast<double>(meetings);
    }
    const auto cost = [](double in_rows, double met) { return Bins::kEntryCost * in_rows + Bins::kMeetingCost * met; };
    // The scene has changed since it was fitted.
    if (cost(entries, static_cast<double>(meetings)) > 1.5 * cost(usual_entries_, usual_meetings_)) steps_left_ = 0;
  }
  bins_.finish();
  for (Sweep& sweep : sweeps_) sweep.note_step();
  sweeps_.finish();
  for (Scratch& scratch : scratch_) scratch.note_step();
  scratch_.finish();
  return counters;
}

template <class Scalar, int Dim>
void SceneSweep<Scalar, Dim>::cancel() noexcept {
  for (Bin& bin : bins_) bin.restart();
  bins_ = {};
  sweeps_ = {};
}

template <class Scalar, int Dim>
void SceneSweep<Scalar, Dim>::pass(std::size_t steps) {
  bins_.pass(steps);
  sweeps_.pass(steps);
  scratch_.pass(steps);
}

}  // namespace sweepgrid
