#include "stochastic_platoon/ros/observation/road_scene.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace platoon {

using geometry_msgs::Point;
using std_msgs::ColorRGBA;
using visualization_msgs::Marker;

namespace {

constexpr double kPoint = 3.0, kWidth = 1.7;  // [m] length of a drawn point; width of all vehicles
constexpr double kLongestCar = 5.5;           // [m]: longer vehicles have the cabin of such a car at their front
constexpr double kClosed = 0.5;               // share of the desired gap
constexpr double kLane = 3.6;                 // [m]
constexpr double kDash = 4.0, kDashPeriod = 12.0, kPostPeriod = 24.0;
constexpr double kBefore = 60.0, kBehind = 40.0;  // [m] of road beyond the string

ColorRGBA rgba(double r, double g, double b, double a = 1.0) {
  ColorRGBA c;
  c.r = static_cast<float>(r);
  c.g = static_cast<float>(g);
  c.b = static_cast<float>(b);
  c.a = static_cast<float>(a);
  return c;
}

// From dark blue through green and yellow to dark red.
ColorRGBA colour(double share) {
  const auto ramp = [](double x) { return std::clamp(x, 0.0, 1.0); };
  return rgba(share < 0.85 ? ramp(3.0 * share - 1.0) : ramp(1.0 - 3.0 * (share - 0.85)),
              ramp(1.6 - 3.2 * std::abs(share - 0.5)),
              share > 0.15 ? ramp(1.5 - 3.0 * share) : ramp(0.55 + 3.0 * share));
}

ColorRGBA colour_of(std::size_t vehicle, std::size_t vehicles) {
  if (vehicle == 0) return rgba(0.35, 0.35, 0.38);
  const double last = std::max(1.0, static_cast<double>(vehicles) - 2.0);
  return colour((static_cast<double>(vehicle) - 1.0) / last);
}

ColorRGBA mixed(const ColorRGBA& a, const ColorRGBA& b, float share) {
  return rgba(a.r + share * (b.r - a.r), a.g + share * (b.g - a.g), a.b + share * (b.b - a.b), a.a);
}

Point point(double x, double y, double z) {
  Point p;
  p.x = x;
  p.y = y;
  p.z = z;
  return p;
}

class Scene {
public:
  explicit Scene(const ros::Time& time) : time_(time) {}

  // The returned reference is valid until the next call.
  Marker& add(const std::string& name, int type, double x, double y, double z) {
    Marker made;
    made.header.frame_id = "platoon";
    made.header.stamp = time_;
    made.ns = name;
    made.type = type;
    made.pose.orientation.w = 1.0;
    made.scale.x = x;
    made.scale.y = y;
    made.scale.z = z;
    made.color = rgba(1, 1, 1);
    array_.markers.push_back(made);
    return array_.markers.back();
  }

  visualization_msgs::MarkerArray take() { return std::move(array_); }

private:
  ros::Time time_;
  visualization_msgs::MarkerArray array_;
};

// RViz draws lines in their own colours; it shades solids by the camera's light.
Marker& add_lines(Scene& scene, const std::string& name, double width, const ColorRGBA& painted) {
  Marker& lines = scene.add(name, Marker::LINE_LIST, width, 0.0, 0.0);
  lines.color = painted;
  return lines;
}

void add_line(Marker& lines, double from, double to, double y, double z) {
  lines.points.push_back(point(from, y, z));
  lines.points.push_back(point(to, y, z));
}

void add_road(Scene& scene, double from, double to, double travelled) {
  const double middle = 0.5 * (from + to);
  Marker& ground = scene.add("ground", Marker::CUBE, to - from, 40.0 * kLane, 0.02);
  ground.pose.position = point(middle, 0.0, -0.5);
  ground.color = rgba(0.9, 1.0, 0.8);
  Marker& road = scene.add("road", Marker::CUBE, to - from, 2.2 * kLane, 0.02);
  road.pose.position = point(middle, 0.5 * kLane, -0.03);
  road.color = rgba(0.42, 0.43, 0.46);
  const ColorRGBA white = rgba(0.95, 0.95, 0.95);
  Marker& edges = add_lines(scene, "edges", 0.18, white);
  for (const double y : {-0.5 * kLane, 1.5 * kLane}) add_line(edges, from, to, y, 0.0);
  // Calls `place` for the marks in sight, at whole periods of the distance travelled.
  const auto each = [&](double period, const auto& place) {
    for (double mark = std::ceil((from + travelled) / period) * period; mark - travelled <= to; mark += period)
      place(mark - travelled);
  };
  Marker& dashes = add_lines(scene, "dashes", 0.18, white);
  each(kDashPeriod, [&](double x) { add_line(dashes, x - 0.5 * kDash, x + 0.5 * kDash, 0.5 * kLane, 0.0); });
  Marker& posts = scene.add("posts", Marker::CUBE_LIST, 0.2, 0.2, 1.0);
  posts.color = white;
  each(kPostPeriod, [&](double x) {
    for (const double y : {-0.85 * kLane, 1.85 * kLane}) posts.points.push_back(point(x, y, 0.5));
  });
}

double drawn_length(const SceneVehicle& vehicle) {
  return vehicle.length > 0.0 ? vehicle.length : kPoint;
}

// Desired position of each vehicle, plus and minus two standard deviations, and the closing gaps.
void add_places(Scene& scene, const std::vector<SceneVehicle>& vehicles) {
  int id = 0;
  for (std::size_t i = 1; i < vehicles.size(); ++i) {
    const SceneVehicle& vehicle = vehicles[i];
    if (!std::isfinite(vehicle.place) || !std::isfinite(vehicle.deviation)) continue;
    Marker& band = add_lines(scene, "two_sigma", 0.3, mixed(colour_of(i, vehicles.size()), rgba(1, 1, 1), 0.3F));
    band.id = ++id;
    // In two rows, as the bands of neighbours overlap; no shorter than a vehicle's mark.
    const double y = -0.5 * kLane - (i % 2 == 0 ? 0.55 : 1.05), half = std::max(2.0 * vehicle.deviation, 0.1);
    add_line(band, vehicle.place - half, vehicle.place + half, y, 0.05);
    add_line(band, vehicle.x - 0.08, vehicle.x + 0.08, y, 0.3);
  }
  Marker& gaps = add_lines(scene, "closing", kWidth, rgba(0.95, 0.05, 0.05));
  for (std::size_t i = 1; i < vehicles.size(); ++i) {
    if (!vehicles[i].closing) continue;
    const double front = vehicles[i].x, rear = vehicles[i - 1].x - drawn_length(vehicles[i - 1]);
    add_line(gaps, std::min(front, rear - 0.2), std::max(front, rear), 0.0, 0.1);
  }
  if (gaps.points.empty()) gaps.action = Marker::DELETE;
}

// All vehicles of one length: the solids of a list have one size.
void add_vehicles(Scene& scene, const std::vector<SceneVehicle>& vehicles, double length, int id) {
  const double cabin = std::min(length, kLongestCar);
  const auto list = [&](const std::string& name, int type, double x, double y, double z, const auto& each) {
    Marker& made = scene.add(name, type, x, y, z);
    made.id = id;
    for (std::size_t i = 0; i < vehicles.size(); ++i)
      if (drawn_length(vehicles[i]) == length) each(made, vehicles[i].x, colour_of(i, vehicles.size()));
  };
  const auto put = [](Marker& made, double x, double y, double z, const ColorRGBA& painted) {
    made.points.push_back(point(x, y, z));
    made.colors.push_back(painted);
  };
  list("bodies", Marker::CUBE_LIST, length, kWidth, 0.65,
       [&](Marker& made, double front, const ColorRGBA& own) { put(made, front - 0.5 * length, 0.0, 0.62, own); });
  list("windows", Marker::CUBE_LIST, 0.56 * cabin, 0.9 * kWidth, 0.42,
       [&](Marker& made, double front, const ColorRGBA&) {
         put(made, front - 0.6 * cabin, 0.0, 1.12, rgba(0.13, 0.16, 0.20));
       });
  list("roofs", Marker::CUBE_LIST, 0.5 * cabin, 0.88 * kWidth, 0.1,
       [&](Marker& made, double front, const ColorRGBA& own) {
         put(made, front - 0.6 * cabin, 0.0, 1.37, mixed(own, rgba(1, 1, 1), 0.15F));
       });
  list("lights", Marker::CUBE_LIST, 0.06, 0.35, 0.18, [&](Marker& made, double front, const ColorRGBA&) {
    for (const double y : {-0.34 * kWidth, 0.34 * kWidth}) {
      put(made, front, y, 0.66, rgba(1.0, 0.97, 0.75));
      put(made, front - length, y, 0.66, rgba(0.75, 0.05, 0.05));
    }
  });
  list("wheels", Marker::SPHERE_LIST, 0.66, 0.3, 0.66, [&](Marker& made, double front, const ColorRGBA&) {
    for (const double along : {0.19 * cabin, length - 0.19 * cabin}) {
      for (const double y : {-0.47 * kWidth, 0.47 * kWidth}) put(made, front - along, y, 0.33, rgba(0.06, 0.06, 0.07));
    }
  });
}

void add_vehicles(Scene& scene, const std::vector<SceneVehicle>& vehicles) {
  std::set<double> lengths;
  for (const SceneVehicle& vehicle : vehicles) lengths.insert(drawn_length(vehicle));
  int id = 0;
  for (const double length : lengths) add_vehicles(scene, vehicles, length, id++);
}

// An arc beside the road from each vehicle that is heard across others.
void add_links(Scene& scene, const std::vector<SceneVehicle>& vehicles) {
  constexpr int kPieces = 16;
  int id = 0;
  for (std::size_t i = 0; i < vehicles.size(); ++i) {
    if (vehicles[i].hears.empty()) continue;
    Marker& arcs = add_lines(scene, "links", 0.12, mixed(colour_of(i, vehicles.size()), rgba(1, 1, 1), 0.3F));
    arcs.id = ++id;
    for (const std::size_t source : vehicles[i].hears) {
      const double from = vehicles[source].x, to = vehicles[i].x, high = 1.0 + 0.15 * std::abs(from - to);
      const auto at = [&](int piece) {
        const double share = static_cast<double>(piece) / kPieces;
        return point(from + share * (to - from), 0.5 * kWidth, 1.4 + 4.0 * high * share * (1.0 - share));
      };
      for (int piece = 0; piece < kPieces; ++piece) {
        arcs.points.push_back(at(piece));
        arcs.points.push_back(at(piece + 1));
      }
    }
  }
}

void add_labels(Scene& scene, const std::vector<SceneVehicle>& vehicles) {
  int id = 0;
  for (const SceneVehicle& vehicle : vehicles) {
    ++id;
    if (vehicle.label.empty()) continue;
    Marker& label = scene.add("labels", Marker::TEXT_VIEW_FACING, 0.0, 0.0, 1.25);
    label.id = id;
    label.pose.position = point(vehicle.x - 0.5 * drawn_length(vehicle), 0.45 * kLane, 2.3);
    label.color = rgba(1.0, 1.0, 1.0);
    label.text = vehicle.label;
  }
}

}  // namespace

bool is_closing(double gap, double error) {
  return gap < kClosed * (gap - error);
}

visualization_msgs::MarkerArray road_scene(const std::vector<SceneVehicle>& vehicles, double travelled,
                                           const ros::Time& time) {
  Scene scene(time);
  const auto [last, first] =
      std::minmax_element(vehicles.begin(), vehicles.end(), [](const auto& a, const auto& b) { return a.x < b.x; });
  add_road(scene, last->x - kBehind, first->x + kBefore, travelled);
  add_places(scene, vehicles);
  add_vehicles(scene, vehicles);
  add_links(scene, vehicles);
  add_labels(scene, vehicles);
  return scene.take();
}

}  // namespace platoon
