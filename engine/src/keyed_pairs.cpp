#include <sweepgrid/engine/keyed_pairs.hpp>

#include <algorithm>

namespace sweepgrid {

KeyedPairs::KeyedPairs(const KeyTable& keys, const void* list) : keys_(keys) {
  const KeyType& type = keys.type();
  for (std::size_t i = 0; i < type.list_size(list); ++i)
    entries_.push_back({type.first(list, i), type.second(list, i)});
}

KeyedPairs::KeyedPairs(const KeyTable& keys, std::span<const PairKey> pairs) : keys_(keys) {
  for (const PairKey pair : pairs) {
    const void* const a = keys.key(pair.lower());
    const void* const b = keys.key(pair.upper());
    entries_.push_back(keys.type().less(b, a) ? Entry{b, a} : Entry{a, b});
  }
  std::sort(entries_.begin(), entries_.end(), [this](const Entry& a, const Entry& b) { return less(a, b); });
}

bool KeyedPairs::less(const Entry& a, const Entry& b) const {
  const KeyType& type = keys_.type();
  if (type.less(a.first, b.first)) return true;
  if (type.less(b.first, a.first)) return false;
  return type.less(a.second, b.second);
}

std::size_t KeyedPairs::first_unordered() const {
  const auto unordered = std::adjacent_find(entries_.begin(), entries_.end(),
                                            [this](const Entry& a, const Entry& b) { return !less(a, b); });
  return static_cast<std::size_t>(unordered - entries_.begin());
}

bool KeyedPairs::contains(const Entry& pair) const {
  return std::binary_search(entries_.begin(), entries_.end(), pair,
                            [this](const Entry& a, const Entry& b) { return less(a, b); });
}

std::string KeyedPairs::describe(std::size_t i) const {
  std::string text = "(";
  text += keys_.describe(entries_[i].first);
  text += ", ";
  text += keys_.describe(entries_[i].second);
  return text += ")";
}

}  // namespace sweepgrid
