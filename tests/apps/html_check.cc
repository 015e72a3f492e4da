#include "tests/apps/html_check.h"

#include <regex>
#include <set>
#include <vector>

namespace sonarcal::testing {
namespace {

std::string Excerpt(std::string_view html, std::size_t position) {
  return std::string(html.substr(position, 80));
}

std::string AttributeFault(const std::string& attributes) {
  static const std::regex kAttribute(R"re(\s+([a-zA-Z][-a-zA-Z0-9]*)="([^"<]*)")re");
  std::set<std::string> names;
  std::string rest = attributes;
  for (std::smatch match; std::regex_search(rest, match, kAttribute, std::regex_constants::match_continuous);
       rest = match.suffix()) {
    if (!names.insert(match[1]).second) return "attribute twice: " + match[1].str();
  }
  return rest.find_first_not_of(" \n") == std::string::npos ? "" : "attributes: " + rest.substr(0, 80);
}

// Text may hold only the references that EscapeHtml makes.
std::string TextFault(std::string_view text) {
  for (std::size_t at = text.find('&'); at != std::string_view::npos; at = text.find('&', at + 1)) {
    bool known = false;
    for (const std::string_view reference : {"&amp;", "&lt;", "&gt;", "&quot;", "&#39;"}) {
      known = known || text.substr(at).starts_with(reference);
    }
    if (!known) return "stray '&': " + Excerpt(text, at);
  }
  return "";
}

}  // namespace

std::string HtmlFault(std::string_view html) {
  constexpr std::string_view kDoctype = "<!DOCTYPE html>";
  if (!html.starts_with(kDoctype)) return "no doctype";
  std::vector<std::string> open;
  std::size_t position = kDoctype.size();
  while (position < html.size()) {
    const std::size_t tag = html.find('<', position);
    const std::string_view text = html.substr(position, tag - position);
    const bool raw = !open.empty() && open.back() == "style";
    if (const std::string fault = raw ? "" : TextFault(text); !fault.empty()) return fault;
    if (tag == std::string_view::npos) break;
    const std::size_t end = html.find('>', tag);
    if (end == std::string_view::npos) return "tag without end: " + Excerpt(html, tag);
    std::string content(html.substr(tag + 1, end - tag - 1));
    position = end + 1;
    if (content.starts_with('/')) {
      if (open.empty() || open.back() != content.substr(1)) return "closes nothing: " + Excerpt(html, tag);
      open.pop_back();
      continue;
    }
    const bool closed = content.ends_with('/');
    if (closed) content.pop_back();
    const std::size_t name_end = std::min(content.find_first_of(" \n"), content.size());
    if (const std::string fault = AttributeFault(content.substr(name_end)); !fault.empty()) return fault;
    if (!closed) open.push_back(content.substr(0, name_end));
  }
  return open.empty() ? "" : "never closed: " + open.back();
}

}  // namespace sonarcal::testing
