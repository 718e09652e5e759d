#include "filters/gaussian/camera.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "sim/kernel/error.hpp"
#include "tests/filters/gaussian/samples.hpp"

namespace hearsay::gaussian {
namespace {

constexpr double pi = 3.14159265358979323846;

Vector3 random_vector3(Stream& random, double sigma) {
  return {random.normal(0, sigma), random.normal(0, sigma), random.normal(0, sigma)};
}

CameraPose random_pose(Stream& random) {
  return looking(random_vector3(random, 20.0), random.uniform(-pi, pi), random.uniform(-1.5, 1.5),
                 random.uniform(-pi, pi));
}

TEST(Rotation, TurnsRightHandedAndKeepsItsAxis) {
  EXPECT_LT((rotation({0, 0, pi / 2}) * Vector3(1, 0, 0) - Vector3(0, 1, 0)).norm(), 1e-15);
  EXPECT_LT((rotation({pi / 2, 0, 0}) * Vector3(0, 1, 0) - Vector3(0, 0, 1)).norm(), 1e-15);
  Stream random = stream("rotation");
  for (int i = 0; i < 50; ++i) {
    const Vector3 r = random_vector3(random, 1.5);
    const Matrix3 R = rotation(r);
    EXPECT_LT((R.transpose() * R - Matrix3::Identity()).norm(), 1e-14);
    EXPECT_NEAR(R.determinant(), 1.0, 1e-14);
    EXPECT_LT((R * r - r).norm(), 1e-14 * (1 + r.norm()));
    EXPECT_NEAR(R.trace(), 1 + 2 * std::cos(r.norm()), 1e-14);
    EXPECT_LT((rotation(0.3 * r) * rotation(0.7 * r) - R).norm(), 1e-14);
  }
}

TEST(Rotation, OfAlmostNothingIsItsFirstOrder) {
  EXPECT_EQ(rotation({0, 0, 0}), Matrix3::Identity());
  for (const double tiny : {1e-9, 1e-160, 1e-310}) {
    const Matrix3 R = rotation({0, 0, tiny});
    EXPECT_NEAR(R(1, 0), tiny, 1e-15 * tiny);
    EXPECT_NEAR(R(0, 1), -tiny, 1e-15 * tiny);
    EXPECT_EQ(R(2, 2), 1.0);
  }
}

TEST(Camera, RightOfTheImageIsRightAndDownIsDown) {
  const CameraPose ahead = looking({0, 0, 2}, 0.0, 0.0);  // along +x
  const auto left_and_high = project(infrared_camera, ahead, {10, 1, 3});
  ASSERT_TRUE(left_and_high);
  EXPECT_NEAR((*left_and_high)(0), 119.512 - 34.7881, 1e-12);
  EXPECT_NEAR((*left_and_high)(1), 161.781 - 34.5876, 1e-12);
  // Straight down with heading +y: what lies farther along y is up in the image.
  const CameraPose down = looking({5, 5, 40}, pi / 2, pi / 2);
  const auto north = project(infrared_camera, down, {5, 9, 0});
  const auto east = project(infrared_camera, down, {9, 5, 0});
  ASSERT_TRUE(north && east);
  EXPECT_NEAR((*north)(0), 119.512, 1e-12);
  EXPECT_NEAR((*north)(1), 161.781 - 34.5876, 1e-12);
  EXPECT_NEAR((*east)(0), 119.512 + 34.7881, 1e-12);
}

TEST(Camera, ProjectsAsTheHomogeneousMatrixDoes) {
  // s·m = K [R | −R·t] (p, 1), with R from world to camera.
  Stream random = stream("projection");
  const Intrinsics camera{350, 340, 120, 160, 2.5};
  Matrix3 K;
  K << 350, 2.5, 120, 0, 340, 160, 0, 0, 1;
  int seen = 0;
  for (int i = 0; i < 100; ++i) {
    const CameraPose pose = random_pose(random);
    const Vector3 p = random_vector3(random, 30.0);
    Eigen::Matrix<double, 3, 4> P;
    P.leftCols<3>() = K * pose.axes.transpose();
    P.col(3) = -K * pose.axes.transpose() * pose.position_m;
    const Vector3 sm = P * Eigen::Vector4d(p(0), p(1), p(2), 1.0);
    const auto pixel = project(camera, pose, p);
    EXPECT_EQ(pixel.has_value(), sm(2) > 0);
    if (!pixel) continue;
    ++seen;
    EXPECT_NEAR((*pixel)(0), sm(0) / sm(2), 1e-9 * (1 + std::fabs((*pixel)(0))));
    EXPECT_NEAR((*pixel)(1), sm(1) / sm(2), 1e-9 * (1 + std::fabs((*pixel)(1))));
    const Ray ray = ray_through(camera, pose, *pixel);
    EXPECT_NEAR(ray.direction.norm(), 1.0, 1e-15);
    EXPECT_LT(ray.direction.cross(p - ray.origin_m).norm(), 1e-9 * (p - ray.origin_m).norm());
    EXPECT_GT(ray.direction.dot(p - ray.origin_m), 0.0);
  }
  EXPECT_GT(seen, 30);
}

TEST(Camera, ProjectionJacobianEqualsCentralDifferences) {
  const Intrinsics camera{350, 340, 120, 160, 2.5};
  const CameraPose identity{{0, 0, 0}, Matrix3::Identity()};
  const Vector3 at(3.0, -2.0, 12.0);
  const auto J = projection_jacobian(camera, at);
  for (int k = 0; k < 3; ++k) {
    const Vector3 step = 1e-4 * Vector3::Unit(k);
    const Vector difference = *project(camera, identity, at + step) -  //
                              *project(camera, identity, at - step);
    EXPECT_LT((J.col(k) - difference / 2e-4).norm(), 1e-7);
  }
}

TEST(Camera, LookingAtATargetHasItInTheCentre) {
  Stream random = stream("looking at");
  for (int i = 0; i < 30; ++i) {
    const Vector3 from = random_vector3(random, 20.0), to = random_vector3(random, 20.0);
    const auto pose = looking_at(from, to);
    ASSERT_TRUE(pose);
    EXPECT_EQ(pose->axes(2, 0), 0.0);  // no roll: the image's x is level
    EXPECT_LT((pose->axes.transpose() * pose->axes - Matrix3::Identity()).norm(), 1e-14);
    const auto pixel = project(infrared_camera, *pose, to);
    ASSERT_TRUE(pixel);
    EXPECT_NEAR((*pixel)(0), 119.512, 1e-10);
    EXPECT_NEAR((*pixel)(1), 161.781, 1e-10);
  }
  const auto down = looking_at({1, 2, 40}, {1, 2, 0});
  ASSERT_TRUE(down);
  EXPECT_LT((down->axes - looking({1, 2, 40}, 0.0, pi / 2).axes).norm(), 1e-15);
  EXPECT_FALSE(looking_at({1, 2, 3}, {1, 2, 3}));
  EXPECT_FALSE(looking_at({1, 2, 3}, {HUGE_VAL, 2, 3}));
}

TEST(Camera, WhatIsNotAheadHasNoPixelAndALensMustBeOne) {
  const CameraPose ahead = looking({0, 0, 2}, 0.0, 0.0);
  EXPECT_FALSE(project(infrared_camera, ahead, {-1, 0, 2}));
  EXPECT_FALSE(project(infrared_camera, ahead, {0, 5, 2}));
  EXPECT_FALSE(project(infrared_camera, ahead, {0, 0, 2}));
  EXPECT_THROW(project({0, 340, 0, 0}, ahead, {1, 0, 2}), BrokenInvariant);
  EXPECT_THROW(ray_through(infrared_camera, ahead, vector({1.0})), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay::gaussian
