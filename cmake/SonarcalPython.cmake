# Whether the Python module is built. Not in sanitized builds, whose libraries would have to be loaded before the
# interpreter's.
option(SONARCAL_WITH_PYTHON "Build the Python module (needs pybind11, python3-dev and NumPy)" ON)
if(DEFINED SONARCAL_BUILD_PYTHON)  # the former name
  set(SONARCAL_WITH_PYTHON ${SONARCAL_BUILD_PYTHON})
endif()
if(NOT SONARCAL_BUILD_APPS OR SONARCAL_SANITIZE OR SONARCAL_FUZZ)
  set(SONARCAL_WITH_PYTHON OFF)
endif()
if(SONARCAL_WITH_PYTHON)
  # Before pybind11, which would take another python3 that stands first on PATH.
  find_package(Python 3.9 REQUIRED COMPONENTS Interpreter Development.Module)
  sonarcal_find(pybind11 2.10)
endif()
