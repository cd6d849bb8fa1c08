#include "stochastic_platoon/ros/observation/road_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace platoon {
namespace {

using visualization_msgs::Marker;

const double kNone = std::nan("");

std::vector<Marker> named(const visualization_msgs::MarkerArray& scene, const std::string& name) {
  std::vector<Marker> found;
  std::copy_if(scene.markers.begin(), scene.markers.end(), std::back_inserter(found),
               [&name](const Marker& marker) { return marker.ns == name; });
  return found;
}

TEST(RoadScene, VehiclesHaveTheirLengthsBehindTheirPositions) {
  const auto scene = road_scene({{0.0, 4.5, kNone, kNone, false, ""},
                                 {-30.0, 16.5, kNone, kNone, false, ""},
                                 {-60.0, 4.5, kNone, kNone, false, ""},
                                 {-90.0, 0.0, kNone, kNone, false, ""}},
                                100.0, ros::Time(1.0));
  std::vector<std::pair<double, double>> bodies;  // front and rear
  std::vector<int> ids;
  for (const Marker& of : named(scene, "bodies")) {
    ids.push_back(of.id);
    for (const auto& middle : of.points) bodies.emplace_back(middle.x + 0.5 * of.scale.x, middle.x - 0.5 * of.scale.x);
  }
  std::sort(bodies.rbegin(), bodies.rend());
  EXPECT_EQ(bodies,
            (std::vector<std::pair<double, double>>{{0.0, -4.5}, {-30.0, -46.5}, {-60.0, -64.5}, {-90.0, -93.0}}));
  std::sort(ids.begin(), ids.end());
  EXPECT_EQ(ids, (std::vector<int>{0, 1, 2})) << "RViz replaces a marker of the same name and id";
  std::vector<double> lights;
  for (const Marker& of : named(scene, "lights")) {
    for (const auto& light : of.points) lights.push_back(light.x);
  }
  EXPECT_EQ(*std::min_element(lights.begin(), lights.end()), -93.0);
  EXPECT_EQ(std::count(lights.begin(), lights.end(), -46.5), 2);
  for (const char* name : {"windows", "roofs", "wheels"}) {
    for (const Marker& of : named(scene, name)) {
      for (const auto& part : of.points) {
        const double front = 30.0 * std::ceil(part.x / 30.0);
        EXPECT_LE(part.x + 0.5 * of.scale.x, front) << name;
      }
    }
  }
}

TEST(RoadScene, AClosingGapReachesFromTheRearAheadToTheFront) {
  const auto scene = road_scene({{0.0, 12.0, kNone, kNone, false, ""},
                                 {-13.0, 4.0, kNone, kNone, true, ""},
                                 {-40.0, 4.0, kNone, kNone, false, ""}},
                                0.0, ros::Time(1.0));
  const std::vector<Marker> gaps = named(scene, "closing");
  ASSERT_EQ(gaps.size(), 1u);
  ASSERT_EQ(gaps[0].points.size(), 2u);
  EXPECT_EQ(gaps[0].points[0].x, -13.0);
  EXPECT_EQ(gaps[0].points[1].x, -12.0);
}

TEST(RoadScene, AGapClosesBelowHalfOfItsDesiredValue) {
  EXPECT_FALSE(is_closing(10.0, 0.0));
  EXPECT_FALSE(is_closing(5.1, -4.9));  // 10 m desired
  EXPECT_TRUE(is_closing(4.9, -5.1));
  EXPECT_TRUE(is_closing(-1.0, -11.0));
  EXPECT_FALSE(is_closing(30.0, 20.0));
}

TEST(RoadScene, AnArcLeadsFromEveryVehicleThatIsHeardAcrossOthers) {
  std::vector<SceneVehicle> vehicles{{0.0, 4.5, kNone, kNone, false, ""},
                                     {-20.0, 4.5, kNone, kNone, false, ""},
                                     {-40.0, 4.5, kNone, kNone, false, ""}};
  EXPECT_TRUE(named(road_scene(vehicles, 0.0, ros::Time(1.0)), "links").empty());
  vehicles[2].hears = {0};
  const std::vector<Marker> links = named(road_scene(vehicles, 0.0, ros::Time(1.0)), "links");
  ASSERT_EQ(links.size(), 1u);
  EXPECT_EQ(links.front().points.front().x, 0.0);
  EXPECT_EQ(links.front().points.back().x, -40.0);
  const auto higher = [](const auto& one, const auto& other) { return one.z < other.z; };
  EXPECT_GT(std::max_element(links.front().points.begin(), links.front().points.end(), higher)->z, 2.0);
}

}  // namespace
}  // namespace platoon
