// A small oracle test of all kinds of cell, quick to compile: `run` builds it anew for every planted bug.
// Exits with 1 and prints the name of each broken invariant when it notices something.

#include <iostream>
#include <string>

#include <sweepgrid/sap/cell_kind.inl.hpp>
#include <sweepgrid/sap/invariant.hpp>

#include "op_script.hpp"
#include "sap_oracle.hpp"
#include "visit_script.hpp"

namespace sweepgrid {
namespace {

/// Prints what the oracle found, and beside it what validate() says: one sees from outside that deltas are wrong, the
/// other names the invariant.
int report(const SweepAndPrune<float, 2>& cell, const std::string& finding) {
  std::cout << (finding.starts_with("exception") ? "oracle: " : "S4: ") << finding << '\n';
  try {
    cell.validate();
  } catch (const InvariantError& error) {
    std::cout << error.what() << '\n';
  }
  return 1;
}

int probe(const CellOptions& options) {
  for (const oracle::Regime& regime : oracle::kRegimes) {
    if (regime.population > 100) continue;
    oracle::OpScript<float, 2> script(regime, 1);
    oracle::CellOracle<float, 2> oracle;
    const auto cell = make_cell<float, 2>(options);
    for (int step = 0; step < regime.drains; ++step) {
      const std::string finding = oracle.drain(*cell, script.next());
      if (finding.empty()) continue;
      std::cout << "kind " << static_cast<int>(options.kind) << ", regime " << regime.name << ", step " << step << '\n';
      return report(*cell, finding);
    }
  }
  for (const oracle::Regime& regime : oracle::kRegimes) {
    if (regime.population > 40) continue;
    oracle::CellOracle<float, 2> oracle;
    const auto cell = make_cell<float, 2>(options);
    const std::string finding = oracle::play_visits(*cell, oracle, regime, 1);
    if (!finding.empty()) return report(*cell, finding);
  }
  return 0;
}

}  // namespace
}  // namespace sweepgrid

int main() {
  using sweepgrid::CellKind;
  for (const sweepgrid::CellOptions& options : {sweepgrid::CellOptions{CellKind::kRows},
                                                {CellKind::kBatch},
                                                {CellKind::kSegmented, 4},
                                                {CellKind::kSegmented, 16},
                                                {CellKind::kClassic},
                                                {CellKind::kPlane}}) {
    if (sweepgrid::probe(options) != 0) return 1;
  }
  return 0;
}
