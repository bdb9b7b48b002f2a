#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/distinct_files.hpp"
#include "study/report.hpp"

namespace sweepgrid::study {

struct ReportFiles {
  std::filesystem::path json;
  std::filesystem::path html;  ///< empty without has_report_page()
};

/// Throws std::invalid_argument that names both when one of the files of a study is one with another, with a file among
/// `scenes`, or with `other`: one more output, if any. For a study to call before it opens any of them.
void check_study_files(const std::string& study, const std::filesystem::path& folder,
                       const std::vector<std::string>& scenes = {}, const NamedFile& other = {});

/// Writes study-<study>.json and study-<study>.html into `folder`, which is made where it is missing; each file appears
/// as a whole or not at all, the JSON first. A program without the page says so on stderr. Throws std::system_error.
ReportFiles write_report(const Report& report, const std::filesystem::path& folder);

}  // namespace sweepgrid::study
