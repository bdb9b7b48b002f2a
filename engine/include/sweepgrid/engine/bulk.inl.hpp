#pragma once

#include <algorithm>
#include <array>
#include <stdexcept>

#include <sweepgrid/engine/keyed_engine.hpp>

// Calls for many objects.
namespace sweepgrid {

namespace bulk {

/// Items from which on starting workers pays; measured.
inline constexpr std::size_t kParallel = 16384;
/// Items from which on keys go into their table shard by shard; measured.
inline constexpr std::size_t kByShard = 4096;

template <class Share>
[[nodiscard]] std::vector<Share> shares_of(const ObjectPartition& partition) {
  std::vector<Share> shares(partition.parts());
  for (std::size_t i = 0; i < shares.size(); ++i) shares[i].items = partition.part(i);
  return shares;
}

template <class Share>
[[nodiscard]] std::vector<Share> shares_of(std::size_t items) {
  using Chunks = ItemPartition<std::uint32_t>;
  std::vector<Share> shares(Chunks::chunks(items));
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const auto [first, end] = Chunks::chunk(i, items);
    shares[i].items = Items(first, end - first);
  }
  return shares;
}

template <class Share>
[[nodiscard]] std::optional<std::size_t> first_bad(const std::vector<Share>& shares) {
  std::optional<std::size_t> bad;
  for (const Share& share : shares) {
    if (share.checked == share.items.size()) continue;
    const std::size_t item = share.items[share.checked];
    bad = bad ? std::min(*bad, item) : item;
  }
  return bad;
}

}  // namespace bulk

template <class Scalar, int Dim>
template <class Body>
void KeyedEngine<Scalar, Dim>::Parts::for_shares(std::vector<Share>& shares, Body&& body) const {
  if (shares.size() == 1) return body(shares[0]);
  core.executor().for_each(shares.size(), [&](std::size_t share) { body(shares[share]); });
}

template <class Scalar, int Dim>
ObjectPartition KeyedEngine<Scalar, Dim>::Parts::partition_of(std::span<const Handle> objects_of_call) const {
  const std::size_t count = objects_of_call.size();
  const bool parallel = count >= bulk::kParallel && count < kNoObject && core.executor().concurrency() > 1;
  return parallel ? ObjectPartition(core.executor(), objects_of_call) : ObjectPartition(count);
}

// ---- update

template <class Scalar, int Dim>
void KeyedEngine<Scalar, Dim>::update(std::span<const Handle> objects, std::span<const BoxType> boxes) {
  Parts& p = parts("update");
  require_same_size(objects.size(), boxes.size(), "update");
  const FloatingPointMode mode;
  if (p.envelopes) return update_envelopes(objects, boxes);
  auto& table = p.objects();
  const ObjectPartition partition = p.partition_of(objects);
  auto shares = bulk::shares_of<typename Parts::Share>(partition);
  p.for_shares(shares, [&](auto& share) { table.begin_update(share, objects, boxes); });
  if (const auto bad = bulk::first_bad(shares)) {
    for (const auto& share : shares) table.cancel_update(share, objects);
    require_valid(boxes[*bad], p.keys.key(live(objects[*bad], "update")), "update");
  }
  p.for_shares(shares, [&](auto& share) { table.finish_update(share, objects, boxes); });
}

// ---- insert

template <class Scalar, int Dim>
std::vector<Handle> KeyedEngine<Scalar, Dim>::insert(const void* keys, std::size_t count,
                                                     std::span<const BoxType> boxes) {
  Parts& p = parts("insert");
  require_same_size(count, boxes.size(), "insert");
  const FloatingPointMode mode;
  auto& table = p.objects();
  const auto ids = table.reserve(count);
  const auto key = [&](std::size_t item) { return static_cast<const std::byte*>(keys) + item * p.keys.type().size; };
  try {
    p.keys.make_room(table.bound());
    if (p.envelopes) p.envelopes->make_room(table.bound());
    std::vector<Handle> handles(count);
    const std::vector<BoxType> envelopes = p.envelopes ? envelopes_of(boxes) : std::vector<BoxType>();
    const std::span<const BoxType> stepped = p.envelopes ? envelopes : boxes;
    auto shares = bulk::shares_of<typename Parts::Share>(count);
    p.for_shares(shares, [&](auto& share) {
      table.begin_insert(share, ids, stepped, handles);
      for (std::size_t i = 0; i < share.done; ++i) {
        const std::size_t item = share.items[i];
        p.keys.store(ids[item], key(item));
        if (p.envelopes) p.envelopes->insert(handles[item], boxes[item], envelopes[item]);
      }
    });
    if (const auto bad = bulk::first_bad(shares)) require_valid(boxes[*bad], key(*bad), "insert");
    if (const auto known = p.insert_keys(ids, count)) {
      throw std::invalid_argument("sweepgrid: insert of " + p.keys.describe(key(*known)) +
                                  ": the key names a live object");
    }
    for (const auto& share : shares) table.finish_insert(share);
    return handles;
  } catch (...) {
    p.cancel_insert(ids, count);
    throw;
  }
}

// No key may be in the table.
template <class Scalar, int Dim>
void KeyedEngine<Scalar, Dim>::Parts::cancel_insert(const NewIds& ids, std::size_t count) noexcept {
  for (std::size_t item = 0; item < count; ++item) {
    keys.release(ids[item]);
    if (envelopes && ids[item] < envelopes->bound()) envelopes->cancel_insert(ids[item]);
  }
  objects().cancel_insert(ids);
}

// Returns the first item whose key is known, if there is one; then no key is in.
template <class Scalar, int Dim>
std::optional<std::size_t> KeyedEngine<Scalar, Dim>::Parts::insert_keys(const NewIds& ids, std::size_t count) {
  if (count >= bulk::kByShard) return insert_keys_by_shard(ids, count);
  std::size_t item = 0;
  const auto take_out = [&] {
    while (item > 0) keys.erase(ids[--item]);
  };
  try {
    while (item < count && keys.insert(ids[item])) ++item;
  } catch (...) {
    take_out();
    throw;
  }
  if (item == count) return std::nullopt;
  const std::size_t known = item;
  take_out();
  return known;
}

template <class Scalar, int Dim>
std::optional<std::size_t> KeyedEngine<Scalar, Dim>::Parts::insert_keys_by_shard(const NewIds& ids, std::size_t count) {
  KeyEntries entries;
  entries.assign(
      core.executor(), count, KeyTable::kShards, [&](std::size_t item) { return keys.shard_of_object(ids[item]); },
      [&](std::size_t item) { return keys.entry(ids[item], item); });
  const auto id_of = [&](std::size_t item) { return ids[item]; };
  std::array<std::size_t, KeyTable::kShards> done{};
  const auto take_out = [&] {
    for (std::size_t shard = 0; shard < KeyTable::kShards; ++shard) {
      keys.erase_shard(shard, entries.part(shard).first(done[shard]), id_of);
    }
  };
  try {
    core.executor().for_each(KeyTable::kShards, [&](std::size_t shard) {
      keys.insert_shard(shard, entries.part(shard), id_of, done[shard]);
    });
  } catch (...) {
    take_out();
    throw;
  }
  std::optional<std::size_t> known;
  for (std::size_t shard = 0; shard < KeyTable::kShards; ++shard) {
    const auto part = entries.part(shard);
    if (done[shard] < part.size()) known = std::min<std::size_t>(part[done[shard]].item, known.value_or(kNoObject));
  }
  if (known) take_out();
  return known;
}

// ---- erase

template <class Scalar, int Dim>
void KeyedEngine<Scalar, Dim>::erase(std::span<const Handle> objects) {
  Parts& p = parts("erase");
  const FloatingPointMode mode;
  auto& table = p.objects();
  const ObjectPartition partition = p.partition_of(objects);
  auto shares = bulk::shares_of<typename Parts::Share>(partition);
  const auto cancel = [&] {
    for (const auto& share : shares) table.cancel_erase(share, objects);
  };
  p.for_shares(shares, [&](auto& share) { table.begin_erase(share, objects); });
  if (const auto bad = bulk::first_bad(shares)) {
    cancel();
    const ObjectId id = live(objects[*bad], "erase");
    throw std::invalid_argument("sweepgrid: erase of " + p.keys.describe(id) + ": the call names it twice");
  }
  try {
    p.erase_keys(objects);
  } catch (...) {
    cancel();
    throw;
  }
  for (const auto& share : shares) {
    table.finish_erase(share);
    if (!p.envelopes) continue;
    for (std::size_t i = 0; i < share.items.size(); ++i) p.envelopes->erase(objects[share.items[i]].index);
  }
}

// Throws before it erases the first.
template <class Scalar, int Dim>
void KeyedEngine<Scalar, Dim>::Parts::erase_keys(std::span<const Handle> objects_of_call) {
  if (objects_of_call.size() < bulk::kByShard) {
    for (const Handle object : objects_of_call) keys.erase(object.index);
    return;
  }
  const auto id_of = [](std::size_t object) { return static_cast<ObjectId>(object); };
  KeyEntries entries;
  entries.assign(
      core.executor(), objects_of_call.size(), KeyTable::kShards,
      [&](std::size_t item) { return keys.shard_of_object(objects_of_call[item].index); },
      [&](std::size_t item) { return keys.entry(objects_of_call[item].index, objects_of_call[item].index); });
  core.executor().for_each(KeyTable::kShards,
                           [&](std::size_t shard) { keys.erase_shard(shard, entries.part(shard), id_of); });
}

}  // namespace sweepgrid
