# The newest Clang of Debian 12, Debian 13 or Ubuntu 24.04; the package clang has the name without a number.
find_program(VECINO_CLANG NAMES clang++ clang++-19 clang++-18 clang++-14 REQUIRED)
set(CMAKE_CXX_COMPILER ${VECINO_CLANG})
