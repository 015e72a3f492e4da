// XML of a configuration as text, with what it does not say in a comment at its head.
#pragma once

#include <string>

#include "apps/export/export_account.h"

namespace pugi {
class xml_document;
class xml_node;
}  // namespace pugi

namespace sonarcal {

// Adds <name>value</name>.
void AddElement(pugi::xml_node parent, const char* name, const std::string& value);
void AddElement(pugi::xml_node parent, const char* name, double value);

// Puts a comment before the root: what wrote the file, what it was written against, `remarks`, and the
// account's sentences. Then the document as text.
std::string XmlText(pugi::xml_document& document, const std::string& schema, const std::string& remarks,
                    const ExportAccount& account);

}  // namespace sonarcal
