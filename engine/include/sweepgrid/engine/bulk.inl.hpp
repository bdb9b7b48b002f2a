#pragma once

#include <algorithm>
#include <stdexcept>

#include <sweepgrid/engine/engine.hpp>

namespace sweepgrid {

#define SWEEPGRID_ENGINE_TEMPLATE template <class Scalar, int Dim, class Key, class Hash, class Order>
#define SWEEPGRID_ENGINE Engine<Scalar, Dim, Key, Hash, Order>

namespace bulk {

/// Items from which on starting workers pays; measured.
inline constexpr std::size_t kParallel = 16384;
/// Items from which on keys go into their table shard by shard; measured.
inline constexpr std::size_t kByShard = 4096;

}  // namespace bulk

// ---- shares

SWEEPGRID_ENGINE_TEMPLATE
template <class Body>
void SWEEPGRID_ENGINE::for_shares(std::vector<Share>& shares, Body&& body) {
  if (shares.size() == 1) return body(shares[0]);
  core_.executor().for_each(shares.size(), [&](std::size_t share) { body(shares[share]); });
}

SWEEPGRID_ENGINE_TEMPLATE
ObjectPartition SWEEPGRID_ENGINE::partition_of(std::span<const Handle> objects) const {
  const bool parallel =
      objects.size() >= bulk::kParallel && objects.size() < kNoObject && core_.executor().concurrency() > 1;
  return parallel ? ObjectPartition(core_.executor(), objects) : ObjectPartition(objects.size());
}

SWEEPGRID_ENGINE_TEMPLATE
auto SWEEPGRID_ENGINE::shares_of(const ObjectPartition& partition) -> std::vector<Share> {
  std::vector<Share> shares(partition.parts());
  for (std::size_t i = 0; i < shares.size(); ++i) shares[i].items = partition.part(i);
  return shares;
}

SWEEPGRID_ENGINE_TEMPLATE
auto SWEEPGRID_ENGINE::shares_of(std::size_t items) -> std::vector<Share> {
  std::vector<Share> shares(KeyEntries::chunks(items));
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const auto [first, end] = KeyEntries::chunk(i, items);
    shares[i].items = Items(first, end - first);
  }
  return shares;
}

SWEEPGRID_ENGINE_TEMPLATE
std::optional<std::size_t> SWEEPGRID_ENGINE::first_bad(const std::vector<Share>& shares) {
  std::optional<std::size_t> bad;
  for (const Share& share : shares) {
    if (share.checked == share.items.size()) continue;
    const std::size_t item = share.items[share.checked];
    bad = bad ? std::min(*bad, item) : item;
  }
  return bad;
}

// ---- update

SWEEPGRID_ENGINE_TEMPLATE
void SWEEPGRID_ENGINE::update(std::span<const Handle> objects, std::span<const BoxType> boxes) {
  require_same_size(objects.size(), boxes.size(), "update");
  if (envelopes_) return update_envelopes(objects, boxes);
  Objects& table = core_.objects();
  const ObjectPartition partition = partition_of(objects);
  std::vector<Share> shares = shares_of(partition);
  for_shares(shares, [&](Share& share) { table.begin_update(share, objects, boxes); });
  if (const auto bad = first_bad(shares)) {
    for (const Share& share : shares) table.cancel_update(share, objects);
    require_valid(boxes[*bad], keys_.key(live(objects[*bad], "update")), "update");
  }
  for_shares(shares, [&](Share& share) { table.finish_update(share, objects, boxes); });
}

// ---- insert

SWEEPGRID_ENGINE_TEMPLATE
std::vector<Handle> SWEEPGRID_ENGINE::insert(std::span<const Key> keys, std::span<const BoxType> boxes) {
  require_same_size(keys.size(), boxes.size(), "insert");
  const NewIds ids = core_.objects().reserve(keys.size());
  try {
    if (!envelopes_) return insert(keys, boxes, ids);
    const std::vector<BoxType> envelopes = envelopes_of(boxes);
    std::vector<Handle> handles = insert(keys, envelopes, ids);
    store_envelopes(handles, boxes, envelopes);
    return handles;
  } catch (...) {
    core_.objects().cancel_insert(ids);
    throw;
  }
}

SWEEPGRID_ENGINE_TEMPLATE
std::vector<Handle> SWEEPGRID_ENGINE::insert(std::span<const Key> keys, std::span<const BoxType> boxes,
                                             const NewIds& ids) {
  Objects& table = core_.objects();
  keys_.make_room(table.bound());
  std::vector<Handle> handles(keys.size());
  const auto hashes = std::make_unique_for_overwrite<std::uint32_t[]>(keys.size());
  std::vector<Share> shares = shares_of(keys.size());
  for_shares(shares, [&](Share& share) {
    table.begin_insert(share, ids, boxes, handles);
    for (std::size_t i = 0; i < share.done; ++i) {
      const std::size_t item = share.items[i];
      hashes[item] = keys_.store(ids[item], keys[item]);
    }
  });
  if (const auto bad = first_bad(shares)) require_valid(boxes[*bad], keys[*bad], "insert");
  if (const auto known = insert_keys(ids, {hashes.get(), keys.size()})) {
    throw std::invalid_argument("sweepgrid: insert of " + describe(keys[*known]) + ": the key names a live object");
  }
  for (const Share& share : shares) table.finish_insert(share);
  return handles;
}

// Returns the first item whose key is known, if there is one; then no key is in.
SWEEPGRID_ENGINE_TEMPLATE
std::optional<std::size_t> SWEEPGRID_ENGINE::insert_keys(const NewIds& ids, std::span<const std::uint32_t> hashes) {
  if (hashes.size() >= bulk::kByShard) return insert_keys_by_shard(ids, hashes);
  std::size_t item = 0;
  const auto take_back = [&] {
    while (item > 0) keys_.erase(ids[--item]);
  };
  try {
    while (item < hashes.size() && keys_.insert(hashes[item], ids[item])) ++item;
  } catch (...) {
    take_back();
    throw;
  }
  if (item == hashes.size()) return std::nullopt;
  const std::size_t known = item;
  take_back();
  return known;
}

SWEEPGRID_ENGINE_TEMPLATE
std::optional<std::size_t> SWEEPGRID_ENGINE::insert_keys_by_shard(const NewIds& ids,
                                                                  std::span<const std::uint32_t> hashes) {
  KeyEntries entries;
  entries.assign(
      core_.executor(), hashes.size(), Keys::kShards, [&](std::size_t item) { return Keys::shard_of(hashes[item]); },
      [&](std::size_t item) { return Keys::entry(hashes[item], item); });
  const auto id_of = [&](std::size_t item) { return ids[item]; };
  std::array<std::size_t, Keys::kShards> done{};
  const auto take_back = [&] {
    for (std::size_t shard = 0; shard < Keys::kShards; ++shard) {
      keys_.erase_shard(shard, entries.part(shard).first(done[shard]), id_of);
    }
  };
  try {
    core_.executor().for_each(
        Keys::kShards, [&](std::size_t shard) { keys_.insert_shard(shard, entries.part(shard), id_of, done[shard]); });
  } catch (...) {
    take_back();
    throw;
  }
  std::optional<std::size_t> known;
  for (std::size_t shard = 0; shard < Keys::kShards; ++shard) {
    const auto part = entries.part(shard);
    if (done[shard] < part.size()) known = std::min<std::size_t>(part[done[shard]].item, known.value_or(kNoObject));
  }
  if (known) take_back();
  return known;
}

// ---- erase

SWEEPGRID_ENGINE_TEMPLATE
void SWEEPGRID_ENGINE::erase(std::span<const Handle> objects) {
  Objects& table = core_.objects();
  const ObjectPartition partition = partition_of(objects);
  std::vector<Share> shares = shares_of(partition);
  const auto take_back = [&] {
    for (const Share& share : shares) table.cancel_erase(share, objects);
  };
  for_shares(shares, [&](Share& share) { table.begin_erase(share, objects); });
  if (const auto bad = first_bad(shares)) {
    take_back();
    const ObjectId id = live(objects[*bad], "erase");
    throw std::invalid_argument("sweepgrid: erase of " + describe(keys_.key(id)) + ": the call names it twice");
  }
  try {
    erase_keys(objects);
  } catch (...) {
    take_back();
    throw;
  }
  for (const Share& share : shares) table.finish_erase(share);
  if (envelopes_) for_shares(shares, [&](const Share& share) { erase_envelopes(share, objects); });
}

// Throws before it erases the first.
SWEEPGRID_ENGINE_TEMPLATE
void SWEEPGRID_ENGINE::erase_keys(std::span<const Handle> objects) {
  if (objects.size() < bulk::kByShard) {
    for (const Handle object : objects) keys_.erase(object.index);
    return;
  }
  const auto hashes = std::make_unique_for_overwrite<std::uint32_t[]>(objects.size());
  core_.executor().for_each(KeyEntries::chunks(objects.size()), [&](std::size_t chunk) {
    const auto [first, end] = KeyEntries::chunk(chunk, objects.size());
    for (std::size_t item = first; item < end; ++item) hashes[item] = keys_.hash(objects[item].index);
  });
  KeyEntries entries;
  entries.assign(
      core_.executor(), objects.size(), Keys::kShards, [&](std::size_t item) { return Keys::shard_of(hashes[item]); },
      [&](std::size_t item) { return Keys::entry(hashes[item], objects[item].index); });
  core_.executor().for_each(Keys::kShards, [&](std::size_t shard) {
    keys_.erase_shard(shard, entries.part(shard), [](std::size_t object) { return static_cast<ObjectId>(object); });
  });
}

#undef SWEEPGRID_ENGINE_TEMPLATE
#undef SWEEPGRID_ENGINE

}  // namespace sweepgrid
