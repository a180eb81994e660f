#include <cmath>
#include <limits>

#include <catch2/catch.hpp>

#include "base/exponentials.h"
#include "base/random.h"
#include "fabmap/model.h"
#include "support.h"

using namespace vpr;

TEST_CASE("the posterior is normalized, smoothed, and has the new place first") {
  const std::vector<double> log_p = {-1000, -1000 + std::log(3)};
  const auto posterior = fabmap_posterior(log_p, -1000 + std::log(4), {}, {});
  REQUIRE(posterior.size() == 3);
  CHECK(posterior[0] == Approx(0.99 * 4 / 8 + 0.01 / 3));
  CHECK(posterior[1] == Approx(0.99 * 1 / 8 + 0.01 / 3));
  CHECK(posterior[2] == Approx(0.99 * 3 / 8 + 0.01 / 3));
}

TEST_CASE("the motion model favors neighbors, computed by hand") {
  PosteriorSettings settings;
  settings.smoothing = 1;
  settings.motion_model = true;
  const std::vector<double> equal = {0, 0, 0};
  const std::vector<double> previous = {0.1, 0.6, 0.2, 0.1};  // new place, views
  // b = 0.5: (p[i-1] + p[i] + p[i+1]) / 3, where ends replace missing neighbors: 1.4/3, 0.9/3,
  // 0.4/3; new: 0.9.
  const auto posterior = fabmap_posterior(equal, 0, previous, settings);
  const double sum = 1.4 / 3 + 0.9 / 3 + 0.4 / 3 + 0.9;
  CHECK(posterior[0] == Approx(0.9 / sum));
  CHECK(posterior[1] == Approx(1.4 / 3 / sum));
  CHECK(posterior[3] == Approx(0.4 / 3 / sum));
  // Without a previous frame, or with a single view, there is no motion.
  CHECK(fabmap_posterior(equal, 0, {}, settings)[1] == Approx(0.25));
  CHECK(fabmap_posterior(std::vector<double>{0}, 0, std::vector<double>{0.5, 0.5}, settings)[1] ==
        Approx(0.5));
}

TEST_CASE("a view is recognized after c_w consecutive frames strictly above t_p") {
  ViewWindow window;
  const auto add = [&](std::vector<double> posterior) { window.add(posterior, 0.5, 2); };
  add({0, 0.6, 0.5});
  CHECK(window.run == std::vector<uint32_t>{1, 0});
  add({0, 0.6, 0.51});
  CHECK(window.run == std::vector<uint32_t>{2, 1});
  add({});  // an unreadable frame
  CHECK(window.run == std::vector<uint32_t>{0, 0});
}

TEST_CASE("exponentials equal those of the standard library on every SIMD target") {
  RandomEngine engine(3);
  for (const size_t count : {1, 2, 7, 8, 9, 16, 100, 1001}) {
    std::vector<double> logs(count);
    for (double& value : logs) value = -1000 * uniform_unit(engine) * uniform_unit(engine) - 5000;
    logs[count / 2] = -4999;
    if (count > 2) logs[1] = -std::numeric_limits<double>::infinity();
    std::vector<double> found = logs;
    const double sum = exponentiate(found);
    double expected_sum = 0;
    for (size_t i = 0; i < count; ++i) {
      const double expected = std::exp(logs[i] + 4999);
      expected_sum += expected;
      if (logs[i] + 4999 < -690)
        REQUIRE(found[i] == 0);
      else
        REQUIRE(found[i] == Approx(expected).epsilon(1e-15));
    }
    CHECK(sum == Approx(expected_sum).epsilon(1e-14));
    for (const std::string& target : simd_targets()) {
      const test::ChosenTarget chosen(target);
      std::vector<double> again = logs;
      CHECK(exponentiate(again) == sum);
      CHECK(again == found);
    }
  }
}

TEST_CASE("logarithms are those of the library") {
  CHECK(natural_logarithm(1) == 0);
  for (double x = 1e-300; x < 1e300; x *= 1.37)
    CHECK(natural_logarithm(x) == Approx(std::log(x)).epsilon(1e-15).margin(1e-16));
}
