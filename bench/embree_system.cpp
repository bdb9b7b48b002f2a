#include <embree3/rtcore.h>
#include <oneapi/tbb/task_arena.h>

#include <atomic>
#include <limits>
#include <stdexcept>

#include "system.hpp"

namespace sweepgrid::bench {
namespace {

class EmbreeSystem final : public System {
 public:
  EmbreeSystem(EmbreeUpkeep upkeep, std::uint32_t objects) : boxes_(objects + 1, kNowhere) {
    // Embree's own setting for one thread limits oneTBB in the whole process, and with it every system that runs on
    // more; an arena of one slot limits Embree alone.
    arena_.initialize();
    device_ = rtcNewDevice(nullptr);
    if (device_ == nullptr) throw std::runtime_error("Embree gives no device");
    rtcSetDeviceMemoryMonitorFunction(
        device_,
        [](void* self, ssize_t bytes, bool) {
          static_cast<EmbreeSystem*>(self)->bytes_ += bytes;
          return true;
        },
        this);
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_DYNAMIC);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_LOW);
    geometry_ = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryBuildQuality(geometry_,
                               upkeep == EmbreeUpkeep::kRefit ? RTC_BUILD_QUALITY_REFIT : RTC_BUILD_QUALITY_LOW);
    rtcSetGeometryUserData(geometry_, this);
    rtcSetGeometryBoundsFunction(geometry_, bounds, nullptr);
    rtcAttachGeometry(scene_, geometry_);
  }
  ~EmbreeSystem() override {
    rtcReleaseGeometry(geometry_);
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  EmbreeSystem(const EmbreeSystem&) = delete;
  EmbreeSystem& operator=(const EmbreeSystem&) = delete;

  void queue(const ScriptStep& step) override {
    for (const std::uint32_t object : step.erased) boxes_[object] = kNowhere;
    for (std::size_t i = 0; i < step.inserted.size(); ++i) boxes_[step.inserted[i]] = step.inserted_boxes[i];
    for (std::size_t i = 0; i < step.updated.size(); ++i) boxes_[step.updated[i]] = step.updated_boxes[i];
    if (!step.inserted.empty()) announce_new_shape();
  }

  void step() override {
    found_.clear();
    arena_.execute([this] {
      rtcCommitGeometry(geometry_);
      rtcCommitScene(scene_);
      rtcCollide(scene_, scene_, collide, this);
    });
    if (const RTCError error = rtcGetDeviceError(device_); error != RTC_ERROR_NONE) {
      throw std::runtime_error("Embree reports error " + std::to_string(error));
    }
  }

  [[nodiscard]] std::vector<ObjectPair> pairs() const override { return found_; }
  [[nodiscard]] std::optional<std::uint64_t> counted_bytes() const override {
    return static_cast<std::uint64_t>(bytes_) + boxes_.capacity() * sizeof(FloatBox) +
           found_.capacity() * sizeof(ObjectPair);
  }

 private:
  static constexpr float kInfinity = std::numeric_limits<float>::infinity();
  // Embree leaves out primitives whose bounds are empty.
  static inline const FloatBox kNowhere{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};

  // A refit leaves out primitives that were empty when the hierarchy was built, unless their number is another one;
  // the last box is there for that, and always empty.
  void announce_new_shape() {
    spare_ = !spare_;
    rtcSetGeometryUserPrimitiveCount(geometry_, static_cast<unsigned>(boxes_.size() - (spare_ ? 0 : 1)));
  }

  static void bounds(const RTCBoundsFunctionArguments* arguments) {
    const FloatBox& box = static_cast<const EmbreeSystem*>(arguments->geometryUserPtr)->boxes_[arguments->primID];
    RTCBounds& out = *arguments->bounds_o;
    out.lower_x = box.min[0], out.lower_y = box.min[1], out.lower_z = box.min[2];
    out.upper_x = box.max[0], out.upper_y = box.max[1], out.upper_z = box.max[2];
  }

  // Candidates are pairs of leaves that meet, every pair in both orders, and a refitted leaf holds several objects.
  static void collide(void* self, RTCCollision* candidates, unsigned count) {
    auto& system = *static_cast<EmbreeSystem*>(self);
    for (unsigned i = 0; i < count; ++i) {
      const std::uint32_t a = candidates[i].primID0;
      const std::uint32_t b = candidates[i].primID1;
      if (a < b && system.boxes_[a].overlaps(system.boxes_[b])) system.found_.push_back({a, b});
    }
  }

  std::vector<FloatBox> boxes_;  // by object number
  bool spare_ = false;           // whether the box behind the last object's counts
  std::vector<ObjectPair> found_;
  std::atomic<std::int64_t> bytes_ = 0;
  oneapi::tbb::task_arena arena_{1};
  RTCDevice device_;
  RTCScene scene_;
  RTCGeometry geometry_;
};

}  // namespace

std::unique_ptr<System> make_embree(EmbreeUpkeep upkeep, std::uint32_t objects) {
  return std::make_unique<EmbreeSystem>(upkeep, objects);
}

}  // namespace sweepgrid::bench
