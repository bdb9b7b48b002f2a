#pragma once

#include <memory>
#include <optional>
#include <string_view>

#include "scenes/byte_stream.hpp"
#include "scenes/frame_source.hpp"
#include "scenes/lammps_columns.hpp"

namespace sweepgrid {

/// Reads a LAMMPS text dump. An object is an atom, its box is centre -+ radius in double; an id that appears is an
/// insert, one that is gone an erase. Atoms may come in any order, columns too, and both may change between frames.
class LammpsSource : public FrameSource {
 public:
  /// `diameter`: of all atoms of a dump without a column for it.
  LammpsSource(std::unique_ptr<ByteStream> content, std::optional<double> diameter);

  [[nodiscard]] static bool recognises(std::string_view start) { return start.starts_with("ITEM:"); }

  [[nodiscard]] const SceneInfo& info() const override { return info_; }

 protected:
  bool read_frame(Frame& frame) override;

 private:
  // What stands before the atoms of a frame.
  struct Header {
    std::string timestep;
    std::uint64_t atom_count = 0;
    LammpsBounds bounds;
  };

  // False at the end of the file.
  bool read_header(Header& header);
  bool read_frame_from_file(Frame& frame, Header& header);
  void read_bounds(std::string_view kind, LammpsBounds& bounds);
  void read_columns(std::string_view names);
  std::string_view need_line(std::string_view what);

  std::unique_ptr<ByteStream> content_;
  std::optional<double> diameter_;
  SceneInfo info_;
  std::optional<LammpsColumns> columns_;
  std::optional<Frame> first_;  // read ahead, so that a file that is no dump is noticed when it is opened
};

}  // namespace sweepgrid
