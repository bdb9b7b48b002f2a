#include "study/report_files.hpp"

#include <cstdio>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/output_file.hpp"
#include "cli/standard_streams.hpp"
#include "study/report_html.hpp"
#include "study/report_json.hpp"

namespace sweepgrid::study {
namespace {

void write_whole(const std::filesystem::path& path, std::string_view text) {
  OutputFile file(path.string());
  file.write(text);
  file.commit();
}

}  // namespace

void check_study_files(const std::string& study, const std::filesystem::path& folder,
                       const std::vector<std::string>& scenes, const NamedFile& other) {
  const auto in_folder = [&](const char* ending) {
    return (folder / fmt::format("study-{}{}", study, ending)).string();
  };
  check_distinct({{"the file of points", in_folder(".points.jsonl")},
                  {"the report as JSON", in_folder(".json")},
                  {"the page of the report", has_report_page() ? in_folder(".html") : ""},
                  other},
                 files_among(scenes));
}

ReportFiles write_report(const Report& report, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  const nlohmann::ordered_json json = report_json(report);
  ReportFiles files;
  files.json = folder / fmt::format("study-{}.json", report.study);
  // Names of files, which texts hold, need not be UTF-8.
  write_whole(files.json, json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
  if (has_report_page()) {
    files.html = folder / fmt::format("study-{}.html", report.study);
    write_whole(files.html, report_html(json));
  } else {
    show_on_stderr(fmt::format("sweepgrid: {} alone, no page: this program was built with SWEEPGRID_BUILD_REPORT=OFF\n",
                               files.json.string()));
  }
  return files;
}

}  // namespace sweepgrid::study
