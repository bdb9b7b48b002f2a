#include <BulletCollision/CollisionDispatch/btBoxBoxDetector.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>

#include "baselines/peer_narrow_phase.hpp"

namespace sweepgrid::baselines {
namespace {

struct Contacts final : public btDiscreteCollisionDetectorInterface::Result {
  std::size_t count = 0;

  void setShapeIdentifiersA(int, int) override {}
  void setShapeIdentifiersB(int, int) override {}
  void addContactPoint(const btVector3&, const btVector3&, btScalar) override { ++count; }
};

btTransform transform(const PlacedBox& box) {
  const auto& [x, y, z] = box.axes;
  const btMatrix3x3 basis(x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2]);
  return btTransform(basis, btVector3(box.centre[0], box.centre[1], box.centre[2]));
}

btBoxShape shape(const PlacedBox& box) {
  btBoxShape shape(btVector3(box.half[0], box.half[1], box.half[2]));
  shape.setMargin(0);
  return shape;
}

}  // namespace

std::size_t bullet_touching(const PlacedPairs& pairs) {
  std::size_t touching = 0;
  for (const auto& [a, b] : pairs) {
    const btBoxShape shape_a = shape(a);
    const btBoxShape shape_b = shape(b);
    btDiscreteCollisionDetectorInterface::ClosestPointInput input;
    input.m_transformA = transform(a);
    input.m_transformB = transform(b);
    Contacts contacts;
    btBoxBoxDetector(&shape_a, &shape_b).getClosestPoints(input, contacts, nullptr);
    touching += contacts.count > 0 ? 1 : 0;
  }
  return touching;
}

}  // namespace sweepgrid::baselines
