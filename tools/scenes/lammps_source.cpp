#include "scenes/lammps_source.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "scenes/scene_error.hpp"

namespace sweepgrid {
namespace {

constexpr std::uint64_t kAtomsToReserve = 1 << 20;  // a wrong count must not cost more

// The rest of `line` behind `item`, or nothing.
std::optional<std::string_view> after_item(std::string_view line, std::string_view item) {
  if (!line.starts_with(item)) return std::nullopt;
  line.remove_prefix(item.size());
  if (!line.empty() && line.front() != ' ') return std::nullopt;
  return line;
}

}  // namespace

LammpsSource::LammpsSource(std::unique_ptr<ByteStream> content, std::optional<double> diameter)
    : content_(std::move(content)), diameter_(diameter), first_(Frame()) {
  Header header;
  if (!read_frame_from_file(*first_, header)) throw SceneError(fmt::format("{}: no frame", content_->path()));
  info_.name = content_->path();
  info_.format = "lammps";
  info_.shapes = ShapeKind::kSpheres;
  info_.compression = content_->compression();
  SceneBox world(header.bounds.low, header.bounds.high);
  if (world.valid()) info_.bounds = world;
  info_.details = {{"columns", columns_->description()}, {"first timestep", header.timestep}};
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
      throw SceneError(fmt::format("{}: line {}: the file ends after {} of the {} atoms of timestep {}",
                                   content_->path(), content_->line(), i, header.atom_count, header.timestep));
    }
    if (line.starts_with("ITEM:")) {
      content_->fail_at_line(
          fmt::format("'{}' after {} of the {} atoms of timestep {}", line, i, header.atom_count, header.timestep));
    }
    SceneKey key = 0;
    SceneBox box;
    try {
      columns_->read_atom(line, header.bounds, key, box);
    } catch (const std::invalid_argument& error) {
      content_->fail_at_line(error.what());
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
      if (!begun) return false;
      content_->fail_at_line("the file ends before 'ITEM: ATOMS'");
    }
    // Empty lines between frames and at the end of the file do no harm.
    if (!begun && line.find_first_not_of(" \t") == std::string_view::npos) continue;
    begun = true;
    if (const auto names = after_item(line, "ITEM: ATOMS")) {
      if (!has_timestep || !has_count || !has_bounds) {
        content_->fail_at_line("'ITEM: ATOMS' before the timestep, the number of atoms and the box bounds");
      }
      read_columns(*names);
      return true;
    }
    if (after_item(line, "ITEM: TIMESTEP")) {
      if (has_timestep) content_->fail_at_line("a second 'ITEM: TIMESTEP' before 'ITEM: ATOMS'");
      header.timestep = need_line("the timestep");
      has_timestep = true;
    } else if (after_item(line, "ITEM: NUMBER OF ATOMS")) {
      try {
        header.atom_count = parse_unsigned(need_line("the number of atoms"), "the number of atoms");
      } catch (const std::invalid_argument& error) {
        content_->fail_at_line(error.what());
      }
      has_count = true;
    } else if (const auto kind = after_item(line, "ITEM: BOX BOUNDS")) {
      read_bounds(*kind, header.bounds);
      has_bounds = true;
    } else if (after_item(line, "ITEM: UNITS") || after_item(line, "ITEM: TIME")) {
      need_line("the unit or time");
    } else {
      content_->fail_at_line(fmt::format("an 'ITEM:' of a dump expected, but there is '{}'", line.substr(0, 60)));
    }
  }
}

void LammpsSource::read_bounds(std::string_view kind, LammpsBounds& bounds) {
  if (kind.find("abc") != std::string_view::npos) content_->fail_at_line("general triclinic boxes are not supported");
  bounds.tilted = kind.find("xy") != std::string_view::npos;
  std::vector<std::string_view> words;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    split_words(need_line("the box bounds"), words);
    const std::size_t expected = bounds.tilted ? 3 : 2;
    if (words.size() != expected) {
      content_->fail_at_line(fmt::format("{} box bounds where {} are expected", words.size(), expected));
    }
    try {
      bounds.low[axis] = parse_finite(words[0], "the low bound");
      bounds.high[axis] = parse_finite(words[1], "the high bound");
    } catch (const std::invalid_argument& error) {
      content_->fail_at_line(error.what());
    }
  }
}

void LammpsSource::read_columns(std::string_view names) {
  if (columns_ && columns_->names() == names) return;
  try {
    columns_.emplace(names, diameter_);
  } catch (const std::invalid_argument& error) {
    content_->fail_at_line(error.what());
  }
}

std::string_view LammpsSource::need_line(std::string_view what) {
  std::string_view line;
  if (!content_->read_line(line)) content_->fail_at_line(fmt::format("the file ends before {}", what));
  return line;
}

}  // namespace sweepgrid
