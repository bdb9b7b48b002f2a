#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <new>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <sweepgrid/engine/events.hpp>
#include <sweepgrid/engine/key_order.hpp>

namespace sweepgrid {

/// What a type of keys can do, as functions on addresses, so that the engine need not be compiled for each type of
/// keys. Every function may throw what the type's own operation throws, but for `destroy`.
struct KeyType {
  /// Integers in the order of their values need no call of `less`.
  enum class Kind : std::uint8_t { kUnsigned, kSigned, kOther };

  Kind kind;
  std::size_t size;
  std::size_t alignment;
  void (*copy)(void* place, const void* key);  ///< constructs a copy in raw memory
  void (*destroy)(void* key);                  ///< null when there is nothing to do
  std::uint64_t (*hash)(const void* key);
  bool (*same)(const void* a, const void* b);
  bool (*less)(const void* a, const void* b);
  std::string (*print)(const void* key);  ///< empty when the type cannot be printed

  // Lists of events: std::vector<Pair<Key>>.
  std::size_t pair_size;
  bool sizable;                                  ///< resize() makes pairs, and write() may then be called in any order
  void (*resize)(void* list, std::size_t size);  ///< if not sizable: clears, and makes room for so many
  void (*write)(void* list, std::size_t place, const void* first, const void* second);
  void (*shrink)(void* list);  ///< gives back the memory that is not used
  std::size_t (*list_size)(const void* list);
  std::size_t (*capacity)(const void* list);
  void* (*data)(void* list);
  const void* (*first)(const void* list, std::size_t place);
  const void* (*second)(const void* list, std::size_t place);
};

namespace key_type {

/// What `print` writes to the stream.
[[nodiscard]] std::string printed(void (*print)(std::ostream& out, const void* key), const void* key);

/// KeyType's functions for one type.
template <class Key, class Hash, class Order>
struct Of {
  using List = std::vector<Pair<Key>>;

  static const Key& key(const void* address) { return *static_cast<const Key*>(address); }
  static List& list(void* address) { return *static_cast<List*>(address); }
  static const List& list(const void* address) { return *static_cast<const List*>(address); }

  static void copy(void* place, const void* from) { ::new (place) Key(key(from)); }
  static void destroy(void* address) { static_cast<Key*>(address)->~Key(); }
  static std::uint64_t hash(const void* address) { return static_cast<std::uint64_t>(Hash{}(key(address))); }
  static bool same(const void* a, const void* b) { return static_cast<bool>(key(a) == key(b)); }
  static bool less(const void* a, const void* b) { return static_cast<bool>(Order{}(key(a), key(b))); }

  static std::string print(const void* address) {
    if constexpr (std::is_arithmetic_v<Key> && !std::same_as<Key, char> && !std::same_as<Key, bool>) {
      return std::to_string(key(address));
    } else if constexpr (std::convertible_to<const Key&, std::string_view>) {
      return std::string(static_cast<std::string_view>(key(address)));
    } else if constexpr (requires(std::ostream & out) { out << key(address); }) {
      return printed([](std::ostream& out, const void* printed) { out << key(printed); }, address);
    } else {
      return {};
    }
  }

  static constexpr bool kSizable = std::default_initializable<Key> && std::is_copy_assignable_v<Key>;
  static void resize(void* pairs, std::size_t size) {
    if constexpr (kSizable) {
      list(pairs).resize(size);
    } else {
      list(pairs).clear();
      list(pairs).reserve(size);
    }
  }
  static void write(void* pairs, std::size_t place, const void* first, const void* second) {
    if constexpr (kSizable) {
      Pair<Key>& pair = list(pairs)[place];
      pair.first = key(first);
      pair.second = key(second);
    } else {
      list(pairs).push_back(Pair<Key>{key(first), key(second)});
    }
  }
  static void shrink(void* pairs) { list(pairs).shrink_to_fit(); }
  static std::size_t list_size(const void* pairs) { return list(pairs).size(); }
  static std::size_t capacity(const void* pairs) { return list(pairs).capacity(); }
  static void* data(void* pairs) { return list(pairs).data(); }
  static const void* first(const void* pairs, std::size_t place) { return &list(pairs)[place].first; }
  static const void* second(const void* pairs, std::size_t place) { return &list(pairs)[place].second; }

  static constexpr KeyType::Kind kind() {
    if constexpr (std::integral<Key> && sizeof(Key) <= sizeof(std::uint64_t) && kByValue<Key, Order>) {
      static_assert(sizeof(Pair<Key>) == 2 * sizeof(Key));
      return std::is_signed_v<Key> ? KeyType::Kind::kSigned : KeyType::Kind::kUnsigned;
    } else {
      return KeyType::Kind::kOther;
    }
  }
};

/// The one KeyType of a type.
template <class Key, class Hash, class Order>
[[nodiscard]] const KeyType& of() {
  static_assert(std::is_object_v<Key> && std::copy_constructible<Key>,
                "sweepgrid: a key must be copyable, for events hold copies of it");
  static_assert(
      requires(const Key& a, const Key& b) {
        { a == b } -> std::convertible_to<bool>;
      },
      "sweepgrid: a key needs operator==");
  static_assert(
      requires(const Key& key) {
        { Hash{}(key) } -> std::convertible_to<std::size_t>;
      },
      "sweepgrid: the key has no std::hash; name a hash as Engine's fourth template argument");
  using Type = Of<Key, Hash, Order>;
  static constexpr KeyType kType{Type::kind(),
                                 sizeof(Key),
                                 alignof(Key),
                                 Type::copy,
                                 std::is_trivially_destructible_v<Key> ? nullptr : Type::destroy,
                                 Type::hash,
                                 Type::same,
                                 Type::less,
                                 Type::print,
                                 sizeof(Pair<Key>),
                                 Type::kSizable,
                                 Type::resize,
                                 Type::write,
                                 Type::shrink,
                                 Type::list_size,
                                 Type::capacity,
                                 Type::data,
                                 Type::first,
                                 Type::second};
  return kType;
}

}  // namespace key_type

}  // namespace sweepgrid
