#include "tools/report.h"

#include <cstdint>
#include <fstream>
#include <iterator>
#include <sstream>

#include "core/support/error.h"
#include "gis/html_text.h"

namespace arete::tools {
namespace {

constexpr const char* style = R"(
:root { color-scheme: light dark; --line: #8886; }
body { font: 16px/1.5 system-ui, sans-serif; max-width: 1200px; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.6rem; } h2 { font-size: 1.2rem; margin-top: 2rem; }
p { max-width: 46rem; }
h3 { font-size: 1rem; margin-top: 1.5rem; }
figure { margin: 1.5rem 0; } img, svg { max-width: 100%; height: auto; display: block; }
iframe { display: block; width: 100%; height: min(660px, 88vh); border: 1px solid var(--line); border-radius: 6px; background: #eeece6; }
figcaption { max-width: 46rem; margin-top: .4rem; opacity: .8; }
.wide { overflow-x: auto; } table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: .3rem .8rem; text-align: right; border-bottom: 1px solid var(--line); }
th:first-child, td:first-child { text-align: left; } th { vertical-align: bottom; }
pre { overflow-x: auto; padding: .8rem; border: 1px solid var(--line); border-radius: 4px; }
footer { margin-top: 2rem; font-size: .9rem; opacity: .7; }
)";

std::string read_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (!file && !file.eof()) throw Error(ErrorKind::disk, path + ": cannot read it for the report");
  if (bytes.empty()) throw Error(ErrorKind::disk, path + ": missing or empty, and the report needs it");
  return bytes;
}

void write_table(std::ostream& out, const std::vector<std::string>& columns, const std::vector<std::vector<std::string>>& rows) {
  out << "<div class=\"wide\"><table>\n<tr>";
  for (const std::string& column : columns) out << "<th>" << escape_html(column) << "</th>";
  out << "</tr>\n";
  for (const auto& row : rows) {
    out << "<tr>";
    for (const std::string& cell : row) out << "<td>" << escape_html(cell) << "</td>";
    out << "</tr>\n";
  }
  out << "</table></div>\n";
}

void write_section(std::ostream& out, const Report::Section& section) {
  out << "<h" << section.level << '>' << escape_html(section.heading) << "</h" << section.level << ">\n";
  for (const std::string& paragraph : section.paragraphs) out << "<p>" << escape_html(paragraph) << "</p>\n";
  if (!section.svg.empty()) out << "<figure>" << section.svg << "</figure>\n";
  if (!section.columns.empty()) write_table(out, section.columns, section.rows);
}

}  // namespace

std::string write_html(const Report& report) {
  std::ostringstream out;
  out << "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>"
      << escape_html(report.title) << "</title>\n<style>" << style << "</style>\n</head>\n<body>\n<h1>" << escape_html(report.title) << "</h1>\n";
  for (const std::string& paragraph : report.introduction) out << "<p>" << escape_html(paragraph) << "</p>\n";

  for (const Report::Frame& frame : report.frames)
    out << "<h2>" << escape_html(frame.heading) << "</h2>\n<figure><iframe title=\"" << escape_html(frame.heading) << "\" loading=\"lazy\" allow=\"fullscreen\" srcdoc=\""
        << escape_html(read_bytes(frame.html)) << "\"></iframe><figcaption>" << escape_html(frame.caption) << "</figcaption></figure>\n";
  for (const Report::Section& section : report.sections) write_section(out, section);
  if (!report.columns.empty()) {
    out << "<h2>Figures</h2>\n";
    write_table(out, report.columns, report.rows);
    out << "<p>" << escape_html(report.table_note) << "</p>\n";
  }
  if (!report.pictures.empty()) out << "<h2>Pictures</h2>\n";
  for (const Report::Picture& picture : report.pictures)
    out << "<figure><img alt=\"" << escape_html(picture.caption) << "\" src=\"data:image/png;base64," << base64(read_bytes(picture.png))
        << "\"><figcaption>" << escape_html(picture.caption) << "</figcaption></figure>\n";
  if (!report.commands.empty()) {
    out << "<h2>The same again, step by step</h2>\n<pre>";
    for (const std::string& command : report.commands) out << escape_html(command) << '\n';
    out << "</pre>\n";
  }
  out << "<footer>" << escape_html(report.footer) << "</footer>\n</body>\n</html>\n";
  return out.str();
}

}  // namespace arete::tools
