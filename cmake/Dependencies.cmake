# Everything from outside, found once and given one name each. All of it comes from Debian's packages.
find_package(PkgConfig REQUIRED)
find_package(Threads REQUIRED)
find_package(Eigen3 REQUIRED NO_MODULE)
find_package(nlohmann_json REQUIRED)
find_package(fmt REQUIRED)
find_package(spdlog REQUIRED)
find_package(CLI11 REQUIRED)
find_package(Boost 1.74 REQUIRED)

pkg_check_modules(BULLET REQUIRED IMPORTED_TARGET bullet)
pkg_check_modules(OSMESA REQUIRED IMPORTED_TARGET osmesa)
pkg_check_modules(SODIUM REQUIRED IMPORTED_TARGET libsodium)
pkg_check_modules(TURBOJPEG REQUIRED IMPORTED_TARGET libturbojpeg)

# Asio and Beast are header-only; every target that uses them states the same configuration.
add_library(aureole_asio INTERFACE)
target_link_libraries(aureole_asio INTERFACE Boost::headers Threads::Threads)
target_compile_definitions(aureole_asio INTERFACE BOOST_ASIO_NO_DEPRECATED BOOST_ASIO_DISABLE_BOOST_REGEX BOOST_ERROR_CODE_HEADER_ONLY)
# Inlined Asio code is taken for dereferencing null by g++ 12, and nobody can act on that.
target_compile_options(aureole_asio INTERFACE -Wno-null-dereference)

find_program(FLATC flatc REQUIRED)

if(AUREOLE_BUILD_TESTS)
  # Catch2 is 2.x on Debian 12 and 3.x on Debian 13; tests include "tests/support/catch.h".
  find_package(Catch2 REQUIRED)
  include(Catch)
endif()
