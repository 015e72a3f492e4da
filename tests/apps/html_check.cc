#include "tests/apps/html_check.h"

#include <functional>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace sonarcal::testing {
namespace {

std::string Excerpt(std::string_view html, std::size_t position) {
  return std::string(html.substr(position, 80));
}

// By hand: std::regex recurses once a character, and a picture has a million of them.
std::string AttributeFault(std::string_view rest) {
  constexpr std::string_view kNameCharacters =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-";
  std::set<std::string, std::less<>> names;
  for (;;) {
    const std::size_t start = rest.find_first_not_of(" \n");
    if (start == std::string_view::npos) return "";
    std::string fault = "attributes: " + Excerpt(rest, start);
    if (start == 0) return fault;
    rest.remove_prefix(start);
    const std::size_t name_end = std::min(rest.find_first_not_of(kNameCharacters), rest.size());
    const std::string_view name = rest.substr(0, name_end);
    rest.remove_prefix(name_end);
    if (name.empty() || name.starts_with('-') || !rest.starts_with("=\"")) return fault;
    if (!names.emplace(name).second) return "attribute twice: " + std::string(name);
    const std::size_t value_end = rest.find('"', 2);
    if (value_end == std::string_view::npos ||
        rest.substr(2, value_end - 2).find('<') != std::string_view::npos)
      return fault;
    rest.remove_prefix(value_end + 1);
  }
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
    const bool raw = !open.empty() && (open.back() == "style" || open.back() == "script");
    const std::size_t tag = raw ? html.find("</" + open.back() + ">", position) : html.find('<', position);
    const std::string_view text = html.substr(position, tag - position);
    if (std::string fault = raw ? "" : TextFault(text); !fault.empty()) return fault;
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
    if (std::string fault = AttributeFault(std::string_view(content).substr(name_end)); !fault.empty())
      return fault;
    if (!closed) open.push_back(content.substr(0, name_end));
  }
  return open.empty() ? "" : "never closed: " + open.back();
}

namespace {

// alt text and source of each picture; for a drawing, what it shows
std::vector<std::pair<std::string, std::string>> AltAndSource(const std::string& html) {
  std::vector<std::pair<std::string, std::string>> pictures;
  const auto attribute = [&](const char* name, std::size_t from) {
    const std::size_t start = html.find(name, from) + std::string_view(name).size();
    return html.substr(start, html.find('"', start) - start);
  };
  constexpr std::string_view kFigure = "<figure class=\"picture\">";
  for (std::size_t at = html.find(kFigure); at != std::string::npos; at = html.find(kFigure, at + 1)) {
    if (html.compare(at + kFigure.size(), 4, "<img") == 0) {
      pictures.emplace_back(attribute(" alt=\"", at), attribute(" src=\"", at));
      continue;
    }
    // A drawing shows what it uses, each by a filter and within a clip path.
    const std::string_view drawing = std::string_view(html).substr(at, html.find("</svg>", at) - at);
    std::string source(
        drawing.substr(drawing.find("<path"), drawing.find("</clipPath>") - drawing.find("<path")));
    for (std::size_t use = drawing.find("<use"); use != std::string_view::npos;
         use = drawing.find("<use", use + 1))
      source += drawing.substr(use, drawing.find("/>", use) - use);
    pictures.emplace_back(attribute(" aria-label=\"", at), source);
  }
  return pictures;
}

}  // namespace

std::vector<std::string> PicturesOf(const std::string& html) {
  std::vector<std::string> sources;
  for (const auto& [alt, source] : AltAndSource(html)) sources.push_back(source);
  return sources;
}

std::string PictureFault(const std::string& html) {
  std::map<std::string, std::string> shown;
  for (const auto& [alt, source] : AltAndSource(html)) {
    const auto [at, is_new] = shown.try_emplace(source, alt);
    if (!is_new) return "shown twice: " + at->second + " and " + alt;
  }
  return {};
}

}  // namespace sonarcal::testing
