#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "scenes/byte_stream.hpp"
#include "scenes/frame_source.hpp"
#include "scenes/lammps_cell.hpp"
#include "scenes/lammps_columns.hpp"
#include "scenes/open_scene.hpp"

namespace sweepgrid {

/// Reads a LAMMPS text dump. An object is an atom, its box is centre -+ radius in double; an id that appears is an
/// insert, one that is gone an erase. Atoms may come in any order, columns too, and both may change between frames.
class LammpsSource : public FrameSource {
 public:
  LammpsSource(std::unique_ptr<ByteStream> content, const SceneOptions& options);

  /// Whether a file that starts so is a dump.
  [[nodiscard]] static bool recognises(std::string_view start);

  [[nodiscard]] const SceneInfo& info() const override { return info_; }

 protected:
  bool read_frame(Frame& frame) override;

 private:
  // What stands before the atoms of a frame.
  struct Header {
    std::string timestep;
    std::uint64_t atom_count = 0;
    LammpsCell cell;
  };

  // False at the end of the file.
  bool read_header(Header& header);
  bool read_frame_from_file(Frame& frame, Header& header);
  LammpsCell read_cell(std::string_view words_behind_item);
  void read_columns(std::string_view names, const LammpsCell& cell);
  std::string_view need_line(std::string_view what);

  std::unique_ptr<ByteStream> content_;
  SceneOptions options_;
  SceneInfo info_;
  std::optional<LammpsColumns> columns_;
  std::optional<Frame> first_;  // read ahead, so that a file that is no dump is noticed when it is opened
};

}  // namespace sweepgrid
