#include <sweepgrid/engine/key_table.hpp>

#include <ostream>
#include <sstream>

namespace sweepgrid {

namespace key_type {

std::string printed(void (*print)(std::ostream& out, const void* key), const void* key) {
  std::ostringstream out;
  print(out, key);
  return out.str();
}

}  // namespace key_type

KeyTable::~KeyTable() {
  for (std::uint64_t object = 0; object < held_.size(); ++object) release(static_cast<ObjectId>(object));
}

std::string KeyTable::describe(const void* key) const {
  const std::string text = type_.print(key);
  return text.empty() ? "object with a key that cannot be printed" : "object " + text;
}

ObjectId KeyTable::find(const void* key) const {
  const std::uint32_t hash = hash_of(key);
  const Shard& shard = shards_[shard_of(hash)];
  const std::lock_guard lock(shard.mutex);
  return shard.buckets.find(tag_of(hash), is_key(key));
}

bool KeyTable::insert(ObjectId object) {
  Shard& shard = shards_[shard_of_object(object)];
  const std::lock_guard lock(shard.mutex);
  shard.buckets.reserve(1);
  return shard.buckets.insert(tag_of(hashes_[object]), is_key(key(object)), [object] { return object; });
}

void KeyTable::erase(ObjectId object) {
  const std::uint32_t hash = hashes_[object];
  Shard& shard = shards_[shard_of(hash)];
  const std::lock_guard lock(shard.mutex);
  shard.buckets.erase(tag_of(hash), object);
  shard.buckets.shrink();
}

void KeyTable::make_room(std::uint64_t bound) {
  if (bound <= hashes_.size()) return;
  constexpr std::uint64_t kAhead = 256;  // so that the lock is not taken for each
  const std::lock_guard growth(growth_);
  const std::uint64_t size = bound + kAhead - bound % kAhead;
  keys_.grow(size);
  if (type_.destroy != nullptr) {
    const std::uint64_t known = held_.size();
    held_.grow(size);
    for (std::uint64_t object = known; object < size; ++object) held_[static_cast<ObjectId>(object)] = 0;
  }
  hashes_.grow(size);  // last: its size is what is asked for first
}

void KeyTable::store(ObjectId object, const void* key, std::uint32_t hash) {
  type_.copy(keys_.address(object), key);
  hashes_[object] = hash;
  if (type_.destroy != nullptr) held_[object] = 1;
}

void KeyTable::release(ObjectId object) {
  if (object >= held_.size() || held_[object] == 0) return;
  held_[object] = 0;
  type_.destroy(keys_.address(object));
}

void KeyTable::trim(std::uint64_t bound) {
  keys_.shrink(bound);
  hashes_.shrink(bound);
  held_.shrink(bound);
}

std::size_t KeyTable::bytes() const {
  std::size_t total = keys_.bytes() + hashes_.bytes() + held_.bytes();
  for (const Shard& shard : shards_) total += shard.buckets.bytes();
  return total;
}

// std::hash of an integer is often the integer itself; all its bits must take part in all bits of the result.
std::uint32_t KeyTable::hash_of(const void* key) const {
  std::uint64_t h = type_.hash(key);
  h = (h ^ h >> 33) * 0xff51afd7ed558ccdU;
  h = (h ^ h >> 33) * 0xc4ceb9fe1a85ec53U;
  return static_cast<std::uint32_t>(h >> 32);
}

}  // namespace sweepgrid
