#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace sweepgrid::study {

/// What must be the same for two points to belong to one study.
struct Fingerprint {
  std::string study;
  nlohmann::json parameters;  ///< all that shapes the points
  std::string program;        ///< commit and a digest of the executable: a commit alone misses local changes
  std::string machine;

  /// Of the running program on this machine.
  [[nodiscard]] static Fingerprint here(std::string study, nlohmann::json parameters);

  [[nodiscard]] nlohmann::json json() const;
  /// 16 hexadecimal digits: FNV-1a over json(). The same on every machine.
  [[nodiscard]] std::string digest() const;
};

/// The fields in which two results of Fingerprint::json() differ, for a message: "program (a, now b), machine (...)".
[[nodiscard]] std::string differences(const nlohmann::json& then, const nlohmann::json& now);

}  // namespace sweepgrid::study
