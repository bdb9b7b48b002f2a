#include <sweepgrid/engine/key_ranks.hpp>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <stdexcept>

namespace sweepgrid {
namespace {

template <class Integer>
void write_as(void* pairs, std::span<const RankPair> ranks, std::uint64_t sign) {
  auto* place = static_cast<std::byte*>(pairs);
  for (const RankPair& pair : ranks) {
    const Integer keys[2] = {static_cast<Integer>(pair.first ^ sign), static_cast<Integer>(pair.second ^ sign)};
    std::memcpy(place, keys, sizeof keys);
    place += sizeof keys;
  }
}

}  // namespace

void KeyRanks::write(void* pairs, std::span<const RankPair> ranks) const {
  switch (keys_.type().size) {
    case 1:
      return write_as<std::uint8_t>(pairs, ranks, sign_bit());
    case 2:
      return write_as<std::uint16_t>(pairs, ranks, sign_bit());
    case 4:
      return write_as<std::uint32_t>(pairs, ranks, sign_bit());
    default:
      return write_as<std::uint64_t>(pairs, ranks, sign_bit());
  }
}

void KeyRanks::ByKey::sort(std::span<ObjectId> objects) const {
  std::sort(objects.begin(), objects.end(), [this](ObjectId a, ObjectId b) { return less(a, b); });
}

void KeyRanks::reset(std::size_t shards) {
  sort_.reset(shards);
  by_rank_ = {};
  ties_.clear();
}

// First each object once, which takes no call of the client's order.
void KeyRanks::sort_shard(std::size_t index) {
  std::vector<ObjectId>& objects = sort_.shard(index);
  std::sort(objects.begin(), objects.end());
  objects.erase(std::unique(objects.begin(), objects.end()), objects.end());
  ByKey order{&keys_};
  sort_.sort_shard(index, order);
}

std::size_t KeyRanks::cut(std::size_t ranges, ObjectId bound) {
  ByKey order{&keys_};
  ranks_.grow(bound);
  const std::size_t used = sort_.cut(ranges, order);
  ties_.assign(used, {});
  by_rank_ = sort_.sorted();
  return used;
}

// Objects that do not differ in order are copies of one, for it may be in several shards; or they tie.
void KeyRanks::merge(std::size_t range) {
  ByKey order{&keys_};
  const auto [place, objects] = sort_.merge(range, order);
  for (std::size_t first = 0, end = 0; first < objects.size(); first = end) {
    end = first + 1;
    while (end < objects.size() && !order.less(objects[end - 1], objects[end])) ++end;
    const auto equals = objects.subspan(first, end - first);
    const auto [least, greatest] = std::minmax_element(equals.begin(), equals.end());
    if (*least != *greatest && ties_[range].first == kNoObject) ties_[range] = {*least, *greatest};
    for (const ObjectId object : equals) ranks_[object] = static_cast<std::uint32_t>(place + first);
  }
}

void KeyRanks::require_total() const {
  for (const Tie& tie : ties_) {
    if (tie.first == kNoObject) continue;
    throw std::invalid_argument("sweepgrid: step: the order of keys is not total: it holds " +
                                keys_.describe(tie.first) + " and " + keys_.describe(tie.second) + " to be equal");
  }
}

std::size_t KeyRanks::bytes() const { return sort_.bytes() + ranks_.bytes() + ties_.capacity() * sizeof(Tie); }

}  // namespace sweepgrid
