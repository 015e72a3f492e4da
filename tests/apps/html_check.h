// Whether a page is well-formed: every element closed in order, attributes quoted and unique, no stray '<' or
// '&'. But for style sheet and script the report writes HTML that is XML as well, so this needs no list of
// void elements.
#pragma once

#include <string>
#include <string_view>

namespace sonarcal::testing {

// Empty where the page is well-formed; else what is wrong, with the text about it.
std::string HtmlFault(std::string_view html);

}  // namespace sonarcal::testing
