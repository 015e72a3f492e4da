// Whether a page is well-formed: every element closed in order, attributes quoted and unique, no stray '<' or
// '&'. But for style sheet and script the report writes HTML that is XML as well, so this needs no list of
// void elements.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sonarcal::testing {

// Empty where the page is well-formed; else what is wrong, with the text about it.
std::string HtmlFault(std::string_view html);

// The pictures of a page's figures, in their order: their data, or for drawings the data they use.
std::vector<std::string> PicturesOf(const std::string& html);

// Empty where no picture of the page is shown twice; else the description of one that is.
std::string PictureFault(const std::string& html);

}  // namespace sonarcal::testing
