#include "core/report/report.h"

#include <glog/logging.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>
#include <utility>

#include "core/report/assets.h"
#include "core/report/figure_json.h"

namespace idim {
namespace {

std::string EscapeHtml(std::string_view text) {
  std::string escaped;
  escaped.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

void ReplaceAll(std::string* text, std::string_view from, std::string_view to) {
  for (std::size_t at = text->find(from); at != std::string::npos; at = text->find(from, at + to.size())) {
    text->replace(at, from.size(), to);
  }
}

// "</script" would end the element and "<!--" change how its end is found; within the string and regular expression
// literals where a program can hold them the backslash means nothing.
std::string EscapeScript(std::string_view program) {
  std::string escaped(program);
  ReplaceAll(&escaped, "</script", "<\\/script");
  ReplaceAll(&escaped, "<!--", "<\\!--");
  return escaped;
}

std::string EscapeJson(const nlohmann::json& value) {
  // Bytes that are not UTF-8 become U+FFFD, as in the HTML around.
  std::string text = value.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
  ReplaceAll(&text, "<", "\\u003c");
  return text;
}

// The cell split at its decimal point, the part behind as wide as the column's longest: points stand below each other.
std::string NumberCell(const std::string& cell, std::size_t fraction_width) {
  const std::size_t point = std::min(cell.find('.'), cell.size());
  return EscapeHtml(cell.substr(0, point)) +
         "<span class=\"fraction\" style=\"width:" + std::to_string(fraction_width) + "ch\">" +
         EscapeHtml(cell.substr(point)) + "</span>";
}

class Renderer {
 public:
  std::string Body(const Report& report) {
    html_ += "<header>\n<h1>" + EscapeHtml(report.title) + "</h1>\n";
    if (!report.subtitle.empty()) html_ += "<p class=\"subtitle\">" + EscapeHtml(report.subtitle) + "</p>\n";
    html_ += "</header>\n";
    Contents(report);
    for (std::size_t i = 0; i < report.sections.size(); ++i) {
      html_ += "<section id=\"" + SectionId(i) + "\">\n<h2>" + EscapeHtml(report.sections[i].title) + "</h2>\n";
      for (const Block& block : report.sections[i].blocks) std::visit(*this, block);
      html_ += "</section>\n";
    }
    return std::move(html_);
  }

  std::string Specs() const { return EscapeJson(specs_); }

  std::string Samples() const {
    std::string html;
    const std::vector<SamplePool::Samples>& all = pool_.all();
    for (std::size_t i = 0; i < all.size(); ++i) {
      html += "<script type=\"application/octet-stream\" id=\"samples-" + std::to_string(i) + "\" data-type=\"" +
              all[i].type + "\" data-count=\"" + std::to_string(all[i].count) + "\">" + all[i].base64 + "</script>\n";
    }
    return html;
  }

  void operator()(const Paragraph& paragraph) {
    switch (paragraph.kind) {
      case Paragraph::Kind::kPlain:
        html_ += "<p>";
        break;
      case Paragraph::Kind::kNote:
        html_ += "<p class=\"note\">";
        break;
      case Paragraph::Kind::kWarning:
        html_ += "<p class=\"warning\">";
        break;
    }
    html_ += EscapeHtml(paragraph.text) + "</p>\n";
  }

  void operator()(const KeyValues& summary) {
    html_ += "<dl>\n";
    for (const auto& [key, value] : summary.entries) {
      html_ += "<div><dt>" + EscapeHtml(key) + "</dt><dd>" + EscapeHtml(value) + "</dd></div>\n";
    }
    html_ += "</dl>\n";
  }

  void operator()(const Table& table) {
    const std::size_t columns = table.columns.size();
    std::vector<std::size_t> fraction_width(columns, 0);
    for (const std::vector<std::string>& row : table.rows) {
      CHECK_EQ(row.size(), columns) << "table " << table.caption;
      for (std::size_t j = 0; j < columns; ++j) {
        fraction_width[j] = std::max(fraction_width[j], row[j].size() - std::min(row[j].find('.'), row[j].size()));
      }
    }
    html_ += "<div class=\"table\"><table>\n";
    if (!table.caption.empty()) html_ += "<caption>" + EscapeHtml(table.caption) + "</caption>\n";
    html_ += "<thead><tr>";
    for (const Table::Column& column : table.columns) {
      html_ += std::string("<th scope=\"col\"") + AlignClass(column.align) + ">" + EscapeHtml(column.title) + "</th>";
    }
    html_ += "</tr></thead>\n<tbody>\n";
    const std::set<int> muted(table.muted_rows.begin(), table.muted_rows.end());
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
      html_ += muted.count(static_cast<int>(i)) > 0 ? "<tr class=\"muted\">" : "<tr>";
      for (std::size_t j = 0; j < columns; ++j) {
        const Table::Align align = table.columns[j].align;
        const std::string& cell = table.rows[i][j];
        html_ += std::string("<td") + AlignClass(align) + ">" +
                 (align == Table::Align::kNumber ? NumberCell(cell, fraction_width[j]) : EscapeHtml(cell)) + "</td>";
      }
      html_ += "</tr>\n";
    }
    html_ += "</tbody></table></div>\n";
  }

  void operator()(const FigureGrid& grid) {
    CHECK_GE(grid.columns, 1);
    html_ += "<div class=\"grid\" style=\"--columns:" + std::to_string(grid.columns) + "\">\n";
    for (const Figure& figure : grid.figures) {
      const FigureJson drawn = ToJson(figure, &pool_);
      const std::string title = EscapeHtml(drawn.title);
      html_ += "<figure><figcaption>" + title + "</figcaption><div class=\"figure\" id=\"figure-" +
               std::to_string(specs_.size()) + "\" role=\"img\" aria-label=\"" + title +
               "\" style=\"height:" + std::to_string(drawn.height_px) + "px\"></div></figure>\n";
      specs_.push_back(drawn.spec);
      specs_.back()["title"] = drawn.title;
    }
    html_ += "</div>\n";
  }

 private:
  static std::string SectionId(std::size_t i) { return "section-" + std::to_string(i + 1); }

  static const char* AlignClass(Table::Align align) { return align == Table::Align::kLeft ? "" : " class=\"right\""; }

  void Contents(const Report& report) {
    if (report.sections.size() < 3) return;
    html_ += "<nav><ol>\n";
    for (std::size_t i = 0; i < report.sections.size(); ++i) {
      html_ += "<li><a href=\"#" + SectionId(i) + "\">" + EscapeHtml(report.sections[i].title) + "</a></li>\n";
    }
    html_ += "</ol></nav>\n";
  }

  std::string html_;
  nlohmann::json specs_ = nlohmann::json::array();
  SamplePool pool_;
};

// One pass, so that a {{name}} in what is put in stays as it is.
std::string FillTemplate(std::string_view page, const std::map<std::string_view, std::string>& parts) {
  std::string filled;
  while (true) {
    const std::size_t open = page.find("{{");
    filled += page.substr(0, open);
    if (open == std::string_view::npos) return filled;
    const std::size_t close = page.find("}}", open);
    CHECK_NE(close, std::string_view::npos) << "report.html: {{ without }}";
    const std::string_view name = page.substr(open + 2, close - open - 2);
    const auto part = parts.find(name);
    CHECK(part != parts.end()) << "report.html: {{" << name << "}} is not known";
    filled += part->second;
    page.remove_prefix(close + 2);
  }
}

}  // namespace

std::string RenderReport(const Report& report) {
  namespace assets = report_assets;
  Renderer renderer;
  std::map<std::string_view, std::string> parts;
  parts["title"] = EscapeHtml(report.title);
  parts["body"] = renderer.Body(report);
  parts["specs"] = renderer.Specs();
  parts["samples"] = renderer.Samples();
  parts["style"] = std::string(assets::Style());
  parts["script"] = EscapeScript(assets::Script());
  parts["echarts"] = EscapeScript(assets::Echarts());
  parts["licenses"] = EscapeHtml(std::string(assets::EchartsNotice()) + "\n" + std::string(assets::EchartsLicense()) +
                                 "\n" + std::string(assets::D3License()));
  return FillTemplate(assets::Template(), parts);
}

}  // namespace idim
