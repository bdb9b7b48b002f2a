// Recordings and generators: what is read is what was written, and what is damaged is told from what is whole.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "scenes/open_scene.hpp"
#include "scenes_data/fingerprint.hpp"
#include "scenes_data/scene_files.hpp"

namespace sweepgrid {
namespace {

using scene_files::Directory;
using scene_files::failure;
using scene_files::fingerprint;
using scene_files::Objects;
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
      const std::string bytes = scene_files::compress(content_of(format), compression);
      const auto source = open_recording(std::make_unique<std::stringbuf>(bytes), "memory");
      EXPECT_EQ(source->info().name, "memory");
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
  const Directory directory;
  for (const std::string compression : {"gzip", "xz", "zstd"}) {
    const std::string content = content_of("aabbs");
    const std::string file = scene_files::compress(content.substr(0, 500), compression) +
                             scene_files::compress(content.substr(500), compression);
    EXPECT_EQ(play(directory.write("scene", file)), three_frames()) << compression;
  }
}

TEST(SceneFiles, EveryCutOfACompressedFileIsNoticed) {
  const Directory directory;
  for (const std::string& format : kFormats) {
    for (const std::string compression : {"gzip", "xz", "zstd"}) {
      const std::string whole = scene_files::compress(content_of(format), compression);
      // The cuts near the end leave all content whole and take the compressed stream's end away.
      for (std::size_t size = 0; size < whole.size(); ++size) {
        const std::string path = directory.write("scene", whole.substr(0, size));
        const std::string message = failure(path);
        EXPECT_TRUE(message.starts_with(path)) << format << " " << compression << " cut at " << size << ": " << message;
      }
      EXPECT_NE(failure(directory.write("scene", whole + "tail")), "") << format << " " << compression;
    }
  }
}

TEST(SceneFiles, EveryCutOfABareFileIsNoticedUnlessItIsBetweenTheFramesOfADump) {
  const Directory directory;
  for (const std::string& format : kFormats) {
    const std::string whole = content_of(format);
    std::vector<std::size_t> unnoticed;
    for (std::size_t size = 0; size < whole.size(); ++size) {
      if (failure(directory.write("scene", whole.substr(0, size))).empty()) unnoticed.push_back(size);
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
  const Directory directory;
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
    EXPECT_NE(failure(directory.write("scene", zstd)).find("cut off"), std::string::npos);
    EXPECT_NE(failure(directory.write("scene", gzip)).find("cut off"), std::string::npos);
  }
  // The same with an empty last block is whole.
  EXPECT_EQ(failure(directory.write("scene", zstd + std::string("\x01\0\0", 3))), "");
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
  const std::pair<std::string, std::string> cases[] = {
      {good.substr(0, 300), "byte 300: the file ends inside the 304 bytes of the .aabbs header"},
      {good + "x", "byte 592: the header tells 3 frames of 3 objects, which are 592 bytes, but the file has 593"},
      {scene_files::compress(good + "x", "xz"), "byte 592: more data behind the 3 frames"},
      {scene_files::compress(good.substr(0, 500), "zstd"), "byte 500: the file ends inside frame 3 of 3"},
      {scene_files::aabbs_header(0xffffffffU, 1), "byte 256: the .aabbs header tells -1 objects"},
      {scene_files::aabbs_header(1, 0x80000000U), "byte 260: the .aabbs header tells -2147483648 steps"},
      {scene_files::compress(scene_files::aabbs_header(0x7fffffff, 0x7fffffff), "gzip"), "ends inside frame 1"},
      {with_float(272, kNan), "byte 272: the world box"},
      {with_float(second_frame + 32, kNan), "byte 432: the box of object 1 in frame 2 has a NaN or min > max"},
      {with_float(second_frame + 64, 9), "byte 464: the box of object 2 in frame 2 has a NaN or min > max"},
  };
  for (const auto& [content, reason] : cases) {
    const std::string message = failure(directory.write("scene.aabbs", content));
    EXPECT_NE(message.find(reason), std::string::npos) << "expected: " << reason << "\nfound: " << message;
  }
}

TEST(SceneFiles, DamagedDumpsAreRefusedWithTheReason) {
  const Directory directory;
  const auto dump = [](const std::string& columns, const std::string& atoms) {
    return scene_files::dump_header(7, 2, columns) + atoms;
  };
  const std::string usual = "id type x y z radius";
  const std::pair<std::string, std::string> cases[] = {
      {dump(usual, "1 1 0 0 0 1\n2 1 0 0 0 nan\n"), "line 11: the radius is 'nan', not finite"},
      {dump(usual, "1 1 0 inf 0 1\n2 1 0 0 0 1\n"), "line 10: y is 'inf', not finite"},
      {dump(usual, "1 1 0 0 1e999 1\n2 1 0 0 0 1\n"), "line 10: z is '1e999', out of the range of double"},
      {dump(usual, "1 1 0 0 0 -1\n2 1 0 0 0 1\n"), "line 10: the radius is -1, negative"},
      {dump(usual, "1 1 0.5x 0 0 1\n2 1 0 0 0 1\n"), "line 10: x is '0.5x', not a number"},
      {dump(usual, "-1 1 0 0 0 1\n2 1 0 0 0 1\n"), "line 10: the id is '-1', not a whole number"},
      {dump(usual, "1 1 0 0 0\n2 1 0 0 0 1\n"), "line 10: 5 values for the 6 columns"},
      {dump(usual, "1 1 0 0 0 1 9\n2 1 0 0 0 1\n"), "line 10: 7 values for the 6 columns"},
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
      {"ITEM: TIMESTEP\n0\nITEM: BOX BOUNDS abc origin ff ff ff\n", "line 3: general triclinic boxes"},
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

TEST(LammpsDump, ATiltedBoxDoesNoHarmToPlainCoordinatesOnly) {
  const Directory directory;
  const std::string start =
      "ITEM: UNITS\nlj\nITEM: TIME\n0.5\nITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n1\n"
      "ITEM: BOX BOUNDS xy xz yz pp pp pp\r\n0 1 0.5\n0 1 0\n0 1 0\nITEM: ATOMS id ";
  EXPECT_EQ(failure(directory.write("scene", start + "x y z radius\n1 0 0 0 1\n\n")), "");
  EXPECT_NE(failure(directory.write("scene", start + "xs ys zs radius\n1 0 0 0 1\n")).find("triclinic"),
            std::string::npos);
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
}  // namespace sweepgrid
