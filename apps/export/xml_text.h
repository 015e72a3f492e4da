// XML of a configuration as text, with what it does not say in a comment at its head.
#pragma once

#include <string>

#include "apps/export/export_account.h"

namespace pugi {
class xml_document;
class xml_node;
}  // namespace pugi

namespace sonarcal::exporting {

// Adds <name>value</name>.
void AddElement(pugi::xml_node parent, const char* name, const std::string& value);
void AddElement(pugi::xml_node parent, const char* name, double value);

// A model with one sensor, as SDF has it: sdf / model / link / sensor, always on.
struct SdfSensor {
  const char* version;  // of SDF
  std::string model;
  const char* link;
  const char* name;
  const char* type;
};

// The sensor's element, to be filled.
pugi::xml_node AddSdfSensor(pugi::xml_document& document, const SdfSensor& sensor);

// Puts a comment before the root: what wrote the file, what it was written against, `remarks`, and the
// account's sentences. Then the document as text.
std::string XmlText(pugi::xml_document& document, const std::string& schema, const std::string& remarks,
                    const ExportAccount& account);

}  // namespace sonarcal::exporting
