// Nothing: this file exists so that the headers of all tests are compiled once (tests/CMakeLists.txt).
