# Whether the Python module is built: where pybind11 and the headers of Python are there. Not in sanitized builds,
# whose libraries would have to be loaded before the interpreter's.
set(SONARCAL_PYTHON_POSSIBLE OFF)
if(SONARCAL_BUILD_APPS AND NOT SONARCAL_SANITIZE AND NOT SONARCAL_FUZZ)
  # Before pybind11, which would take another python3 that stands first on PATH.
  find_package(Python 3.9 COMPONENTS Interpreter Development.Module)
  if(Python_FOUND)
    find_package(pybind11 2.10 QUIET)
  endif()
  if(Python_FOUND AND pybind11_FOUND)
    set(SONARCAL_PYTHON_POSSIBLE ON)
  endif()
endif()
option(SONARCAL_BUILD_PYTHON "Build the Python module (needs pybind11, python3-dev and NumPy)"
  ${SONARCAL_PYTHON_POSSIBLE})
if(SONARCAL_BUILD_PYTHON AND NOT SONARCAL_PYTHON_POSSIBLE)
  message(STATUS "The Python module is not built: it needs SONARCAL_BUILD_APPS, pybind11 and python3-dev, and no "
    "sanitizers")
  set(SONARCAL_BUILD_PYTHON OFF)
endif()
