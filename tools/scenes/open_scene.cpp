#include "scenes/open_scene.hpp"

#include <utility>

#include <fmt/format.h>

#include "scenes/aabbs_source.hpp"
#include "scenes/byte_stream.hpp"
#include "scenes/generated_scene.hpp"
#include "scenes/generator_params.hpp"
#include "scenes/lammps_source.hpp"
#include "scenes/scene_error.hpp"

namespace sweepgrid {

namespace {

std::unique_ptr<SceneSource> source_of(std::unique_ptr<ByteStream> content, const SceneOptions& options) {
  const std::string& name = content->path();
  const std::string_view start = content->peek(AabbsSource::kHeaderSize);
  if (LammpsSource::recognises(start)) return std::make_unique<LammpsSource>(std::move(content), options);
  // Too little to tell what it is.
  if (start.size() < AabbsSource::kHeaderSize && !content->damage().empty()) {
    throw SceneError(fmt::format("{}: the file ends after {} bytes: {}", name, start.size(), content->damage()));
  }
  if (start.empty()) throw SceneError(fmt::format("{}: the file is empty", name));
  // The name counts only where the content does not decide: to say what is wrong with a damaged .aabbs header. Text is
  // none, whatever its name.
  const bool text = start.find('\0') == std::string_view::npos;
  if (AabbsSource::recognises(start) || (!text && name.find(".aabbs") != std::string::npos)) {
    return std::make_unique<AabbsSource>(std::move(content));
  }
  throw SceneError(
      fmt::format("{}: not a recording: neither a LAMMPS text dump (no 'ITEM:' at its start) nor .aabbs", name));
}

}  // namespace

std::unique_ptr<SceneSource> open_scene(const std::string& spec, const SceneOptions& options) {
  if (const auto params = parse_generator(spec)) return std::make_unique<GeneratedScene>(spec, *params);
  return source_of(std::make_unique<ByteStream>(spec), options);
}

std::unique_ptr<SceneSource> open_recording(std::unique_ptr<std::streambuf> bytes, const std::string& name,
                                            const SceneOptions& options) {
  return source_of(std::make_unique<ByteStream>(std::move(bytes), name), options);
}

}  // namespace sweepgrid
