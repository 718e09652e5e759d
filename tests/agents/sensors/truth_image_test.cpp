// Images of cells, beside rays through every pixel.
#include "agents/sensors/truth_image.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

using grid::Area;
using grid::GridCamera;
using grid::SegmentedImage;

const double pi = std::acos(-1.0);

/// An odd number of pixels: the last one has half a word.
GridCamera camera() {
  return {.lens = {40.0, 42.0, 18.3, 12.1, 0.7},
          .width = 37,
          .height = 25,
          .detector = {0.9, 0.05},
          .range_max_m = 100.0};
}
/// Sees what is there, and within a kilometre nothing else.
GridCamera sharp_camera() {
  GridCamera sharp = camera();
  sharp.detector = {1.0 - 1e-12, 1e-12};
  sharp.range_max_m = 1e7;
  return sharp;
}

Stream draws_of(std::uint64_t count) {
  return Stream::at(1, Purpose("pixels"), Entity::agent(0), count);
}
Stream random_of(std::string_view purpose) { return Stream(1, Purpose(purpose), Entity::agent(0)); }

std::vector<unsigned char> random_truth(const Area& area, double share, Stream& random) {
  std::vector<unsigned char> truth(static_cast<std::size_t>(area.cells()));
  for (unsigned char& cell : truth) cell = random.bernoulli(share) ? 1 : 0;
  return truth;
}

/// Where a pixel's ray meets the plane.
struct Ground {
  double distance_m;
  std::optional<int> cell;
};
std::optional<Ground> ground_at(const GridCamera& c, const gaussian::CameraPose& pose,
                                const Area& area, int u, int v) {
  gaussian::Vector pixel(2);
  pixel << u, v;
  const gaussian::Ray ray = gaussian::ray_through(c.lens, pose, pixel);
  if (!(ray.direction(2) < 0.0) || !(ray.origin_m(2) > c.ground_m)) return std::nullopt;
  const double distance = (c.ground_m - ray.origin_m(2)) / ray.direction(2);
  const gaussian::Vector3 at = ray.origin_m + distance * ray.direction;
  return Ground{distance, area.at({at(0), at(1)})};
}
bool shows(const std::optional<Ground>& ground, const std::vector<unsigned char>& truth) {
  return ground && ground->cell && truth[static_cast<std::size_t>(*ground->cell)] != 0;
}

std::vector<bool> marks(const SegmentedImage& image) {
  std::vector<bool> all;
  for (int v = 0; v < image.height(); ++v) {
    for (int u = 0; u < image.width(); ++u) all.push_back(image.at(u, v));
  }
  return all;
}

TEST(TruthImage, ShowsTrueCellsWhereRaysMeetThem) {
  Stream random = random_of("rays");
  int shown = 0, compared = 0, outside_centre = 0;
  for (std::uint64_t trial = 0; trial < 300; ++trial) {
    const Area area({.columns = 40, .rows = 30, .cell_m = random.uniform(0.3, 8.0)});
    GridCamera c = sharp_camera();
    c.ground_m = random.uniform(-3.0, 3.0);
    TruthImage image(c, random.uniform(0.1, pi / 2), area);
    const Point place{random.uniform(-20, 100), random.uniform(-20, 80), random.uniform(-4, 40)};
    const double heading = random.uniform(-pi, pi);
    const auto truth = random_truth(area, random.uniform(0.0, 0.6), random);
    const SegmentedImage& drawn = image.draw(place, heading, truth, draws_of(trial));
    for (int v = 0; v < c.height; ++v) {
      for (int u = 0; u < c.width; ++u) {
        const auto ground = ground_at(c, image.pose(place, heading), area, u, v);
        if (!ground || ground->distance_m > 1e3) continue;
        ASSERT_EQ(drawn.at(u, v), shows(ground, truth)) << trial << ": " << u << ", " << v;
        ++compared;
        if (!drawn.at(u, v)) continue;
        ++shown;
        const grid::Point centre = area.centre(*ground->cell);
        const auto pixel = gaussian::project(c.lens, image.pose(place, heading),
                                             {centre.x_m, centre.y_m, c.ground_m});
        if (!pixel || (*pixel)(0) < -0.5 || (*pixel)(1) < -0.5) ++outside_centre;
      }
    }
  }
  EXPECT_GT(compared, 100000);
  EXPECT_GT(shown, 10000);
  EXPECT_GT(outside_centre, 50);
}

// Straight down, and so flat that upper rows look beyond the range and over the horizon.
TEST(TruthImage, PixelsAreMarkedByTheProbabilitiesOfTheirDistance) {
  const Area area({.columns = 40, .rows = 40, .cell_m = 10, .x_m = -200, .y_m = -200});
  const std::vector<unsigned char> nothing(1600, 0), all(1600, 1);
  const int images = 2000;
  int faded = 0, half = 0;
  for (const double depression : {pi / 2, 0.2}) {
    const GridCamera c = camera();
    TruthImage image(c, depression, area);
    const Point place{3.0, -2.0, 30.0};
    for (const auto* truth : {&nothing, &all}) {
      std::vector<int> marked(925, 0);
      for (int k = 0; k < images; ++k) {
        const auto is = marks(image.draw(place, 0.4, *truth, draws_of(std::uint64_t(k))));
        for (std::size_t i = 0; i < is.size(); ++i) marked[i] += is[i] ? 1 : 0;
      }
      for (int i = 0; i < 925; ++i) {
        const auto ground = ground_at(c, image.pose(place, 0.4), area, i % 37, i / 37);
        const double distance = ground ? ground->distance_m : 1e9;
        const double rho = std::min(1.0, distance * distance / 1e4);
        const double p = (truth == &all ? 0.9 : 0.05) * (1.0 - rho) + 0.5 * rho;
        ASSERT_NEAR(marked[std::size_t(i)], images * p, 5 * std::sqrt(images * p * (1 - p)))
            << i << " at " << distance << " m";
        ++(rho < 1.0 ? faded : half);
      }
    }
  }
  EXPECT_GT(faded, 2000);
  EXPECT_GT(half, 500);
}

TEST(TruthImage, DrawsOfPixelsDoNotDependOnWhatIsTrueElsewhere) {
  const Area area({.columns = 20, .rows = 20, .cell_m = 2.0});
  TruthImage image(camera(), 1.2, area);
  const Point place{8.0, 20.0, 25.0};
  Stream random = random_of("elsewhere");
  int changed = 0;
  for (std::uint64_t trial = 0; trial < 100; ++trial) {
    const auto a = random_truth(area, 0.2, random), b = random_truth(area, 0.2, random);
    const auto of_a = marks(image.draw(place, 0.3, a, draws_of(trial)));
    const auto of_b = marks(image.draw(place, 0.3, b, draws_of(trial)));
    for (std::size_t i = 0; i < of_a.size(); ++i) {
      const auto ground =
          ground_at(camera(), image.pose(place, 0.3), area, int(i) % 37, int(i) / 37);
      const bool a_shows = shows(ground, a), b_shows = shows(ground, b);
      if (a_shows == b_shows) {
        ASSERT_EQ(of_a[i], of_b[i]);
      } else {
        // The same draw: what is marked where nothing is, is marked where something is.
        ASSERT_TRUE(of_a[i] == of_b[i] || of_a[i] == a_shows);
        changed += of_a[i] != of_b[i] ? 1 : 0;
      }
    }
  }
  EXPECT_GT(changed, 1000);
}

TEST(TruthImage, PixelsOfAnImageAreIndependent) {
  const Area area({.columns = 2, .rows = 2});
  GridCamera c = camera();
  c.detector = {0.9, 0.3};
  c.range_max_m = 1e6;
  TruthImage image(c, pi / 2, area);
  const std::vector<unsigned char> nothing(4, 0);
  // Neighbours in a row, in one word or in two; below each other; in one image and the next.
  const int images = 400;
  double beside_even = 0, beside_odd = 0, below = 0, next = 0;
  std::vector<bool> last;
  for (int k = 0; k < images; ++k) {
    const auto is = marks(image.draw({50, 50, 10}, 0, nothing, draws_of(std::uint64_t(k))));
    const auto by = [&](std::size_t i) { return is[i] ? 0.7 : -0.3; };
    for (std::size_t i = 0; i + 1 < is.size(); ++i) {
      (i % 2 == 0 ? beside_even : beside_odd) += by(i) * by(i + 1);
    }
    for (std::size_t i = 0; i + 37 < is.size(); ++i) below += by(i) * by(i + 37);
    if (k > 0) {
      for (std::size_t i = 0; i < is.size(); ++i) next += by(i) * (last[i] ? 0.7 : -0.3);
    }
    last = is;
  }
  // A sum of n products of variance 0.21².
  const auto bound = [&](double n) { return 4 * 0.21 * std::sqrt(n * images); };
  EXPECT_LT(std::fabs(beside_even), bound(462));
  EXPECT_LT(std::fabs(beside_odd), bound(462));
  EXPECT_LT(std::fabs(below), bound(888));
  EXPECT_LT(std::fabs(next), bound(925));
}

TEST(TruthImage, WhatItKeepsFromLookToLookChangesNothing) {
  const Area area({.columns = 30, .rows = 30, .cell_m = 2.0});
  Stream random = random_of("kept");
  TruthImage kept(camera(), 1.0, area);
  for (std::uint64_t trial = 0; trial < 50; ++trial) {
    const auto truth = random_truth(area, 0.3, random);
    const Point place{random.uniform(0, 60), random.uniform(0, 60),
                      random.bernoulli(0.5) ? 20.0 : random.uniform(5, 50)};
    const double heading = random.uniform(-pi, pi);
    TruthImage fresh(camera(), 1.0, area);
    ASSERT_EQ(marks(kept.draw(place, heading, truth, draws_of(trial))),
              marks(fresh.draw(place, heading, truth, draws_of(trial))));
  }
}

TEST(TruthImage, RefusesWhatItCannotDraw) {
  const Area area({.columns = 3, .rows = 3});
  const std::vector<unsigned char> truth(9, 0);
  EXPECT_THROW(TruthImage(camera(), -0.1, area), BrokenInvariant);
  EXPECT_THROW(TruthImage(camera(), 1.6, area), BrokenInvariant);
  GridCamera large = camera();
  large.width = large.height = 512;
  EXPECT_NO_THROW(TruthImage(large, 1.0, area));
  large.width = 513;
  EXPECT_THROW(TruthImage(large, 1.0, area), BrokenInvariant);
  GridCamera flat = camera();
  flat.lens.focal_u = 0.0;
  EXPECT_THROW(TruthImage(flat, 1.0, area), BrokenInvariant);
  TruthImage image(camera(), 1.0, area);
  EXPECT_THROW(image.draw({0, 0, 10}, 0, std::vector<unsigned char>(8, 0), draws_of(0)),
               BrokenInvariant);
  EXPECT_THROW(image.draw({0, NAN, 10}, 0, truth, draws_of(0)), BrokenInvariant);
  EXPECT_THROW(image.draw({0, 0, 10}, INFINITY, truth, draws_of(0)), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay
