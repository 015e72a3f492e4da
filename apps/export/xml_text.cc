#include "apps/export/xml_text.h"

#include <fmt/format.h>

#include <sstream>

#include <pugixml.hpp>

namespace sonarcal::exporting {
// Names of materials may have two dashes.
std::string XmlComment(std::string text) {
  for (std::size_t at = text.find("--"); at != std::string::npos; at = text.find("--", at + 1)) {
    text[at + 1] = '_';
  }
  if (text.ends_with('-')) text.back() = '_';
  return text;
}

void AddElement(pugi::xml_node parent, const char* name, const std::string& value) {
  parent.append_child(name).text().set(value.c_str());
}

void AddElement(pugi::xml_node parent, const char* name, double value) {
  AddElement(parent, name, fmt::format("{:.12g}", value));
}

pugi::xml_node AddSdfSensor(pugi::xml_document& document, const SdfSensor& sensor) {
  pugi::xml_node sdf = document.append_child("sdf");
  sdf.append_attribute("version") = sensor.version;
  pugi::xml_node model = sdf.append_child("model");
  model.append_attribute("name") = sensor.model.c_str();
  pugi::xml_node link = model.append_child("link");
  link.append_attribute("name") = sensor.link;
  pugi::xml_node node = link.append_child("sensor");
  node.append_attribute("name") = sensor.name;
  node.append_attribute("type") = sensor.type;
  AddElement(node, "always_on", "true");
  return node;
}

std::string XmlText(pugi::xml_document& document, const std::string& schema, const std::string& remarks,
                    const ExportAccount& account) {
  std::string comment = fmt::format("\n  Written by sonarcal export, for {}.\n", schema);
  if (!remarks.empty()) comment += fmt::format("  {}\n", remarks);
  for (const std::string& sentence : account.Sentences()) comment += fmt::format("  {}.\n", sentence);
  const pugi::xml_node root = document.document_element();
  document.insert_child_before(pugi::node_comment, root).set_value(XmlComment(comment).c_str());
  pugi::xml_node declaration = document.prepend_child(pugi::node_declaration);
  declaration.append_attribute("version") = "1.0";
  std::ostringstream text;
  document.save(text, "  ");
  return text.str();
}

}  // namespace sonarcal::exporting
