// Recordings and generators: what is read is what was written, and what is damaged is told from what is whole.

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <streambuf>
#include <string>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include "scenes/open_scene.hpp"
#include "scenes/scene_error.hpp"
#include "scenes_data/compress.hpp"
#include "scenes_data/fingerprint.hpp"
#include "scenes_data/scene_files.hpp"

namespace sweepgrid::scenes_test {
namespace {

using scene_files::bytes_failure;
using scene_files::Directory;
using scene_files::failure;
using scene_files::fingerprint;
using scene_files::Objects;
using scene_files::open_bytes;
using scene_files::play;

SceneBox cube(double x, double y, double z, double radius = 0.5) {
  return SceneBox({x - radius, y - radius, z - radius}, {x + radius, y + radius, z + radius});
}

// Three objects; one rests, one moves, one moves in the last frame only. All numbers are exact in float32 and as text.
std::vector<Objects> three_frames() {
  return {{{0, cube(0, 0, 0)}, {1, cube(1.5, -2, 3)}, {2, cube(4, 4, 4, 1.25)}},
          {{0, cube(0, 0, 0)}, {1, cube(1.75, -2, 3)}, {2, cube(4, 4, 4, 1.25)}},
          {{0, cube(0, 0, 0)}, {1, cube(2, -2, 3)}, {2, cube(-4, 4, 4.5, 1.25)}}};
}

const std::vector<std::string> kFormats = {"aabbs", "dump"};
const std::vector<std::string> kCompressions = {"none", "gzip", "xz", "zstd"};

std::string content_of(const std::string& format) {
  return format == "aabbs" ? scene_files::as_aabbs(three_frames()) : scene_files::as_dump(three_frames());
}

TEST(SceneFiles, EveryFormatInEveryCompressionGivesTheFramesWritten) {
  const Directory directory;
  for (const std::string& format : kFormats) {
    for (const std::string& compression : kCompressions) {
      SCOPED_TRACE(format + " " + compression);
      // The name tells nothing: the content does.
      const std::string path = directory.write("scene.bin", scene_files::compress(content_of(format), compression));
      const auto source = open_scene(path);
      EXPECT_EQ(source->info().compression, compression);
      EXPECT_EQ(source->info().format, format == "aabbs" ? "aabbs" : "lammps");
      EXPECT_EQ(source->info().bounds, SceneBox({-10, -10, -10}, {10, 10, 10}));
      EXPECT_EQ(play(*source), three_frames());
    }
  }
}

TEST(SceneFiles, BytesInMemoryAreReadAsAFileIs) {
  for (const std::string& format : kFormats) {
    for (const std::string& compression : kCompressions) {
      SCOPED_TRACE(format + " " + compression);
      const auto source = open_bytes(scene_files::compress(content_of(format), compression));
      EXPECT_EQ(source->info().name, "bytes");
      EXPECT_EQ(source->info().compression, compression);
      EXPECT_EQ(play(*source), three_frames());
    }
  }
}

TEST(SceneFiles, OnlyWhatChangedIsInAStep) {
  const Directory directory;
  for (const std::string& format : kFormats) {
    const auto source = open_scene(directory.write("scene", content_of(format)));
    SceneStep step;
    ASSERT_TRUE(source->next(step));
    EXPECT_EQ(step.inserted, (std::vector<SceneKey>{0, 1, 2}));
    ASSERT_TRUE(source->next(step));
    EXPECT_EQ(step.updated, (std::vector<SceneKey>{1}));
    EXPECT_TRUE(step.inserted.empty() && step.erased.empty());
    ASSERT_TRUE(source->next(step));
    EXPECT_EQ(step.updated, (std::vector<SceneKey>{1, 2}));
    EXPECT_FALSE(source->next(step));
  }
}

TEST(SceneFiles, CompressedStreamsPutTogetherAreOneFile) {
  for (const std::string compression : {"gzip", "xz", "zstd"}) {
    const std::string content = content_of("aabbs");
    const std::string file = scene_files::compress(content.substr(0, 500), compression) +
                             scene_files::compress("", compression) +
                             scene_files::compress(content.substr(500), compression);
    EXPECT_EQ(play(*open_bytes(file)), three_frames()) << compression;
  }
}

// As pzstd writes them: each frame behind a skippable one that tells its size.
std::string as_pzstd(const std::string& content, std::size_t piece) {
  std::string file;
  for (std::size_t begin = 0; begin < content.size(); begin += piece) {
    const std::string frame = scene_files::zstd(content.substr(begin, piece));
    for (const std::uint32_t value : {0x184D2A50U, 4U, static_cast<std::uint32_t>(frame.size())}) {
      scene_files::append_u32(file, value);
    }
    file += frame;
  }
  return file;
}

TEST(SceneFiles, ZstdMayBeginWithASkippableFrame) {
  for (const std::string& format : kFormats) {
    const std::string file = as_pzstd(content_of(format), 300);
    const auto source = open_bytes(file);
    EXPECT_EQ(source->info().compression, "zstd");
    EXPECT_EQ(play(*source), three_frames());
    for (std::size_t size = 0; size < file.size(); ++size) {
      EXPECT_NE(bytes_failure(file.substr(0, size)), "") << format << " cut at " << size;
    }
  }
}

TEST(SceneFiles, EveryCutOfACompressedFileIsNoticed) {
  for (const std::string& format : kFormats) {
    for (const std::string compression : {"gzip", "xz", "zstd"}) {
      const std::string part = scene_files::compress(content_of(format), compression);
      for (const std::string& whole : {part, scene_files::compress("", compression) + part}) {
        const std::size_t empty = whole.size() - part.size();
        // The cuts near the end leave all content whole and take the compressed stream's end away.
        for (std::size_t size = 0; size < whole.size(); ++size) {
          const std::string message = bytes_failure(whole.substr(0, size));
          EXPECT_TRUE(message.starts_with("bytes: ")) << format << " " << compression << " cut at " << size;
          // Once the compression is known.
          if (size >= 6 && size != empty) {
            EXPECT_NE(message.find("data are cut off"), std::string::npos) << size << ": " << message;
          }
        }
        EXPECT_NE(bytes_failure(whole + "tail"), "") << format << " " << compression;
      }
    }
  }
}

TEST(SceneFiles, FramesBeforeACutCanBeTaken) {
  const std::vector<Objects> frames = three_frames();
  for (const std::string& format : kFormats) {
    const std::string content = content_of(format);
    const std::size_t two = format == "aabbs" ? 304 + 2 * 3 * 32 : scene_files::as_dump({frames[0], frames[1]}).size();
    for (const std::string& compression : kCompressions) {
      SCOPED_TRACE(format + " " + compression);
      const auto pack = [&](const std::string& part) { return scene_files::compress(part, compression); };
      const std::string whole = pack(content.substr(0, two)) + pack(content.substr(two));
      for (const std::string& file : {whole.substr(0, whole.size() - 5), pack(content.substr(0, content.size() - 5))}) {
        const auto source = open_bytes(file);
        EXPECT_EQ(play(*source, 2), (std::vector<Objects>{frames[0], frames[1]}));
        // The end of a compressed stream may be missing behind all content.
        EXPECT_THROW(scene_files::read_to_end(*source), SceneError);
      }
    }
  }
}

TEST(SceneFiles, DamagedCompressedDataAreRefused) {
  for (const std::string compression : {"gzip", "xz", "zstd"}) {
    std::string file = scene_files::compress(content_of("dump"), compression);
    file[file.size() / 2] = static_cast<char>(~file[file.size() / 2]);
    const std::string message = bytes_failure(file);
    EXPECT_TRUE(message.starts_with("bytes: ")) << compression << ": " << message;
  }
}

TEST(SceneFiles, EveryCutOfABareFileIsNoticedUnlessItIsBetweenTheFramesOfADump) {
  for (const std::string& format : kFormats) {
    const std::string whole = content_of(format);
    std::vector<std::size_t> unnoticed;
    for (std::size_t size = 0; size < whole.size(); ++size) {
      if (bytes_failure(whole.substr(0, size)).empty()) unnoticed.push_back(size);
    }
    // A dump does not tell how many frames it has.
    std::vector<std::size_t> frame_ends;
    if (format == "dump") {
      const auto frames = three_frames();
      frame_ends.push_back(scene_files::as_dump_frame(frames[0], 0).size());
      frame_ends.push_back(frame_ends[0] + scene_files::as_dump_frame(frames[1], 100).size());
    }
    EXPECT_EQ(unnoticed, frame_ends) << format;
  }
}

// A compressed stream whose blocks hold one dump frame each, cut between two blocks: the content so far is a whole
// dump.
TEST(SceneFiles, ACutBetweenCompressedBlocksThatIsBetweenFramesIsNoticed) {
  std::string zstd = "\x28\xb5\x2f\xfd" + std::string("\0\x58", 2);  // no checksum, 2 MB window
  std::string gzip("\x1f\x8b\x08\0\0\0\0\0\0\x03", 10);
  for (std::size_t i = 0; i < 2; ++i) {
    const std::string frame = scene_files::as_dump_frame(three_frames()[i], i);
    const auto size = static_cast<std::uint32_t>(frame.size());
    for (int byte = 0; byte < 3; ++byte) zstd.push_back(static_cast<char>(size << 3 >> (8 * byte) & 0xff));
    zstd += frame;
    gzip.push_back('\0');  // a stored block, not the last
    for (const std::uint32_t half : {size, ~size}) {
      gzip.push_back(static_cast<char>(half & 0xff));
      gzip.push_back(static_cast<char>(half >> 8 & 0xff));
    }
    gzip += frame;
    EXPECT_NE(bytes_failure(zstd).find("cut off"), std::string::npos);
    EXPECT_NE(bytes_failure(gzip).find("cut off"), std::string::npos);
  }
  // The same with an empty last block is whole.
  EXPECT_EQ(bytes_failure(zstd + std::string("\x01\0\0", 3)), "");
}

// A pipe whose writer sends one byte at a time: no read gives more.
class ByteByByte : public std::streambuf {
 public:
  explicit ByteByByte(std::string bytes) : bytes_(std::move(bytes)) {}

 protected:
  int_type underflow() override {
    if (next_ == bytes_.size()) return traits_type::eof();
    setg(&bytes_[next_], &bytes_[next_], &bytes_[next_] + 1);
    ++next_;
    return traits_type::to_int_type(*gptr());
  }

 private:
  std::string bytes_;
  std::size_t next_ = 0;
};

TEST(SceneFiles, BytesMayComeOneByOne) {
  for (const std::string& format : kFormats) {
    for (const std::string& compression : kCompressions) {
      SCOPED_TRACE(format + " " + compression);
      auto bytes = std::make_unique<ByteByByte>(scene_files::compress(content_of(format), compression));
      const auto source = open_recording(std::move(bytes), "pipe");
      EXPECT_EQ(source->info().compression, compression);
      EXPECT_EQ(play(*source), three_frames());
    }
  }
}

TEST(SceneFiles, AFifoWithSlowBeginningsIsRead) {
  const Directory directory;
  for (const std::string& compression : kCompressions) {
    const std::string path = directory.path("fifo." + compression);
    ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
    std::thread writer([&] {
      const std::string bytes = scene_files::compress(content_of("aabbs"), compression);
      const int fifo = open(path.c_str(), O_WRONLY);
      for (std::size_t i = 0; i < bytes.size(); ++i) {
        // Slow enough for a reader to get the first bytes alone.
        if (i < 8) std::this_thread::sleep_for(std::chrono::milliseconds(2));
        if (write(fifo, &bytes[i], 1) != 1) break;
      }
      close(fifo);
    });
    EXPECT_EQ(play(path), three_frames()) << compression;
    writer.join();
  }
}

TEST(SceneFiles, WhatIsNoRecordingIsSaidToBeNone) {
  const Directory directory;
  std::string text;
  while (text.size() < 4000) text += "ATOM      1  CA  ALA A   1       1.000   0.500   1.000  1.00  0.00           C\n";
  std::string wide_text;
  for (const char c : text) wide_text += {c, '\0'};
  std::string binary =
      "\x7f"
      "ELF\x02\x01\x01" +
      std::string(1000, '\0');
  for (const std::string& content : {text, wide_text, binary, std::string("hello\n"), std::string("\n\n")}) {
    const std::string message = failure(directory.write("scene.pdb", content));
    EXPECT_NE(message.find("scene.pdb: not a recording"), std::string::npos) << message;
  }
  // Text is no .aabbs, whatever its name.
  EXPECT_NE(failure(directory.write("scene.aabbs", text)).find("not a recording"), std::string::npos);
}

TEST(SceneFiles, DamagedAabbsAreRefusedWithTheReason) {
  const Directory directory;
  const std::string good = content_of("aabbs");
  const auto with_float = [&](std::size_t at, float value) {
    std::string bytes;
    scene_files::append_u32(bytes, std::bit_cast<std::uint32_t>(value));
    return std::string(good).replace(at, 4, bytes);
  };
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const std::size_t second_frame = 304 + 3 * 32;
  const std::string cut = good.substr(0, 304 + 4 * 32 + 5);
  const auto with_counts = [](std::uint32_t objects, std::uint32_t steps) {
    return scene_files::aabbs_header(objects, steps);
  };
  const std::pair<std::string, std::string> cases[] = {
      {good.substr(0, 300), "byte 300: the file ends inside the 304 bytes of the .aabbs header"},
      {good + "x", "byte 592: the header tells 3 frames of 3 objects, which are 592 bytes, but the file has 593"},
      {good.substr(0, 399),
       "byte 399: the header tells 3 frames of 3 objects, which are 592 bytes, but the file has 399"},
      {cut, "byte 437: the file ends inside frame 2 of 3, at object 1"},
      {scene_files::compress(good + "x", "xz"), "byte 592: more data behind the 3 frames"},
      {scene_files::compress(cut, "zstd"), "byte 437: the file ends inside frame 2 of 3, at object 1"},
      {with_counts(0xffffffffU, 1), "byte 256: the .aabbs header tells -1 objects"},
      {with_counts(1, 0x80000000U), "byte 260: the .aabbs header tells -2147483648 steps"},
      {with_counts(0, 0x7fffffff), "byte 260: the .aabbs header tells 2147483648 frames without objects"},
      {scene_files::compress(with_counts(0, 0x7fffffff), "xz"), "2147483648 frames without objects"},
      {with_counts(0x7fffffff, 0), "byte 304: the header tells 1 frames of 2147483647 objects"},
      {with_counts(1, 0x7fffffff), "byte 304: the header tells 2147483648 frames of 1 objects"},
      // 2^64 bytes, of which 64 bits hold nothing.
      {with_counts(0x40000000, 0x1fffffff), "byte 256: the .aabbs header tells 536870912 frames of 1073741824 objects"},
      {scene_files::compress(with_counts(0x7fffffff, 0), "gzip"), "ends inside frame 1 of 1, at object 0"},
      {with_float(272, kNan), "byte 272: the world box"},
      {with_float(second_frame + 32, kNan), "byte 432: the box of object 1 in frame 2 has a NaN or min > max"},
      {with_float(second_frame + 64, 9), "byte 464: the box of object 2 in frame 2 has a NaN or min > max"},
  };
  for (const auto& [content, reason] : cases) {
    const std::string message = failure(directory.write("scene.aabbs", content));
    EXPECT_NE(message.find(reason), std::string::npos) << "expected: " << reason << "\nfound: " << message;
  }
  EXPECT_EQ(play(*open_bytes(with_counts(0, 2))), std::vector<Objects>(3));
}

TEST(SceneFiles, DamagedDumpsAreRefusedWithTheReason) {
  const Directory directory;
  const auto dump = [](const std::string& columns, const std::string& atoms) {
    return scene_files::dump_header(7, 2, columns) + atoms;
  };
  const std::string usual = "id type x y z radius";
  const std::pair<std::string, std::string> cases[] = {
      {dump(usual, "1 1 0 0 0 1\n2 1 0 0 0 nan\n"), "line 11: timestep 7, atom 2: the radius is 'nan', not finite"},
      {dump(usual, "1 1 0 inf 0 1\n2 1 0 0 0 1\n"), "line 10: timestep 7, atom 1: y is 'inf', not finite"},
      {dump(usual, "1 1 0 0 1e999 1\n2 1 0 0 0 1\n"),
       "line 10: timestep 7, atom 1: z is '1e999', out of the range of double"},
      {dump(usual, "1 1 0 0 0 -1\n2 1 0 0 0 1\n"), "line 10: timestep 7, atom 1: the radius is -1, negative"},
      {dump(usual, "1 1 0.5x 0 0 1\n2 1 0 0 0 1\n"), "line 10: timestep 7, atom 1: x is '0.5x', not a number"},
      {dump(usual, "-1 1 0 0 0 1\n2 1 0 0 0 1\n"),
       "line 10: timestep 7, atom number 1 of 2, without an id: the id is '-1'"},
      {dump(usual, "1 1 0 0 0\n2 1 0 0 0 1\n"), "line 10: timestep 7, atom 1: 5 values for the 6 columns"},
      {dump(usual, "1 1 0 0 0 1 9\n2 1 0 0 0 1\n"), "line 10: timestep 7, atom 1: 7 values for the 6 columns"},
      {dump(usual, "5 1 0 0 0 1\n5 1 0 0 0 1\n"), "line 11: timestep 7, which ends here, has id 5 twice"},
      {dump(usual, "1 1 0 0 0 1\n"), "line 10: the file ends after 1 of the 2 atoms of timestep 7"},
      {dump(usual, "1 1 0 0 0 1\n2 1 0 0 0 1"), "line 11: the file ends inside this line"},
      {dump(usual, "1 1 0 0 0 1\nITEM: TIMESTEP\n"), "line 11: 'ITEM: TIMESTEP' after 1 of the 2 atoms"},
      {dump(usual, "1 1 0 0 0 1\n2 1 0 0 0 1\n3 1 0 0 0 1\n"),
       "line 12: an 'ITEM:' of a dump expected, but there is '3"},
      {dump("type x y z radius", ""), "line 9: no column 'id'"},
      {dump("id x z radius", ""), "line 9: no column 'y', 'yu', 'ys' or 'ysu'"},
      {dump("id x y z", ""), "line 9: no column 'radius' or 'diameter'"},
      {dump("id x y z x radius", ""), "line 9: column 'x' is there twice"},
      {"ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\nmany\n", "line 4: the number of atoms is 'many'"},
      {"ITEM: TIMESTEP\n0\nITEM: ATOMS id x y z radius\n", "line 3: 'ITEM: ATOMS' before"},
      {"ITEM: TIMESTEP\n0\nITEM: BOX BOUNDS ff ff ff\n0 1\n0 one\n0 1\n", "line 5: the high bound is 'one'"},
      {"ITEM: TIMESTEP\n0\nITEM: BOX BOUNDS ff ff ff\n0 1 2\n", "line 4: 3 box bounds where 2"},
      {"ITEM: TIMESTEP\n0\nITEM: BOX BOUNDS abc origin ff ff ff\n1 0 0\n", "line 4: 3 box bounds where 4"},
      {"ITEM: TIMESTEP\n0\nITEM: BOX BOUNDS xy xz yz ff ff ff\n0 1\n", "line 4: 2 box bounds where 3"},
      {"ITEM: TIMESTEP\n0\nITEM: BOX BOUNDS xy xz yz ff ff ff\n0 1 inf\n", "line 4: the tilt factor is 'inf'"},
      {"ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n18446744073709551615\nITEM: BOX BOUNDS ff ff ff\n0 1\n0 1\n0 1\n"
       "ITEM: ATOMS id x y z radius\n1 0 0 0 1\n",
       "the file ends after 1 of the 18446744073709551615 atoms"},
      {"ITEM: UNITS\nlj\n", "the file ends before 'ITEM: ATOMS'"},
      {"", "the file is empty"},
      {"hello\n", "neither a LAMMPS text dump"},
  };
  for (const auto& [content, reason] : cases) {
    const std::string message = failure(directory.write("scene", content));
    EXPECT_NE(message.find(reason), std::string::npos) << "expected: " << reason << "\nfound: " << message;
  }
  EXPECT_NE(failure(directory.path("absent")).find("No such file"), std::string::npos);
  EXPECT_NE(failure(directory.path("")).find("is a directory"), std::string::npos);
}

TEST(LammpsDump, ColumnsComeInAnyOrderAndForm) {
  const Directory directory;
  const Objects expected = {{7, cube(-9, 0, 9, 0.25)}};
  const std::pair<std::string, std::string> cases[] = {
      {"radius z y x element id", "0.25 9 0 -9 Na 7"},   {"id xu yu zu diameter", "7 -9 0 9 0.5"},
      {"id xs ys zs radius", "7 0.05 0.5 0.95 0.25"},    {"id xsu ysu zsu radius", "7 0.05 0.5 0.95 0.25"},
      {"id xs x y z xu radius", "7 0.9 -9 0 9 99 0.25"}, {"id x ys zu", "7 -9 0.5 9"},
  };
  for (const auto& [columns, atom] : cases) {
    const std::string path = directory.write("scene", scene_files::dump_header(0, 1, columns) + atom + "\n");
    const auto frames = play(path, SceneOptions{.diameter = 0.5});
    ASSERT_EQ(frames.size(), 1U) << columns;
    EXPECT_EQ(frames[0], expected) << columns;
  }
}

// The same two atoms in every form of coordinates, in cells given as LAMMPS gives them.
struct CellCase {
  std::string bounds;
  std::array<std::array<double, 3>, 3> edges;
  std::array<double, 3> origin;
};
const CellCase kCells[] = {
    {"ITEM: BOX BOUNDS pp pp pp\n-4 6\n-3 5\n-5 5\n", {{{10, 0, 0}, {0, 8, 0}, {0, 0, 10}}}, {-4, -3, -5}},
    // xy 2.5, xz -1.5, yz 3: bounds from xlo - 1.5 to xhi + 2.5, and from ylo to yhi + 3.
    {"ITEM: BOX BOUNDS xy xz yz pp pp pp\n-5.5 8.5 2.5\n-3 8 -1.5\n-5 5 3\n",
     {{{10, 0, 0}, {2.5, 8, 0}, {-1.5, 3, 10}}},
     {-4, -3, -5}},
    // Tilts that add up: from xlo - 3 to xhi, and from ylo - 1 to yhi.
    {"ITEM: BOX BOUNDS xy xz yz ff ff ff\n-7 6 -2\n-4 5 -1\n-5 5 -1\n",
     {{{10, 0, 0}, {-2, 8, 0}, {-1, -1, 10}}},
     {-4, -3, -5}},
    {"ITEM: BOX BOUNDS abc origin pp pp pp\n6 8 0 -4\n-4 3 1 -3\n1 2 10 -5\n",
     {{{6, 8, 0}, {-4, 3, 1}, {1, 2, 10}}},
     {-4, -3, -5}},
};

std::string dump_in_cell(const std::string& bounds, const std::string& columns, const std::string& atoms) {
  return "ITEM: UNITS\nlj\nITEM: TIME\n0.5\nITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n2\n" + bounds + "ITEM: ATOMS " +
         columns + "\n" + atoms;
}

TEST(LammpsDump, EveryFormOfCoordinatesGivesTheSameBoxesInEveryCell) {
  const std::array<std::array<double, 3>, 2> scaled = {{{0.25, 0.5, 0.75}, {0.875, 0.125, 1.25}}};
  for (const CellCase& cell : kCells) {
    Objects expected;
    std::string plain_atoms, scaled_atoms;
    for (std::size_t atom = 0; atom < 2; ++atom) {
      std::array<double, 3> at = cell.origin;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        for (std::size_t edge = 0; edge < 3; ++edge) at[axis] += scaled[atom][edge] * cell.edges[edge][axis];
      }
      expected[atom + 1] = cube(at[0], at[1], at[2]);
      plain_atoms += fmt::format("{} {} 0.5\n", atom + 1, fmt::join(at, " "));
      scaled_atoms += fmt::format("{} {} 0.5\n", atom + 1, fmt::join(scaled[atom], " "));
    }
    for (const std::string suffix : {"", "u", "s", "su"}) {
      const std::string columns = fmt::format("id x{0} y{0} z{0} radius", suffix);
      const std::string dump = dump_in_cell(cell.bounds, columns, suffix.starts_with("s") ? scaled_atoms : plain_atoms);
      const auto source = open_bytes(dump);
      // Exactly: all products and sums are of few bits.
      EXPECT_EQ(play(*source), std::vector<Objects>{expected}) << dump;
      // What the cell is within.
      SceneBox bounds(cell.origin, cell.origin);
      for (const auto& edge : cell.edges) {
        for (std::size_t axis = 0; axis < 3; ++axis) (edge[axis] < 0 ? bounds.min : bounds.max)[axis] += edge[axis];
      }
      EXPECT_EQ(source->info().bounds, bounds) << dump;
    }
  }
}

TEST(LammpsDump, ADumpOfTwoDimensionsNeedsNoZ) {
  const Objects expected = {{1, cube(-1, 2, 0)}, {2, cube(4.5, -1, 0)}};
  const std::string flat = "ITEM: BOX BOUNDS pp pp pp\n-4 4\n-2 6\n-0.5 0.5\n";
  const std::string tilted = "ITEM: BOX BOUNDS xy xz yz pp pp pp\n-4 8 4\n-2 6 0\n-0.5 0.5 0\n";
  const std::string turned = "ITEM: BOX BOUNDS abc origin pp pp pp\n0 8 0 -4\n-8 0 0 -2\n0 0 1 -0.5\n";
  const std::tuple<std::string, std::string, std::string> cases[] = {
      {flat, "id x y radius", "1 -1 2 0.5\n2 4.5 -1 0.5\n"},
      {flat, "id xsu ysu radius", "1 0.375 0.5 0.5\n2 1.0625 0.125 0.5\n"},
      {flat, "id xs ys zs radius", "1 0.375 0.5 0.5 0.5\n2 1.0625 0.125 0.5 0.5\n"},
      {flat, "id x y z radius", "1 -1 2 0 0.5\n2 4.5 -1 0 0.5\n"},
      {tilted, "id xu yu radius", "1 -1 2 0.5\n2 4.5 -1 0.5\n"},
      {tilted, "id xs ys radius", "1 0.125 0.5 0.5\n2 1 0.125 0.5\n"},
      {turned, "id xs ys radius", "1 0.5 -0.375 0.5\n2 0.125 -1.0625 0.5\n"},
  };
  for (const auto& [bounds, columns, atoms] : cases) {
    const auto source = open_bytes(dump_in_cell(bounds, columns, atoms));
    EXPECT_EQ(play(*source), std::vector<Objects>{expected}) << bounds << columns;
  }
}

TEST(LammpsDump, CoordinatesThatATiltedCellLeavesOpenAreRefused) {
  const std::string atoms = "1 0 0 0 1\n2 0 0 0 1\n";
  EXPECT_NE(bytes_failure(dump_in_cell(kCells[1].bounds, "id x ys zs radius", atoms))
                .find("line 13: scaled and other coordinates in a tilted box"),
            std::string::npos);
  EXPECT_NE(bytes_failure(dump_in_cell(kCells[1].bounds, "id xs ys radius", "1 0 0 1\n2 0 0 1\n"))
                .find("line 13: no column 'zs' or 'zsu', which x and y depend on"),
            std::string::npos);
  // Where there are all scaled ones besides, they count.
  EXPECT_EQ(bytes_failure(dump_in_cell(kCells[1].bounds, "id x xs ys zs", "1 0 0 0 0\n2 0 0 0 0\n"), {.diameter = 1}),
            "");
}

TEST(LammpsDump, NumbersAndBlanksMayBeWrittenInEveryUsualWay) {
  const std::string usual =
      "ITEM: TIMESTEP\n100\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n-10 10\n-10 10\n-10 10\n"
      "ITEM: ATOMS id x y z radius\n12 1.5 -2 0 0.5\n3 0 0.25 0 0.5\n";
  const std::vector<Objects> expected = {{{3, cube(0, 0.25, 0)}, {12, cube(1.5, -2, 0)}}};
  ASSERT_EQ(play(*open_bytes(usual)), expected);
  const std::string others[] = {
      // a plus, exponents, zeros in front, numbers too small for a double
      "ITEM: TIMESTEP\n100\nITEM: NUMBER OF ATOMS\n+2\nITEM: BOX BOUNDS pp pp pp\n-10 +10\n-1.0E+1 1e1\n-10. +1.e01\n"
      "ITEM: ATOMS id x y z radius\n+12 +1.5e0 -2.E+00 1e-999 +.5\n003 -0 2.5e-1 -1e-400 00.5\n",
      // blanks and tabs around all that is alone on its line, and between words
      "\n \n\tITEM:\tTIMESTEP \n 100\t\nITEM:  NUMBER \t OF ATOMS\t\n 2 \nITEM: BOX  BOUNDS\tpp pp pp \n"
      " -10 10\t\n\t-10\t10\n-10  10 \nITEM: ATOMS\tid  x y\tz radius \n\t12 1.5\t-2 0 0.5 \n 3  0 0.25 0\t\t0.5\n\n",
      // an older LAMMPS, without the kinds of the boundaries
      "ITEM: TIMESTEP\n100\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS\n-10 10\n-10 10\n-10 10\n"
      "ITEM: ATOMS id x y z radius\n12 1.5 -2 0 0.5\n3 0 0.25 0 0.5\n",
  };
  for (std::string text : others) {
    EXPECT_EQ(play(*open_bytes(text)), expected) << text;
    for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) text.insert(at, 1, '\r');
    EXPECT_EQ(play(*open_bytes(text)), expected) << "with CRLF: " << text;
  }
  for (const std::string count : {"2 2", "2.5", "+-2", "", "1e3", "18446744073709551616", "two"}) {
    std::string text = usual;
    text.replace(text.find("\n2\n") + 1, 1, count);
    EXPECT_NE(bytes_failure(text).find("line 4: the number of atoms is '" + count + "'"), std::string::npos) << count;
  }
  for (const std::string number : {"+", "+-1", "++1", "1.5.0", "0x10", "1e", "1,5", "infinity", "1e400"}) {
    std::string text = usual;
    text.replace(text.find("0.25"), 4, number);
    EXPECT_NE(bytes_failure(text).find("line 11: timestep 100, atom 3: y is '" + number + "'"), std::string::npos)
        << number << ": " << bytes_failure(text);
  }
}

TEST(LammpsDump, ABoxBeyondTheNumbersOfTheEngineIsRefused) {
  const std::string usual = "ITEM: BOX BOUNDS pp pp pp\n0 1\n0 1\n0 1\n";
  const std::string wide = "ITEM: BOX BOUNDS pp pp pp\n-1.7e308 1.7e308\n0 1\n0 1\n";
  const std::string slanted = "ITEM: BOX BOUNDS xy xz yz pp pp pp\n0 1 1.7e308\n0 1 1.7e308\n0 1 0\n";
  const std::tuple<std::string, std::string, std::string> cases[] = {
      {usual, "id x y z radius", "1.7e308 0 0 1.7e308"},
      {usual, "id x y z radius", "0 -1.7e308 0 1e308"},
      {usual, "id x y z radius", "0 0 0 1e999"},
      {wide, "id xs y z radius", "0.5 0 0 1"},
      {wide, "id xs y z radius", "0 0 0 1"},
      {usual, "id xsu ysu zsu radius", "0 0 1e308 1.7e308"},
      {slanted, "id xs ys zs radius", "0.5 1 1 1"},
  };
  for (const auto& [bounds, columns, atom] : cases) {
    const std::string message = bytes_failure(dump_in_cell(bounds, columns, "8 0 0 0 1\n9 " + atom + "\n"));
    const bool first = bounds != usual;  // already x = 0 cannot be told in a cell of infinite width
    EXPECT_NE(message.find(first ? "line 14: timestep 0, atom 8: " : "line 15: timestep 0, atom 9: "),
              std::string::npos)
        << atom << ": " << message;
  }
  // What only a float cannot hold.
  const std::string far = dump_in_cell(usual, "id x y z radius", "8 0 0 0 1\n9 0 0 1e39 1\n");
  EXPECT_EQ(bytes_failure(far), "");
  SceneOptions for_float;
  for_float.largest = std::numeric_limits<float>::max();
  EXPECT_NE(bytes_failure(far, for_float).find("line 15: timestep 0, atom 9: "), std::string::npos);
}

TEST(LammpsDump, AtomsAppearVanishAndComeBack) {
  const Directory directory;
  const std::vector<Objects> frames = {{{3, cube(0, 0, 0)}, {900719925474099300, cube(1, 0, 0)}},
                                       {{3, cube(0, 0, 0)}},
                                       {},
                                       {{1, cube(2, 2, 2)}, {3, cube(0, 0, 0)}},
                                       {{3, cube(0, 0, 0)}, {900719925474099300, cube(1, 0, 0)}}};
  EXPECT_EQ(play(directory.write("scene", scene_files::as_dump(frames))), frames);
}

TEST(LammpsDump, BoxesAreCentreAndRadiusInDouble) {
  const Directory directory;
  const auto frames = play(
      directory.write("scene", scene_files::dump_header(0, 1, "id x y z radius") + "1 0.1 1e-3 11.5285 0.46615\n"));
  EXPECT_EQ(frames.at(0).at(1), SceneBox({0.1 - 0.46615, 1e-3 - 0.46615, 11.5285 - 0.46615},
                                         {0.1 + 0.46615, 1e-3 + 0.46615, 11.5285 + 0.46615}));
}

TEST(Recordings, AreWhatTheirReadmeTells) {
  struct Expected {
    std::string file;
    std::size_t frames, first, last, inserts, erases;
  };
  const Expected recordings[] = {
      {"bullet_freefall_assorted_1000_f100.aabbs.xz", 101, 1000, 1000, 0, 0},
      {"bullet_freefall_cubes_1000_f640_sleep.aabbs.xz", 101, 1000, 1000, 0, 0},
      {"bullet_towers_4000.aabbs.xz", 101, 4000, 4000, 0, 0},
      {"lammps_pour_2200.lammpstrj.xz", 61, 2150, 2308, 731, 573},
  };
  for (const Expected& expected : recordings) {
    const auto source = open_scene(std::string(SWEEPGRID_RECORDINGS) + "/" + expected.file);
    std::size_t frames = 0, first = 0, objects = 0, inserts = 0, erases = 0;
    for (SceneStep step; source->next(step); ++frames) {
      objects += step.inserted.size() - step.erased.size();
      (frames == 0 ? first : inserts) += step.inserted.size();
      erases += step.erased.size();
    }
    EXPECT_EQ(frames, expected.frames) << expected.file;
    EXPECT_EQ(first, expected.first) << expected.file;
    EXPECT_EQ(objects, expected.last) << expected.file;
    EXPECT_EQ(inserts, expected.inserts) << expected.file;
    EXPECT_EQ(erases, expected.erases) << expected.file;
  }
}

const std::string kSmall = "n=500,steps=20,churn=0.01";

// Red is legitimate when a generator was changed on purpose: measurements of before and after cannot be compared then.
TEST(Generators, AreTheSameOnEveryMachine) {
  EXPECT_EQ(fingerprint("uniform:" + kSmall), 7514410326618477935U);
  EXPECT_EQ(fingerprint("uniform:dim=2,seed=7," + kSmall), 13024151819315611047U);
  EXPECT_EQ(fingerprint("clusters:" + kSmall), 2007466700614918901U);
  EXPECT_EQ(fingerprint("sizes:" + kSmall), 16757189980530352473U);
  EXPECT_EQ(fingerprint("pile:" + kSmall), 4720866077259255019U);
  EXPECT_EQ(fingerprint("teleport:" + kSmall), 1390411949341737363U);
}

TEST(Generators, KeepEveryBoxInsideTheWorld) {
  for (const std::string spec : {"uniform:speed=0.9,moving=1", "uniform:speed=1e6,moving=1", "uniform:dim=2,moving=1",
                                 "clusters:spread=1,moving=1", "sizes:moving=1", "pile:moving=1", "teleport:moving=1",
                                 "uniform:density=1e9,moving=1", "pile:dim=2,large=0.5"}) {
    const auto source = open_scene(spec + "," + kSmall);
    const SceneBox world = *source->info().bounds;
    const double rounding = 1e-12 * world.max[0];
    for (const Objects& objects : play(*source)) {
      EXPECT_EQ(objects.size(), 500U);
      for (const auto& [key, box] : objects) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
          EXPECT_GE(box.min[axis], 0) << spec;
          EXPECT_LE(box.max[axis], world.max[axis] + rounding) << spec;
        }
      }
    }
  }
}

TEST(Generators, MoveAndReplaceTheAskedParts) {
  const auto source = open_scene("uniform:n=3000,moving=150/3000,churn=1/3000,steps=200,speed=0.1,width=2");
  SceneStep step;
  ASSERT_TRUE(source->next(step));
  Objects objects;
  for (std::size_t i = 0; i < step.inserted.size(); ++i) objects[step.inserted[i]] = step.inserted_boxes[i];
  std::size_t missing = 0;
  while (source->next(step)) {
    ASSERT_EQ(step.erased.size(), 1U);
    ASSERT_EQ(step.inserted.size(), 1U);
    missing += 150 - step.updated.size();  // those just replaced
    for (std::size_t i = 0; i < step.updated.size(); ++i) {
      SceneBox& box = objects.at(step.updated[i]);
      double squared = 0;
      for (std::size_t axis = 0; axis < 3; ++axis)
        squared += std::pow(step.updated_boxes[i].min[axis] - box.min[axis], 2);
      EXPECT_LE(std::sqrt(squared), 0.2 + 1e-9);  // less where it bounced
      box = step.updated_boxes[i];
    }
    objects.erase(step.erased[0]);
    objects[step.inserted[0]] = step.inserted_boxes[0];
  }
  EXPECT_LE(missing, 40U);  // 10 are expected: 200 replaced, 5 % of them moving
}

TEST(Generators, HaveTheAskedDensity) {
  const auto density = [](const std::string& spec) {
    const auto source = open_scene(spec);
    SceneStep step;
    source->next(step);
    double volume = 0;
    for (const SceneBox& box : step.inserted_boxes) {
      volume += std::pow(box.max[0] - box.min[0], source->info().dim);
    }
    const SceneBox world = *source->info().bounds;
    return volume / (world.max[0] * world.max[1] * (source->info().dim == 3 ? world.max[2] : 1));
  };
  EXPECT_NEAR(density("uniform"), 0.05, 1e-9);
  EXPECT_NEAR(density("uniform:dim=2,n=1e4"), 0.05, 1e-9);
  EXPECT_NEAR(density("sizes:n=1e4,density=0.2"), 0.2, 1e-9);
  EXPECT_NEAR(density("pile:n=1e4"), 0.3, 1e-9);
}

TEST(Generators, NameTheParameterThatIsWrong) {
  const std::pair<std::string, std::string> cases[] = {
      {"uniform:m=3", "no parameter 'm'; there are n, moving"},
      {"uniform:n=0", "parameter n: 0 is not within 1 and"},
      {"uniform:n=1.5", "parameter n: 1.5 is not a whole number"},
      {"uniform:n=many", "parameter n: 'many' is not a number"},
      {"uniform:n=", "parameter n: '' is not a number"},
      {"uniform:moving=1.01", "parameter moving: 1.01 is not within 0 and 1"},
      {"uniform:moving=nan", "parameter moving: 'nan' is not a number"},
      {"uniform:churn=1/0", "parameter churn: '1/0' is not a number"},
      {"uniform:dim=4", "parameter dim: 4 is not within 2 and 3"},
      {"uniform:seed=-1", "parameter seed: -1 is not within"},
      {"uniform:seed=18446744073709551616", "parameter seed: 18446744073709551616 is not a whole number"},
      {"uniform:n=5,n=6", "parameter n is there twice"},
      {"uniform:n", "'n' is not key=value"},
  };
  for (const auto& [spec, reason] : cases) {
    const std::string message = failure(spec);
    EXPECT_NE(message.find("generator uniform: " + reason), std::string::npos) << spec << ": " << message;
  }
  EXPECT_EQ(failure("uniform:n=1e2,seed=18446744073709551615,steps=1"), "");
}

}  // namespace
}  // namespace sweepgrid::scenes_test
