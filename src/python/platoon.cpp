// The extension module stochastic_platoon._platoon: models, theory and Monte Carlo, without ROS. The package around it,
// in the folder stochastic_platoon, gives it names, types and documentation.

#include <pybind11/functional.h>
#include <pybind11/stl.h>

#include <cmath>
#include <exception>
#include <set>
#include <thread>

#include "python/convert.hpp"
#include "python/interruption.hpp"
#include "python/model.hpp"
#include "stochastic_platoon/math/model/formation.hpp"
#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/model/vehicle.hpp"
#include "stochastic_platoon/run/configuration/settings.hpp"
#include "stochastic_platoon/run/configuration/shipped_files.hpp"
#include "stochastic_platoon/run/configuration/version.hpp"
#include "stochastic_platoon/run/configuration/yaml_file.hpp"
#include "stochastic_platoon/run/io/atomic_file.hpp"
#include "stochastic_platoon/run/io/read_file.hpp"
#include "stochastic_platoon/run/report/analysis_report.hpp"
#include "stochastic_platoon/run/report/plausibility.hpp"
#include "stochastic_platoon/run/report/stability_map.hpp"
#include "stochastic_platoon/run/report/string_text.hpp"
#include "stochastic_platoon/run/results/result_check.hpp"
#include "stochastic_platoon/run/results/result_files.hpp"
#include "stochastic_platoon/run/results/run_report.hpp"
#include "stochastic_platoon/run/results/trajectories_csv.hpp"
#include "stochastic_platoon/run/scaling/rare_run.hpp"
#include "stochastic_platoon/run/scaling/whole_run.hpp"

namespace platoon::python {

namespace {

using Settings = std::map<std::string, std::string>;

// With keys, only these are computed, without a report.
py::tuple analyze_model(const Model& model, const Settings& settings, const std::string& signals,
                        const std::string& collision_probability, const std::set<std::string>& keys) {
  ProblemCollector problems;
  const auto configuration = problems.result_of([&] { return model.configuration(settings); });
  const auto request = problems.result_of([&] { return signal_request(signals, collision_probability); });
  problems.require_none();
  const auto [document, text] = unlocked([&] {
    const Analysis analysis = analyze(
        *configuration, *request, [](const char*) {}, keys);
    return std::pair(to_json(*configuration, analysis), keys.empty() ? report(*configuration, analysis) : "");
  });
  return py::make_tuple(object_of(document), text);
}

py::dict stability_map(const Model& model, const std::vector<double>& headways, const std::vector<double>& gains,
                       const std::vector<double>& losses, const std::vector<double>& bursts) {
  return dict_of(unlocked([&] {
    const PlatoonModel& given = model.model();
    return parse_csv(to_csv(stability_map(given, {headways, gains, losses, bursts}), given.sample_period), "map");
  }));
}

/// Settings of a computation that an exception of a callback, or Ctrl-C, stops; it is to be raised at the end.
struct Supervision {
  std::exception_ptr raised;
  ShardSettings how;

  Supervision(unsigned threads, double checkpoint_seconds, const std::function<void(std::uint64_t)>& progress,
              const std::function<void(std::string)>& warn) {
    how.threads = threads > 0 ? threads : std::max(std::thread::hardware_concurrency(), 1u);
    how.checkpoint_seconds = checkpoint_seconds;
    how.progress = [this, progress](std::uint64_t done) {
      if (raised) return;
      const py::gil_scoped_acquire lock;
      try {
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        progress(done);
      } catch (...) {
        raised = std::current_exception();
      }
    };
    how.stop = [this] { return raised != nullptr; };
    how.stop_seconds = 0.3;
    how.warn = [warn](const std::string& text) {
      const py::gil_scoped_acquire lock;
      warn(text);
    };
  }
};

py::tuple monte_carlo_of(const Model& model, Settings settings, unsigned threads, double checkpoint_seconds,
                         const std::function<void(std::uint64_t)>& progress,
                         const std::function<void(std::string)>& warn) {
  add_monte_carlo_batch(settings);
  Configuration configuration = model.configuration(settings);
  configuration.run.hosting = Hosting::monte_carlo;
  if (configuration.run.averaging() == Averaging::over_time)
    throw ConfigurationError({"steps: 0: must be at least 1 for a Monte Carlo"});
  Supervision supervised(threads, checkpoint_seconds, progress, warn);
  if (!configuration.run.output.empty()) require_writable_folder(configuration.run.output);
  std::string text, unsaved;
  ResultTables tables;
  unlocked([&] {
    const WholeRun run = compute_run(configuration, supervised.how);
    unsaved = run.unsaved;
    if (supervised.raised) return;
    const auto files = result_files(configuration, run.prediction, run.result);
    tables = parse_results([&](const std::string& name) { return files.at(name); }, "monte_carlo");
    text = report(configuration, run.prediction, run.result);
  });
  if (supervised.raised) std::rethrow_exception(supervised.raised);
  return py::make_tuple(plain_object_of(tables.summary), dict_of(std::move(tables.tables)), text, unsaved);
}

py::tuple rare_of(const Model& model, const Settings& settings, const Settings& options, unsigned threads,
                  double checkpoint_seconds, const std::function<void(std::uint64_t, std::uint64_t)>& progress,
                  const std::function<void(std::string)>& warn) {
  ProblemCollector problems;
  const auto found = problems.result_of([&] { return model.configuration(settings); });
  const auto given = problems.result_of([&] { return rare_options(options); });
  problems.require_none();
  Configuration configuration = *found;
  configuration.run.hosting = Hosting::monte_carlo;
  std::uint64_t samples = 0;
  Supervision supervised(
      threads, checkpoint_seconds, [&](std::uint64_t done) { progress(done, samples); }, warn);
  const RareRun run = unlocked([&] { return rare_run(configuration, *given, supervised.how.threads); });
  require_an_estimate(run);
  samples = run.samples();
  const RareResult result = unlocked([&] { return compute_rare(run, supervised.how); });
  if (supervised.raised) std::rethrow_exception(supervised.raised);
  return py::make_tuple(plain_object_of(nlohmann::json::parse(result.files.at("rare.json"))), result.report);
}

// (seconds of the steps, {quantity: positions of vehicles 0, 1, ... in turn, step by step}).
py::tuple trajectories_of(const Model& model, const Settings& settings, std::uint64_t realization) {
  const Configuration configuration = model.configuration(settings);
  auto found = unlocked([&] { return trajectory_columns(configuration, realization); });
  py::dict quantities;
  for (auto& [name, values] : found.quantities) quantities[py::cast(name)] = array_of(std::move(values));
  return py::make_tuple(array_of(std::move(found.seconds)), quantities);
}

py::object json_of(const std::string& file) {
  // The conversion to Python objects is recursive.
  constexpr int kDeepest = 100;
  const auto require_shallow = [&file](int depth, nlohmann::json::parse_event_t, const nlohmann::json&) {
    check_interruption();
    if (depth > kDeepest) throw std::invalid_argument(file + ": nested too deep: must be at most 100 levels");
    return true;
  };
  nlohmann::json document =
      unlocked([&] { return parse_json(read_file(file, kMostWrittenBytes), file, require_shallow); });
  document.erase("crc32");
  return object_of(document);
}

py::dict vehicle_of(const Model& model, std::size_t index) {
  const VehicleModel& of = vehicle(model.model(), index);
  const LinkModel& link = of.varied_link();
  nlohmann::json document = to_json(of.loop.realization);
  document["time_headway"] = of.headway;
  document["standstill_distance"] = of.standstill_distance;
  document["vehicle_length"] = of.length;
  document["noise_variance"] = of.position().noise_variance;
  document["place"] = start_place(model.model(), index);
  document["speed"] = start_slope(model.model()) / model.model().sample_period;
  document["loss_probability"] = link.loss ? nlohmann::json(link.loss->probability) : nlohmann::json();
  return object_of(document);
}

// What the manoeuvres of the leader are; null: without bound.
py::object manoeuvres_of(const Model& model) {
  const ManoeuvreBounds of = LeaderVehicle(model.model()).manoeuvre().bounds();
  const auto interval = [](const Interval& values) {
    const auto bound = [](double value) { return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(); };
    return nlohmann::json{bound(values.lower), bound(values.upper)};
  };
  return plain_object_of({{"speed", interval(of.speed)},
                          {"acceleration", interval(of.acceleration)},
                          {"brake", {{"acceleration", of.braking}}},
                          {"accelerate", {{"acceleration", of.speed_up}, {"speed", of.speed_added}}},
                          {"cruise", {{"acceleration", interval(of.back)}}},
                          {"sinusoid", {{"speed", of.amplitude}, {"seconds", of.seconds}}}});
}

// G(z) of the default vehicle: numerator and denominator by descending powers of z.
py::tuple plant_of(const Model& model) {
  const std::optional<LoopDesign>& design = model.model().default_vehicle().design;
  if (!design) throw std::invalid_argument("closed_loop: given: must be plant and controller");
  const SampledPlant plant = design->plant.sampled();
  const auto coefficients = [](const Polynomial& p) {
    return array_of(std::vector<double>(p.data(), p.data() + p.size()));
  };
  return py::make_tuple(coefficients(plant.numerator), coefficients(plant.denominator));
}

}  // namespace

PYBIND11_MODULE(_platoon, module) {
  register_exceptions();
  module.attr("version") = kVersion;
  module.attr("fastest_car") = kFastestCar;
  module.attr("hardest") = kHardest;
  module.attr("signals") = all_signal_names();
  module.attr("reversing") = kReversing;
  module.def(
      "shipped_file", [](const std::string& name, const std::string& folder) { return shipped_file(name, folder); },
      py::arg("name"), py::arg("folder"));

  py::class_<Model>(module, "Model")
      .def_static("load", &Model::load, py::arg("file"))
      .def_static("parse", &Model::parse, py::arg("text"))
      .def("replaced", &Model::replaced, py::arg("changes"))
      .def("document", [](const Model& model) { return plain_object_of(model.document()); })
      .def("manoeuvres", &manoeuvres_of)
      .def("vehicle", &vehicle_of, py::arg("index"))
      .def_property_readonly("spacing", [](const Model& model) { return spacing_text(model.model()); })
      .def_property_readonly("noise", [](const Model& model) { return noise_text(model.model()); })
      .def_property_readonly("is_homogeneous", [](const Model& model) { return is_homogeneous(model.model()); })
      .def_property_readonly("start_slope", [](const Model& model) { return start_slope(model.model()); });

  module.def("parse_configuration", [](const std::string& text) {
    const Configuration configuration = parse_recorded_configuration(text);
    const nlohmann::json document = to_json(configuration);
    return py::make_tuple(Model::parse(document["model"].dump()), plain_object_of(document["run"]));
  });
  module.def("analyze", &analyze_model, py::arg("model"), py::arg("settings"), py::arg("signals"),
             py::arg("collision_probability"), py::arg("keys"));
  module.def("plant", &plant_of, py::arg("model"));
  module.def("stability_map", &stability_map, py::arg("model"), py::arg("headway"), py::arg("gain"), py::arg("loss"),
             py::arg("mean_burst"));
  module.def("monte_carlo", &monte_carlo_of, py::arg("model"), py::arg("settings"), py::arg("threads"),
             py::arg("checkpoint_seconds"), py::arg("progress"), py::arg("warn"));
  module.def("rare", &rare_of, py::arg("model"), py::arg("settings"), py::arg("options"), py::arg("threads"),
             py::arg("checkpoint_seconds"), py::arg("progress"), py::arg("warn"));
  module.def("trajectories", &trajectories_of, py::arg("model"), py::arg("settings"), py::arg("realization"));
  const auto read_by = [](const char* summary) {
    return [summary](const std::string& folder) {
      ResultTables results = unlocked([&] {
        const auto read = [&](const std::string& name) { return read_file(folder + "/" + name, kMostWrittenBytes); };
        return parse_results(read, folder, nullptr, summary);
      });
      return py::make_tuple(plain_object_of(results.summary), dict_of(std::move(results.tables)));
    };
  };
  module.def("read_results", read_by("summary.json"));
  module.def("read_rare", read_by("rare.json"));
  module.def("check_results", [](const std::string& folder) {
    const ResultCheck check = unlocked([&] { return check_results(folder); });
    return py::make_tuple(check.problems, check.passed);
  });
  module.def("read_table", [](const std::string& file) { return dict_of(unlocked([&] { return read_table(file); })); });
  module.def("read_json", &json_of, py::arg("file"));
  module.def("read_yaml", [](const std::string& file) { return object_of(load_yaml(file, "tuning file"), file); });
}

}  // namespace platoon::python
