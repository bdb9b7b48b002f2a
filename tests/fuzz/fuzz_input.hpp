#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace sweepgrid::fuzz {

/// The bytes of a fuzzer, taken one after another. Behind their end all are 0, so every input is a whole program.
class Input {
 public:
  explicit Input(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  [[nodiscard]] bool empty() const { return bytes_.empty(); }

  std::uint8_t byte() {
    if (bytes_.empty()) return 0;
    const std::uint8_t first = bytes_.front();
    bytes_ = bytes_.subspan(1);
    return first;
  }
  /// In [0, bound); `bound` is at most 256.
  std::size_t below(std::size_t bound) { return byte() % bound; }

  /// What was not taken yet, as text.
  [[nodiscard]] std::string rest() const { return {bytes_.begin(), bytes_.end()}; }

 private:
  std::span<const std::uint8_t> bytes_;
};

}  // namespace sweepgrid::fuzz
