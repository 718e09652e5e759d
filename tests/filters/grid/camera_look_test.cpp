#include "filters/grid/camera_look.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "filters/gaussian/geolocation.hpp"
#include "sim/kernel/error.hpp"
#include "tests/filters/grid/samples.hpp"

namespace hearsay::grid {
namespace {

using gaussian::CameraPose;
using gaussian::look_covariance;
using gaussian::looking;
using gaussian::Matrix;
using gaussian::Vector;
using gaussian::Vector3;

const double pi = std::acos(-1.0);

GridCamera infrared() {
  return {.lens = gaussian::infrared_camera,
          .width = 240,
          .height = 320,
          .detector = {0.962, 0.045},
          .range_max_m = 100.0};
}

Matrix pose_covariance(double sigma_position_m, double sigma_attitude_rad) {
  return look_covariance({sigma_position_m, sigma_attitude_rad, 0.0}).topLeftCorner(6, 6);
}

const Area area({.columns = 60, .rows = 60, .cell_m = 1.0, .x_m = -30.0, .y_m = -30.0});

/// Marks the pixels for which f(u, v).
template <typename F>
SegmentedImage image_of(const F& f) {
  SegmentedImage image(240, 320);
  for (int v = 0; v < 320; ++v) {
    for (int u = 0; u < 240; ++u) {
      if (f(u, v)) image.mark(u, v);
    }
  }
  return image;
}
SegmentedImage disc(double u0, double v0, double radius) {
  return image_of([=](int u, int v) { return std::hypot(u - u0, v - v0) < radius; });
}

std::vector<int> seen_by(const CameraLook& look) {
  std::vector<int> cells;
  for (const CellInView& c : look.in_view()) cells.push_back(c.cell);
  return cells;
}

TEST(CameraLook, SeesTheCellsInItsImageAndNoOthers) {
  Stream random = stream("in view");
  const GridCamera camera = infrared();
  std::size_t found = 0;
  for (int trial = 0; trial < 200; ++trial) {
    GridCamera c = camera;
    c.range_max_m = random.uniform(10, 80);
    c.ground_m = random.uniform(-3, 3);
    CameraLook look(c, area);
    const CameraPose pose =
        looking({random.uniform(-40, 40), random.uniform(-40, 40), random.uniform(-5, 60)},
                random.uniform(-pi, pi), random.uniform(-pi / 2, pi / 2), random.uniform(-1, 1));
    ASSERT_TRUE(look.look(pose, pose_covariance(0.5, 0.01)));
    std::vector<int> expected;
    for (int cell = 0; cell < area.cells(); ++cell) {
      const Point at = area.centre(cell);
      const Vector3 point(at.x_m, at.y_m, c.ground_m);
      const auto pixel = gaussian::project(c.lens, pose, point);
      const bool above = pose.position_m(2) > c.ground_m;
      if (!pixel || !above || (point - pose.position_m).norm() >= c.range_max_m) continue;
      const double u = (*pixel)(0), v = (*pixel)(1);
      if (u >= -0.5 && u < 239.5 && v >= -0.5 && v < 319.5) expected.push_back(cell);
    }
    EXPECT_EQ(seen_by(look), expected);
    found += expected.size();
  }
  EXPECT_GT(found, 5000u);
}

TEST(CameraLook, QualitiesFadeWithDistance) {
  CameraLook look(infrared(), area);
  const CameraPose pose = looking({0, 0, 40}, 0.3, 1.2);
  ASSERT_TRUE(look.look(pose, pose_covariance(0.1, 0.01)));
  ASSERT_FALSE(look.in_view().empty());
  for (const CellInView& c : look.in_view()) {
    const Point at = area.centre(c.cell);
    const double share = (at.x_m * at.x_m + at.y_m * at.y_m + 1600.0) / 1e4;
    EXPECT_NEAR(c.detector.p_detect, 0.962 * (1 - share) + 0.5 * share, 1e-12);
    EXPECT_NEAR(c.detector.p_false, 0.045 * (1 - share) + 0.5 * share, 1e-12);
  }
}

TEST(CameraLook, EllipsesAreThoseOfTheUnscentedTransform) {
  // Beside the transform of this library over the eight errors, one by one.
  const CameraPose pose = looking({2, -3, 40}, 0.7, 1.1, 0.1);
  const Matrix covariance = pose_covariance(0.8, 0.02);
  CameraLook look(infrared(), area);
  ASSERT_TRUE(look.look(pose, covariance));
  gaussian::Moments errors{Vector::Zero(8), Matrix::Zero(8, 8)};
  errors.covariance.topLeftCorner(6, 6) = covariance;
  errors.covariance(6, 6) = errors.covariance(7, 7) = 1.0 / 12;
  for (const CellInView& c : look.in_view()) {
    const Point at = area.centre(c.cell);
    const auto pixel = [&](const Vector& e) {
      CameraPose moved = pose.turned(e.segment<3>(3));
      moved.position_m += e.head<3>();
      return gaussian::project(infrared().lens, moved, {at.x_m + e(6), at.y_m + e(7), 0.0});
    };
    const auto expected = gaussian::unscented(errors, 0.0, pixel);
    const auto ellipse = look.ellipse(c.cell);
    ASSERT_TRUE(expected && ellipse);
    EXPECT_NEAR(ellipse->u, expected->y.mean(0), 1e-9);
    EXPECT_NEAR(ellipse->v, expected->y.mean(1), 1e-9);
    EXPECT_NEAR(ellipse->uu, expected->y.covariance(0, 0) + 0.25, 1e-8);
    EXPECT_NEAR(ellipse->uv, expected->y.covariance(0, 1), 1e-8);
    EXPECT_NEAR(ellipse->vv, expected->y.covariance(1, 1) + 0.25, 1e-8);
  }
}

TEST(MarkedShare, IsTheWeightedSumOverTheEllipse) {
  Stream random = stream("share");
  const SegmentedImage image = image_of([](int u, int v) { return (u / 5 + v / 3) % 3 == 0; });
  for (int trial = 0; trial < 300; ++trial) {
    const double a = random.uniform(0.0, 12), b = random.uniform(0.0, 12);
    const double r = random.uniform(-1.0, 1.0);
    const PixelEllipse at{random.uniform(-5, 245), random.uniform(-5, 325), a * a + 0.25, r * a * b,
                          b * b + 0.25};
    const double determinant = at.uu * at.vv - at.uv * at.uv;
    double marked = 0.0, all = 0.0;
    for (int v = 0; v < 320; ++v) {
      for (int u = 0; u < 240; ++u) {
        const double du = u - at.u, dv = v - at.v;
        const double d2 = (at.vv * du * du - 2 * at.uv * du * dv + at.uu * dv * dv) / determinant;
        if (d2 > 9.0) continue;
        all += std::exp(-d2 / 2);
        if (image.at(u, v)) marked += std::exp(-d2 / 2);
      }
    }
    const auto share = marked_share(image, at);
    ASSERT_EQ(share.has_value(), all > 0.0);
    if (share) {
      EXPECT_NEAR(*share, marked / all, 1e-10);
    }
  }
}

TEST(MarkedShare, OfAnImageThatIsAllOrNothing) {
  const PixelEllipse at{100, 100, 30, 5, 20};
  EXPECT_EQ(marked_share(image_of([](int, int) { return false; }), at), 0.0);
  EXPECT_NEAR(*marked_share(image_of([](int, int) { return true; }), at), 1.0, 1e-12);
  EXPECT_NEAR(*marked_share(image_of([](int u, int) { return u > 100; }), {100.5, 100, 30, 0, 20}),
              0.5, 1e-12);
  EXPECT_FALSE(marked_share(image_of([](int, int) { return true; }), {-50, 100, 30, 5, 20}));
  EXPECT_FALSE(marked_share(image_of([](int, int) { return true; }), {100, 100, 30, 30, 20}));
  EXPECT_FALSE(marked_share(image_of([](int, int) { return true; }), {100, 100, NAN, 0, 20}));
  EXPECT_FALSE(marked_share(image_of([](int, int) { return true; }), {100, 100, 0.2, 0, 20}));
  EXPECT_FALSE(marked_share(SegmentedImage(240, 320), {-9, -9, 12, 0, 12}));  // in the box alone
}

/// p(z|x) of eq. 4.7 by drawing poses, points in the cell and the blur of a pixel.
double sampled_likelihood(const GridCamera& camera, const CameraPose& pose, double sigma_m,
                          double sigma_rad, Point cell, const SegmentedImage& image,
                          const Detector& detector, Stream& random) {
  double sum = 0.0;
  int hits = 0;
  for (int draw = 0; draw < 20000; ++draw) {
    Vector3 shift, turn;
    for (int k = 0; k < 3; ++k) {
      shift(k) = random.normal(0.0, sigma_m);
      turn(k) = random.normal(0.0, sigma_rad);
    }
    CameraPose moved = pose.turned(turn);
    moved.position_m += shift;
    const double x = cell.x_m + random.uniform(-0.5, 0.5), y = cell.y_m + random.uniform(-0.5, 0.5);
    const auto pixel = gaussian::project(camera.lens, moved, {x, y, 0.0});
    if (!pixel) continue;
    const int u = static_cast<int>(std::lround((*pixel)(0) + random.normal(0.0, 0.5)));
    const int v = static_cast<int>(std::lround((*pixel)(1) + random.normal(0.0, 0.5)));
    if (u < 0 || u >= 240 || v < 0 || v >= 320) continue;
    ++hits;
    sum += image.at(u, v) ? detector.p_detect : 1.0 - detector.p_detect;
  }
  return sum / hits;
}

TEST(CameraLook, LikelihoodsAreThoseOfMonteCarloOverPoses) {
  // What remains: the Gaussian for the pixel, its tails beyond 3σ (1.1 %), the draws (1σ 0.3 %).
  Stream random = stream("camera likelihood");
  double worst = 0.0;
  int between = 0;
  for (const double depression : {pi / 2, 1.0}) {
    for (const double sigma_rad : {0.003, 0.02}) {
      const CameraPose pose = looking({0, 0, 40}, 0.4, depression);
      CameraLook look(infrared(), area);
      ASSERT_TRUE(look.look(pose, pose_covariance(0.4, sigma_rad)));
      const SegmentedImage image = disc(110.0, 150.0, 22.0);
      std::vector<CellLook> judged;
      look.judge(image, judged);
      ASSERT_EQ(judged.size(), look.in_view().size());
      for (std::size_t i = 0; i < judged.size(); i += 7) {
        const double share = judged[i].m;
        if (share < 1e-3) continue;
        const Detector& d = look.in_view()[i].detector;
        const double expected = sampled_likelihood(infrared(), pose, 0.4, sigma_rad,
                                                   area.centre(judged[i].cell), image, d, random);
        const double ours = share * d.p_detect + (1 - share) * (1 - d.p_detect);
        worst = std::max(worst, std::fabs(ours - expected));
        EXPECT_NEAR(judged[i].ratio, log_likelihood_ratio(d, share), 1e-14);
        EXPECT_EQ(judged[i].n, 1.0 - share);
        between += share > 0.1 && share < 0.9 ? 1 : 0;
      }
    }
  }
  EXPECT_LT(worst, 0.02);
  EXPECT_GE(between, 5);
}

TEST(CameraLook, SeeingNothingIsInformationAboutTheCellsInView) {
  CameraLook look(infrared(), area);
  ASSERT_TRUE(look.look(looking({0, 0, 40}, 0.0, pi / 2), pose_covariance(0.4, 0.02)));
  std::vector<CellLook> judged;
  look.judge(SegmentedImage(240, 320), judged);
  BernoulliGrid bernoulli(area);
  BetaGrid beta(area);
  add(judged, bernoulli);
  add(judged, beta);
  const std::vector<int> seen = seen_by(look);
  ASSERT_FALSE(seen.empty());
  for (int cell = 0; cell < area.cells(); ++cell) {
    const bool in_view = std::binary_search(seen.begin(), seen.end(), cell);
    EXPECT_EQ(bernoulli.probability(cell) < 0.5, in_view);
    EXPECT_EQ(beta.at(cell).alpha, 1.0);
    EXPECT_EQ(beta.at(cell).beta, in_view ? 2.0 : 1.0);
  }
}

TEST(CameraLook, WithoutKnowledgeOfItsPoseThereIsNothingInView) {
  CameraLook look(infrared(), area);
  Matrix indefinite = pose_covariance(0.4, 0.02);
  indefinite(0, 1) = indefinite(1, 0) = 1.0;
  ASSERT_TRUE(look.look(looking({0, 0, 40}, 0.0, pi / 2), pose_covariance(0.4, 0.02)));
  EXPECT_FALSE(look.look(looking({0, 0, 40}, 0.0, pi / 2), indefinite));
  EXPECT_TRUE(look.in_view().empty());
  EXPECT_TRUE(look.look(looking({0, 0, 40}, 0.0, pi / 2), Matrix::Zero(6, 6)));
  EXPECT_FALSE(look.in_view().empty());
}

TEST(CameraLook, RefusesWhatIsNoCamera) {
  GridCamera camera = infrared();
  camera.sigma_pixel = 0.4;
  EXPECT_THROW(CameraLook(camera, area), BrokenInvariant);
  camera = infrared();
  camera.lens.focal_u = 0.0;
  EXPECT_THROW(CameraLook(camera, area), BrokenInvariant);
  camera = infrared();
  camera.detector.p_detect = 1.0;
  EXPECT_THROW(CameraLook(camera, area), BrokenInvariant);
  camera = infrared();
  camera.range_max_m = HUGE_VAL;
  EXPECT_THROW(CameraLook(camera, area), BrokenInvariant);
  camera = infrared();
  camera.width = 0;
  EXPECT_THROW(CameraLook(camera, area), BrokenInvariant);
  CameraLook look(infrared(), area);
  std::vector<CellLook> judged;
  EXPECT_THROW(look.judge(SegmentedImage(320, 240), judged), BrokenInvariant);
  EXPECT_THROW(look.look(looking({0, 0, 40}, 0.0, 1.0), Matrix::Zero(5, 5)), BrokenInvariant);
  EXPECT_THROW(SegmentedImage(0, 3), BrokenInvariant);
  SegmentedImage image(4, 3);
  EXPECT_THROW(image.mark(4, 0), BrokenInvariant);
  EXPECT_THROW(image.mark(0, -1), BrokenInvariant);
}

TEST(SegmentedImage, KnowsWhereItsMarksAre) {
  SegmentedImage image(10, 8);
  EXPECT_GT(image.marked().u_from, image.marked().u_to);
  image.mark(3, 5);
  image.mark(7, 2);
  EXPECT_TRUE(image.at(3, 5) && image.at(7, 2));
  EXPECT_FALSE(image.at(3, 2));
  EXPECT_EQ(image.marked().u_from, 3);
  EXPECT_EQ(image.marked().u_to, 7);
  EXPECT_EQ(image.marked().v_from, 2);
  EXPECT_EQ(image.marked().v_to, 5);
  image.clear();
  EXPECT_FALSE(image.at(3, 5));
  EXPECT_GT(image.marked().v_from, image.marked().v_to);
}

}  // namespace
}  // namespace hearsay::grid
