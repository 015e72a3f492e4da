// XML text of a configuration, with a comment at its head that states what it does not express.
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

// A model with one sensor in SDF: sdf / model / link / sensor, always on.
struct SdfSensor {
  const char* version;  // SDF version
  std::string model;
  const char* link;
  const char* name;
  const char* type;
};

// Returns the empty element of the sensor.
pugi::xml_node AddSdfSensor(pugi::xml_document& document, const SdfSensor& sensor);

// Returns the text of a comment. Two dashes, which end a comment in XML, are replaced.
std::string XmlComment(std::string text);

// Puts a comment before the root: program, `schema`, `remarks`, and the sentences of the account. Returns the
// document as text.
std::string XmlText(pugi::xml_document& document, const std::string& schema, const std::string& remarks,
                    const ExportAccount& account);

}  // namespace sonarcal::exporting
