#pragma once

#include <string>
#include <vector>

namespace arete::tools {

/// A page that shows what was done and what came of it, for a browser; in the order of its members.
struct Report {
  struct Picture {
    std::string caption;
    std::string png;  ///< path of the file, which is copied into the page
  };
  std::string title;
  std::vector<std::string> introduction = {};        ///< paragraphs, plain text
  std::vector<std::string> columns = {};             ///< of the table; the first names the row
  std::vector<std::vector<std::string>> rows = {};   ///< cells
  std::string table_note = {};
  std::vector<Picture> pictures = {};
  std::vector<std::string> commands = {};            ///< that make the same again
  std::string footer = {};
};

/// One HTML page that needs no other file and no network. Throws Error{disk} where a picture cannot be read.
std::string write_html(const Report& report);

/// Base64 (RFC 4648) of bytes.
std::string base64(const std::string& bytes);

}  // namespace arete::tools
