#include "study/report_html.hpp"

#include <stdexcept>
#include <string_view>

#include <nlohmann/json.hpp>

#include "study/report_page.hpp"

namespace sweepgrid::study {
namespace {

using Json = nlohmann::ordered_json;

// JSON stays the same when these three are written as escapes, and no text in it can then end the element, begin
// another or begin a comment.
std::string within_script(const std::string& json) {
  std::string escaped;
  escaped.reserve(json.size() + json.size() / 64);
  for (const char c : json) {
    switch (c) {
      case '<':
        escaped += "\\u003c";
        break;
      case '>':
        escaped += "\\u003e";
        break;
      case '&':
        escaped += "\\u0026";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string within_element(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '<':
        escaped += "&lt;";
        break;
      case '&':
        escaped += "&amp;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

}  // namespace

bool has_report_page() { return !kReportPage.empty(); }

std::string report_html(const Json& report) {
  if (!has_report_page()) throw std::logic_error("report_html: this program was built without the page");
  // The page holds each mark once, the title's first.
  constexpr std::string_view kTitleMark = "@report_title@";
  constexpr std::string_view kJsonMark = "@report_json@";
  const std::size_t title_at = kReportPage.find(kTitleMark);
  const std::size_t json_at = kReportPage.find(kJsonMark);
  const std::string title = report.at("title").dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string html(kReportPage.substr(0, title_at));
  html += within_element(Json::parse(title).get<std::string>());
  html += kReportPage.substr(title_at + kTitleMark.size(), json_at - title_at - kTitleMark.size());
  html += within_script(report.dump(-1, ' ', false, Json::error_handler_t::replace));
  html += kReportPage.substr(json_at + kJsonMark.size());
  return html;
}

}  // namespace sweepgrid::study
