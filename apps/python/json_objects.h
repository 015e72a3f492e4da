// JSON text of the library as Python objects, and the other way.
#pragma once

#include <pybind11/pybind11.h>

#include <string>
#include <vector>

#include "core/materials/named_materials.h"
#include "core/types/parameters.h"

namespace sonarcal::python {

// Objects, arrays, texts and numbers as dict, list, str and float or int.
pybind11::object ObjectFromJson(const std::string& text);

// NumPy arrays and numbers are taken as lists and numbers. Raises TypeError for anything else that JSON
// lacks.
std::string JsonFromObject(const pybind11::object& value);

pybind11::object DictFromParameters(const ParameterSet& parameters);

// `source`: Parameters, a dict in the form of params.json, or the path of such a file. Throws DataError
// naming the key of anything wrong, raises TypeError for another type.
ParameterSet ParametersFromObject(const pybind11::object& source);

// As ParametersFromObject, for the start of a fit: in a dict or a file, a material may have a prior and no
// curve (data_io::ReadStartParameters).
ParameterSet StartFromObject(const pybind11::object& source, const std::vector<NamedMaterial>& materials);

bool IsMapping(const pybind11::handle& value);
// Whether `value` is a str or an os.PathLike.
bool IsPath(const pybind11::handle& value);

}  // namespace sonarcal::python
