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
  struct Section {
    std::string heading;
    int level = 2;                                   ///< of the heading; 3 is below 2
    std::vector<std::string> paragraphs = {};
    std::vector<std::string> columns = {};           ///< of a table; empty: none
    std::vector<std::vector<std::string>> rows = {};
    std::string svg = {};                            ///< a drawing, put into the page as it is; empty: none
  };
  /// A page within the page, in a frame of its own.
  struct Frame {
    std::string heading, caption;
    std::string html;  ///< path of the file, which is copied into the page
  };
  std::string title;
  std::vector<std::string> introduction = {};        ///< paragraphs, plain text
  std::vector<Frame> frames = {};
  std::vector<Section> sections = {};
  std::vector<std::string> columns = {};             ///< of the table; the first names the row
  std::vector<std::vector<std::string>> rows = {};   ///< cells
  std::string table_note = {};
  std::vector<Picture> pictures = {};
  std::vector<std::string> commands = {};            ///< that make the same again
  std::string footer = {};
};

/// One HTML page that needs no other file and no network. Throws Error{disk} where a picture or a frame cannot be read.
std::string write_html(const Report& report);

}  // namespace arete::tools
