#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "op_script.hpp"
#include "sap_oracle.hpp"

/// Plays scripts to cells under the oracle's eyes, and shrinks what goes wrong.
namespace sweepgrid::oracle {

template <class Scalar, int Dim>
using CellFactory = std::function<std::unique_ptr<SweepAndPrune<Scalar, Dim>>()>;

/// The first thing that goes wrong when a new cell hears `history`, and how many drains it took; empty if nothing does.
template <class Scalar, int Dim>
std::pair<std::string, std::size_t> replay(const CellFactory<Scalar, Dim>& make, const History<Scalar, Dim>& history) {
  const auto cell = make();
  CellOracle<Scalar, Dim> oracle;
  for (std::size_t step = 0; step < history.size(); ++step) {
    std::string wrong = oracle.drain(*cell, history[step]);
    if (!wrong.empty()) return {std::move(wrong), step + 1};
  }
  return {{}, history.size()};
}

/// Drops objects and updates from a failing history as long as it still fails.
template <class Scalar, int Dim>
History<Scalar, Dim> shrunk(const CellFactory<Scalar, Dim>& make, History<Scalar, Dim> history) {
  int budget = 3000;
  const auto keep_if_failing = [&](History<Scalar, Dim> candidate) {
    if (--budget < 0) return;
    std::erase_if(candidate, [](const auto& drain) { return drain.empty(); });
    const auto [wrong, drains] = replay(make, candidate);
    if (wrong.empty()) return;
    candidate.resize(drains);
    history = std::move(candidate);
  };
  const auto without = [&](auto unwanted) {
    History<Scalar, Dim> candidate = history;
    for (auto& drain : candidate) std::erase_if(drain, unwanted);
    return candidate;
  };
  for (std::size_t size_before = 0; history.size() != size_before && budget > 0;) {
    size_before = history.size();
    std::vector<ObjectId> objects;
    for (const auto& drain : history) {
      for (const auto& op : drain) objects.push_back(op.object);
    }
    std::sort(objects.begin(), objects.end());
    objects.erase(std::unique(objects.begin(), objects.end()), objects.end());
    // Whole ranges first, single objects last.
    for (std::size_t run = objects.size() / 2 + 1; run > 0; run /= 2) {
      for (std::size_t first = 0; first < objects.size(); first += run) {
        const std::vector<ObjectId> range(
            objects.begin() + static_cast<std::ptrdiff_t>(first),
            objects.begin() + static_cast<std::ptrdiff_t>(std::min(first + run, objects.size())));
        keep_if_failing(
            without([&](const auto& op) { return std::binary_search(range.begin(), range.end(), op.object); }));
      }
    }
    for (std::size_t step = history.size(); step-- > 0;) {
      for (std::size_t index = step < history.size() ? history[step].size() : 0; index-- > 0;) {
        if (step >= history.size() || index >= history[step].size()) continue;
        if (history[step][index].kind != OpKind::kUpdate) continue;
        History<Scalar, Dim> candidate = history;
        candidate[step].erase(candidate[step].begin() + static_cast<std::ptrdiff_t>(index));
        keep_if_failing(std::move(candidate));
      }
    }
  }
  return history;
}

template <class Scalar, int Dim>
std::string to_text(const History<Scalar, Dim>& history) {
  std::ostringstream text;
  text.precision(std::numeric_limits<Scalar>::max_digits10);
  for (std::size_t step = 0; step < history.size(); ++step) {
    text << "  drain " << step << ":\n";
    for (const auto& op : history[step]) {
      constexpr std::array<const char*, 3> kKinds{"insert", "update", "erase"};
      text << "    " << kKinds[static_cast<std::size_t>(op.kind)] << ' ' << op.object;
      for (int axis = 0; axis < Dim && op.kind != OpKind::kErase; ++axis) {
        text << " [" << op.box.min[axis] << ", " << op.box.max[axis] << ']';
      }
      text << '\n';
    }
  }
  return text.str();
}

/// Plays the script of `regime` and `seed` to a new cell. Empty if all is well; otherwise what went wrong, where, and
/// a shrunk history that goes wrong too.
template <class Scalar, int Dim>
std::string play(const CellFactory<Scalar, Dim>& make, const Regime& regime, std::uint64_t seed) {
  OpScript<Scalar, Dim> script(regime, seed);
  const auto cell = make();
  CellOracle<Scalar, Dim> oracle;
  History<Scalar, Dim> history;
  for (int step = 0; step < regime.drains; ++step) {
    history.push_back(script.next());
    const std::string wrong = oracle.drain(*cell, history.back());
    if (wrong.empty()) continue;
    std::ostringstream text;
    text << "regime " << regime.name << ", seed " << seed << ", step " << step << ": " << wrong << '\n';
    const History<Scalar, Dim> small = shrunk(make, history);
    text << "shrunk to: " << replay(make, small).first << '\n' << to_text<Scalar, Dim>(small);
    return text.str();
  }
  return {};
}

}  // namespace sweepgrid::oracle
