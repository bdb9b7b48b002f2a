#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <sweepgrid/engine/config.hpp>
#include <sweepgrid/engine/envelope_options.hpp>
#include <sweepgrid/engine/handle.hpp>
#include <sweepgrid/engine/key_type.hpp>
#include <sweepgrid/engine/stats.hpp>
#include <sweepgrid/engine/step_status.hpp>
#include <sweepgrid/sap/box.hpp>
#include <sweepgrid/sap/ids.hpp>
#include <sweepgrid/scheduler/task_trace.hpp>

namespace sweepgrid {

/// What Engine forwards to: all of it, with keys as addresses of what a KeyType describes. So it is compiled once for
/// each scalar and dimension, whatever the client's keys and compiler flags are. Not part of the public interface: what
/// each call does is said in engine.hpp.
template <class Scalar, int Dim>
class KeyedEngine {
 public:
  using BoxType = Box<Scalar, Dim>;
  using Displacement = std::array<double, static_cast<std::size_t>(Dim)>;
  /// Addresses of two std::vector<Pair<Key>>, which step() writes to.
  struct EventLists {
    void* ends;
    void* begins;
  };

  /// `type` and the lists must outlive it.
  KeyedEngine(Config config, const KeyType& type, EventLists events);
  ~KeyedEngine();
  KeyedEngine(KeyedEngine&& other) noexcept;
  KeyedEngine& operator=(KeyedEngine&& other) noexcept;

  Handle insert(const void* key, const BoxType& box);
  Handle insert(const void* key, const BoxType& box, double margin);
  /// `keys`: as many in an array.
  std::vector<Handle> insert(const void* keys, std::size_t count, std::span<const BoxType> boxes);

  void update(Handle object, const BoxType& box);
  void update(const void* key, const BoxType& box);
  void update(std::span<const Handle> objects, std::span<const BoxType> boxes);
  void update(Handle object, const BoxType& box, const Displacement& ahead);
  void set_margin(Handle object, double margin);

  void erase(Handle object);
  void erase(const void* key);
  void erase(std::span<const Handle> objects);

  void step();
  [[nodiscard]] StepStatus status() const;
  void set_step_bytes(std::optional<std::uint64_t> bytes);
  /// Writes to a std::vector<Pair<Key>>.
  void pairs(void* list) const;

  [[nodiscard]] std::size_t size() const;
  [[nodiscard]] bool contains(const void* key) const;
  [[nodiscard]] std::optional<Handle> find(const void* key) const;
  [[nodiscard]] BoxType box(Handle object) const;
  [[nodiscard]] BoxType envelope(Handle object) const;
  [[nodiscard]] const void* key(Handle object) const;

  void validate() const;
  [[nodiscard]] Stats stats() const;
  [[nodiscard]] EnvelopeReport envelope_report() const;
  void record_tasks(bool on);
  [[nodiscard]] const TaskTrace& tasks() const;
  [[nodiscard]] std::vector<std::string> stage_names() const;

 private:
  struct Parts;

  // Refuses a call while step() runs. `call` is the name that errors tell.
  [[nodiscard]] Parts& parts(const char* call) const;
  [[noreturn]] static void refuse_during_step(const char* call);

  [[nodiscard]] ObjectId live(Handle object, const char* call) const;
  [[nodiscard]] ObjectId live(const void* key, const char* call) const;
  void require_valid(const BoxType& box, const void* key, const char* call) const;
  void require_margin(const void* key, const char* call, double margin) const;
  static void require_same_size(std::size_t objects, std::size_t boxes, const char* call);

  Handle insert_one(const void* key, const BoxType& box, double margin);
  bool step_core();
  void release_keys(std::size_t freed_before);
  void trim_to_objects();
  void validate_events() const;

  // With Config::envelope, in envelope_calls.inl.hpp.
  [[nodiscard]] std::vector<BoxType> envelopes_of(std::span<const BoxType> boxes) const;
  void update_envelopes(std::span<const Handle> objects, std::span<const BoxType> boxes);
  bool step_with_envelopes();
  void add_envelope_stats(Stats& stats) const;
  void validate_envelopes() const;

  std::unique_ptr<Parts> parts_;
};

extern template class KeyedEngine<float, 2>;
extern template class KeyedEngine<float, 3>;
extern template class KeyedEngine<double, 2>;
extern template class KeyedEngine<double, 3>;
extern template class KeyedEngine<std::int32_t, 2>;
extern template class KeyedEngine<std::int32_t, 3>;
extern template class KeyedEngine<std::int16_t, 2>;
extern template class KeyedEngine<std::int16_t, 3>;

}  // namespace sweepgrid
