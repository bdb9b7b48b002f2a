// Reports of studies: what the JSON holds, and that no text of a report can leave its place in the page.

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "report_sample.hpp"
#include "study/report_files.hpp"
#include "study/report_html.hpp"
#include "study/report_json.hpp"

namespace sweepgrid::study::report_test {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Report report_of(const Section& section) {
  Report report;
  report.study = "test";
  report.title = "A title";
  report.sections.push_back(section);
  return report;
}

std::string file_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

// The JSON that a page carries.
Json carried_by(const std::string& html) {
  const std::string begin = "<script type=\"application/json\" id=\"report-json\">";
  const std::size_t from = html.find(begin) + begin.size();
  return Json::parse(html.substr(from, html.find("</script>", from) - from));
}

TEST(ReportJson, TellsWhereItComesFrom) {
  const Json json = report_json(report_of({}));
  EXPECT_EQ(json.at("schema"), "sweepgrid-study");
  EXPECT_EQ(json.at("schema_version"), 1);
  EXPECT_EQ(json.at("study"), "test");
  EXPECT_EQ(json.at("title"), "A title");
  for (const char* field : {"version", "commit", "compiler", "flags", "build_type"}) {
    EXPECT_TRUE(json.at("build").at(field).is_string()) << field;
  }
  EXPECT_FALSE(json.at("build").at("compiler").get<std::string>().empty());
  EXPECT_GE(json.at("machine").at("cores"), 1);
  EXPECT_TRUE(json.at("machine").contains("cpu"));
  // 2026-01-31T23:59:59Z
  const auto date = json.at("date").get<std::string>();
  ASSERT_EQ(date.size(), 20U);
  EXPECT_EQ(date.substr(4, 1) + date.substr(10, 1) + date.substr(19), "-TZ");
}

TEST(ReportJson, KeepsNumbersAndSpreads) {
  const double third = 1.0 / 3;
  const Series series = {"a", SeriesStyle::kSimulated, {{1, third, 0.25, 0.5, "five runs"}, {2, 1e300}}, "b"};
  Section section;
  section.charts.push_back({"id", "t", "c", {"objects", "", true}, {"time", "ms"}, {series}});
  const Json chart = report_json(report_of(section)).at("sections").at(0).at("charts").at(0);
  EXPECT_EQ(chart.at("x"), Json({{"label", "objects"}, {"unit", ""}, {"log", true}}));
  EXPECT_EQ(chart.at("y"), Json({{"label", "time"}, {"unit", "ms"}, {"log", false}}));
  const Json& written = chart.at("series").at(0);
  EXPECT_EQ(written.at("style"), "simulated");
  EXPECT_EQ(written.at("like"), "b");
  const Json points = Json::parse(written.at("points").dump());
  EXPECT_EQ(points.at(0), Json({{"x", 1.0}, {"y", third}, {"low", 0.25}, {"high", 0.5}, {"label", "five runs"}}));
  EXPECT_EQ(points.at(1), Json({{"x", 2.0}, {"y", 1e300}}));
}

TEST(ReportJson, NumbersThatJsonCannotHoldSurvive) {
  Section section;
  section.tables.push_back({"id", "t", "c", {"n"}, {{{"", kNaN}, {"", kInfinity}, {"", -kInfinity}, {"text"}}}});
  section.maps.push_back({"map", "t", "c", "", "", {"x"}, {"y"}, {}, {{0, 0, {}, "?", ""}, {0, 0, kInfinity, "", ""}}});
  const Json json = Json::parse(report_json(report_of(section)).dump()).at("sections").at(0);
  const Json& row = json.at("tables").at(0).at("rows").at(0);
  EXPECT_TRUE(row.at(0).at("number").is_null());
  EXPECT_EQ(row.at(1).at("number"), "inf");
  EXPECT_EQ(row.at(2).at("number"), "-inf");
  EXPECT_FALSE(row.at(3).contains("number"));
  const Json& tiles = json.at("maps").at(0).at("tiles");
  EXPECT_TRUE(tiles.at(0).at("value").is_null());
  EXPECT_EQ(tiles.at(1).at("value"), "inf");
}

TEST(ReportJson, TimelinesKeepTheirSpans) {
  const Report report = sample_report(100);
  const Timeline& timeline = report.sections.back().timelines.front();
  const Json json = report_json(report).at("sections").back().at("timelines").at(0);
  EXPECT_EQ(json.at("lanes"), timeline.lanes);
  EXPECT_EQ(json.at("groups"), timeline.groups);
  ASSERT_EQ(json.at("spans").size(), timeline.spans.size());
  const Span& last = timeline.spans.back();
  EXPECT_EQ(json.at("spans").back(), Json({{"lane", last.lane},
                                           {"start", last.start},
                                           {"duration", last.duration},
                                           {"group", last.group},
                                           {"label", last.label}}));
}

TEST(ReportHtml, HostileTextsStayInTheirPlace) {
  if (!has_report_page()) GTEST_SKIP() << "built with SWEEPGRID_BUILD_REPORT=OFF";
  Report harmless = sample_report(10);
  const Json json = report_json(harmless);
  const std::string html = report_html(json);
  EXPECT_EQ(carried_by(html), json);
  // As many elements as in a page with nothing in it.
  const std::string empty = report_html(report_json(report_of({})));
  for (const char* part : {"</script", "<script", "<b ", "<!--", "</title", "<style"}) {
    EXPECT_EQ(count(html, part), count(empty, part)) << part;
  }
  EXPECT_EQ(count(html, "<title>Every kind of chart &lt;/script>&lt;b onclick"), 1U);
}

TEST(ReportHtml, NeedsNothingFromElsewhere) {
  if (!has_report_page()) GTEST_SKIP() << "built with SWEEPGRID_BUILD_REPORT=OFF";
  const std::string html = report_html(report_json(report_of({})));
  for (const char* part : {" src=", "<link", "@import", "url(http"}) EXPECT_EQ(count(html, part), 0U) << part;
  EXPECT_EQ(count(html, "default-src 'none'"), 1U);
  EXPECT_GE(count(html, "Apache License"), 1U);
  for (const char* mark : {"@report_title@", "@report_json@", "@style@", "@script@", "@licences@", "@chart_library@"}) {
    EXPECT_EQ(count(html, mark), 0U) << mark;
  }
}

TEST(ReportHtml, MarksOfThePageAreTextInReports) {
  if (!has_report_page()) GTEST_SKIP() << "built with SWEEPGRID_BUILD_REPORT=OFF";
  Report report = report_of({});
  report.title = "@report_json@";
  report.summary = "@report_title@ $& \\1";
  const Json json = report_json(report);
  EXPECT_EQ(carried_by(report_html(json)), json);
}

TEST(ReportFiles, AreWrittenWholeIntoAFolderThatIsMade) {
  const auto folder = std::filesystem::temp_directory_path() / ("report_test-" + std::to_string(::getpid())) / "deep";
  const ReportFiles files = write_report(sample_report(10), folder);
  EXPECT_EQ(files.json, folder / "study-sample.json");
  EXPECT_EQ(files.html, has_report_page() ? folder / "study-sample.html" : "");
  const Json json = Json::parse(file_text(files.json));
  EXPECT_EQ(json.at("study"), "sample");
  std::size_t count_of_files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) count_of_files += entry.is_regular_file();
  EXPECT_EQ(count_of_files, has_report_page() ? 2U : 1U);
  if (has_report_page()) {
    EXPECT_EQ(carried_by(file_text(files.html)), json);
  }
  std::filesystem::remove_all(folder.parent_path());
}

TEST(ReportFiles, TextsThatAreNotUtf8DoNotStopThem) {
  const auto folder = std::filesystem::temp_directory_path() / ("report_test-" + std::to_string(::getpid()));
  Report report = report_of({});
  report.title = report.summary = "file \xff.aabbs";
  const ReportFiles files = write_report(report, folder);
  EXPECT_EQ(Json::parse(file_text(files.json)).at("title"), "file \xEF\xBF\xBD.aabbs");
  if (has_report_page()) {
    EXPECT_EQ(count(file_text(files.html), "<title>file \xEF\xBF\xBD.aabbs</title>"), 1U);
  }
  std::filesystem::remove_all(folder);
}

TEST(ReportFiles, AFolderThatCannotBeIsAnError) {
  EXPECT_THROW((void)write_report(report_of({}), "/dev/null/reports"), std::system_error);
}

}  // namespace
}  // namespace sweepgrid::study::report_test
