#include "scenes/lammps_source.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "scenes/scene_error.hpp"

namespace sweepgrid {
namespace {

constexpr std::uint64_t kAtomsToReserve = 1 << 16;  // a wrong count must not cost more

// The rest of `line` behind `item`, or nothing. There may be more blanks, or tabs, than in `item`.
std::optional<std::string_view> after_item(std::string_view line, std::string_view item) {
  line = trim(line);
  for (const char c : item) {
    if (!line.starts_with(c) && (c != ' ' || !line.starts_with('\t'))) return std::nullopt;
    line.remove_prefix(c == ' ' ? line.find_first_not_of(kBlanks) : 1);
  }
  if (!line.empty() && kBlanks.find(line.front()) == std::string_view::npos) return std::nullopt;
  return trim(line);
}

}  // namespace

LammpsSource::LammpsSource(std::unique_ptr<ByteStream> content, const SceneOptions& options)
    : content_(std::move(content)), options_(options), first_(Frame()) {
  Header header;
  if (!read_frame_from_file(*first_, header)) throw SceneError(fmt::format("{}: no frame", content_->path()));
  info_.name = content_->path();
  info_.format = "lammps";
  info_.shapes = ShapeKind::kSpheres;
  info_.compression = content_->compression();
  if (header.cell.bounds().valid()) info_.bounds = header.cell.bounds();
  info_.details = {{"columns", columns_->description()}, {"first timestep", header.timestep}};
}

bool LammpsSource::recognises(std::string_view start) {
  const std::size_t begin = start.find_first_not_of(" \t\r\n");
  return begin != std::string_view::npos && start.substr(begin).starts_with("ITEM:");
}

bool LammpsSource::read_frame(Frame& frame) {
  if (first_) {
    frame = std::move(*first_);
    first_.reset();
    return true;
  }
  Header header;
  return read_frame_from_file(frame, header);
}

bool LammpsSource::read_frame_from_file(Frame& frame, Header& header) {
  if (!read_header(header)) return false;
  frame.keys.reserve(std::min(header.atom_count, kAtomsToReserve));
  frame.boxes.reserve(std::min(header.atom_count, kAtomsToReserve));
  for (std::uint64_t i = 0; i < header.atom_count; ++i) {
    std::string_view line;
    if (!content_->read_line(line)) {
      content_->fail_at_end_in_lines(
          fmt::format("after {} of the {} atoms of timestep {}", i, header.atom_count, header.timestep));
    }
    if (line.starts_with("ITEM:")) {
      content_->fail_at_line(fmt::format("'{}' after {} of the {} atoms of timestep {}", excerpt(line), i,
                                         header.atom_count, header.timestep));
    }
    SceneKey key = 0;
    SceneBox box;
    try {
      columns_->read_atom(line, header.cell, key, box);
    } catch (const std::invalid_argument& error) {
      const auto id = columns_->id_of(line);
      const std::string atom =
          id ? fmt::format("{}", *id) : fmt::format("number {} of {}, without an id", i + 1, header.atom_count);
      content_->fail_at_line(fmt::format("timestep {}, atom {}: {}", header.timestep, atom, error.what()));
    }
    frame.keys.push_back(key);
    frame.boxes.push_back(box);
  }
  if (const auto twice = frame.sort()) {
    content_->fail_at_line(fmt::format("timestep {}, which ends here, has id {} twice", header.timestep, *twice));
  }
  return true;
}

bool LammpsSource::read_header(Header& header) {
  std::string_view line;
  bool begun = false;
  bool has_timestep = false;
  bool has_count = false;
  bool has_bounds = false;
  while (true) {
    if (!content_->read_line(line)) {
      if (begun) content_->fail_at_end_in_lines("before 'ITEM: ATOMS'");
      if (!content_->damage().empty()) content_->fail_at_end_in_lines("behind this line");
      return false;
    }
    // Empty lines between frames and at the end of the file do no harm.
    if (!begun && trim(line).empty()) continue;
    begun = true;
    if (const auto names = after_item(line, "ITEM: ATOMS")) {
      if (!has_timestep || !has_count || !has_bounds) {
        content_->fail_at_line("'ITEM: ATOMS' before the timestep, the number of atoms and the box bounds");
      }
      read_columns(*names, header.cell);
      return true;
    }
    if (after_item(line, "ITEM: TIMESTEP")) {
      if (has_timestep) content_->fail_at_line("a second 'ITEM: TIMESTEP' before 'ITEM: ATOMS'");
      header.timestep = excerpt(trim(need_line("the timestep")));
      has_timestep = true;
    } else if (after_item(line, "ITEM: NUMBER OF ATOMS")) {
      try {
        header.atom_count = parse_unsigned(trim(need_line("the number of atoms")), "the number of atoms");
      } catch (const std::invalid_argument& error) {
        content_->fail_at_line(error.what());
      }
      has_count = true;
    } else if (const auto kind = after_item(line, "ITEM: BOX BOUNDS")) {
      header.cell = read_cell(*kind);
      has_bounds = true;
    } else if (after_item(line, "ITEM: UNITS") || after_item(line, "ITEM: TIME")) {
      need_line("the unit or time");
    } else {
      content_->fail_at_line(fmt::format("an 'ITEM:' of a dump expected, but there is '{}'", excerpt(line)));
    }
  }
}

LammpsCell LammpsSource::read_cell(std::string_view words_behind_item) {
  const LammpsCell::Kind kind = LammpsCell::kind_of(words_behind_item);
  const std::size_t expected = LammpsCell::width_of(kind);
  std::vector<std::string_view> words;
  std::array<std::array<double, 4>, 3> numbers{};
  for (auto& line : numbers) {
    split_words(need_line("the box bounds"), words);
    if (words.size() != expected) {
      content_->fail_at_line(fmt::format("{} box bounds where {} are expected", words.size(), expected));
    }
    try {
      for (std::size_t i = 0; i < expected; ++i) line[i] = parse_finite(words[i], LammpsCell::name_of(kind, i));
    } catch (const std::invalid_argument& error) {
      content_->fail_at_line(error.what());
    }
  }
  return {kind, numbers};
}

void LammpsSource::read_columns(std::string_view names, const LammpsCell& cell) {
  try {
    if (!columns_ || columns_->names() != names) columns_.emplace(names, options_.diameter, options_.largest);
    columns_->check_cell(cell);
  } catch (const std::invalid_argument& error) {
    content_->fail_at_line(error.what());
  }
}

std::string_view LammpsSource::need_line(std::string_view what) {
  std::string_view line;
  if (!content_->read_line(line)) content_->fail_at_end_in_lines(fmt::format("before {}", what));
  return line;
}

}  // namespace sweepgrid
