# cpack: one Debian package with the program, its completion and man pages, the library with its headers, and the
# Python module. Dependencies on libraries come from dpkg-shlibdeps.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME camber)
set(CPACK_PACKAGE_CONTACT "The Camber maintainers <maintainers@camber.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Predicts the deflection of milling cutters and compensates NC programs")
set(CPACK_PACKAGE_DESCRIPTION "Camber predicts how far the cutter bends along an NC program and moves the path the other\
 way: motion of the axes, chips, forces, deflection, form error of the part, and the compensated program. With the\
 C++ library (find_package(camber), pkg-config) and the Python module camber.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# The Python module links to the library of the same package.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR})
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
if(TARGET camber_python)
  find_package(Python REQUIRED COMPONENTS Interpreter)  # python/ has chosen it
  math(EXPR next_python "${Python_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PACKAGE_DEPENDS "python3 (>= ${Python_VERSION_MAJOR}.${Python_VERSION_MINOR}), \
python3 (<< ${Python_VERSION_MAJOR}.${next_python}), python3-numpy")
endif()
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "pkg-config, python3-matplotlib")
include(CPack)
