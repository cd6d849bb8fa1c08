#pragma once

#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "stochastic_platoon/run/io/csv_table.hpp"
#include "stochastic_platoon/run/results/run_result.hpp"

namespace platoon {

/// Writes output/statistics.csv, signals.csv, gaps.csv and amplification.csv as far as the run has their signals,
/// ages.csv if a link loses, and summary.json, which contains the provenance() of all, each atomically. The summary's
/// "crc32" holds the checksum() of each, its own computed with "00000000" in its place, so that readers detect damage.
/// Throws std::runtime_error.
void write_results(const Configuration& configuration, const Prediction& prediction, const RunResult& result);

/// The same files without writing them: contents by name ("statistics.csv").
std::map<std::string, std::string> result_files(const Configuration& configuration, const Prediction& prediction,
                                                const RunResult& result);

/// The verdict and the figures of the theory for summary.json; null without a theory, but for the reason.
nlohmann::json theory_json(const Prediction& prediction);

/// The text of a summary with the "crc32" of these tables, contents by file name, and of its own.
std::string with_checksums(nlohmann::json summary, const std::map<std::string, std::string>& tables, int indent = 2);

/// Parses a JSON object; `file` names it in messages. Throws std::invalid_argument, also if it contains its own
/// checksum and has changed since it was written. Files of earlier versions may contain none.
nlohmann::json parse_json(const std::string& text, const std::string& file,
                          const nlohmann::json::parser_callback_t& callback = nullptr);

/// The same for a summary.json, which must contain its checksum.
nlohmann::json parse_summary(const std::string& text, const std::string& file);

/// Throws std::invalid_argument if folder/NAME.json exists and write_table() did not write it.
void require_own_table(const std::string& folder, const std::string& name);

/// Writes folder/NAME.csv and, before it, NAME.json: the summary with the checksums of both. Replaces the files of an
/// earlier call. Throws std::runtime_error, and as require_own_table().
void write_table(const std::string& folder, const std::string& name, nlohmann::json summary, std::string csv);

/// Reads a table. Throws std::invalid_argument if the checksum in a JSON file of the same name beside it is not its
/// own; passes on exceptions of read_file().
CsvTable read_table(const std::string& file);

/// Results as tables.
struct ResultTables {  // NOLINT(bugprone-exception-escape): moving a JSON value throws nothing
  nlohmann::json summary;
  std::map<std::string, CsvTable> tables;  ///< by name without ending ("statistics")
};

/// Reads the files of a result. `read` returns the content of a file by its name; `folder` names them in messages.
/// Throws std::invalid_argument if a file has changed since it was written, and passes on exceptions of `read`.
/// `problems`, if given, gets the messages of the tables instead, which are then left out. `summary`: the file
/// with the checksums.
ResultTables parse_results(const std::function<std::string(const std::string&)>& read, const std::string& folder,
                           std::vector<std::string>* problems = nullptr, const std::string& summary = "summary.json");

/// Name of summary.json until statistics.csv is written. A folder with this file and statistics.csv, but without
/// summary.json, is left by a killed write_results().
std::string unfinished_summary_file(const std::string& output);

/// The content of statistics.csv.
std::string statistics_csv(const Configuration& configuration, const Prediction& prediction, const RunResult& result);

}  // namespace platoon
